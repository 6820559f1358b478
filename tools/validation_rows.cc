// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/validation_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/validation_figures.h"

namespace torso::tools {
namespace {

const Json& discOf(const Json& loads, const std::string& name) {
  for (const Json& disc : loads.at("discs")) {
    if (disc.at("disc") == name) return disc;
  }
  return loads.at("discs").at(0);
}

}  // namespace

std::vector<Row> infoRows(const Json& j) {
  const auto whole = [&](const char* what, const Json& value, const char* paper) {
    const std::string ours = number(value);
    return Row{what, ours, paper, ours == paper, "Lee et al. 2023"};
  };
  return {headline(whole("degrees of freedom", j.at("dof"), "195")),
          whole("ball joints", j.at("ball_joints"), "17"),
          whole("free bodies", j.at("free_joints"), "24"),
          whole("discs", j.at("discs").size(), "23"),
          {"nodes and tetrahedra of a disc",
           fmt::format("{}, {}", number(j["discs"].at(0).at("nodes")),
                       number(j["discs"].at(0).at("tets"))),
           ""},
          whole("ligament segments", j.at("ligament_segments"), "440"),
          whole("facets", j.at("facets"), "74"),
          {"servos", number(j.at("actuators")), ""},
          {"mass", fmt::format("{:.2f} kg", j.at("mass_kg").get<double>()), "72 kg"},
          {"stature", fmt::format("{:.3f} m", j.at("stature_m").get<double>()), "1.70 m"}};
}

std::vector<Row> kindRows(const Json& j) {
  return {{"degrees of freedom", number(j.at("dof")), ""},
          {"ball joints", number(j.at("ball_joints")), ""},
          {"servos", number(j.at("actuators")), ""},
          {"mass", fmt::format("{:.2f} kg", j.at("mass_kg").get<double>()), ""}};
}

std::vector<Row> graftRows(const Json& j) {
  const auto both = [&](const std::string& what, const std::string& unit, int digits) {
    return fmt::format("{:.{}f} -> {:.{}f}", j.at(what + "_before_" + unit).get<double>(), digits,
                       j.at(what + "_after_" + unit).get<double>(), digits);
  };
  int removed = 0, changed = 0;
  for (const Json& c : j.at("changes")) {
    if (c.at("kind") != "actuator") continue;
    removed += c.at("action") == "removed";
    changed += c.at("action") == "changed";
  }
  return {
      {"mass [kg]", both("mass", "kg", 2), ""},
      {"hip to shoulder [m]", both("hip_to_shoulder", "m", 3), ""},
      {"limb joints kept", number(j.at("limb_joints")), ""},
      {"trunk actuators", fmt::format("{} as servos of levels, {} removed", changed, removed), ""}};
}

std::vector<Row> boneRows(const Json& j) {
  std::vector<Row> rows, fits;
  for (const Json& m : j.at("measures")) {
    const std::string unit = m.at("unit");
    Row row{m.at("bone").get<std::string>() + " " + text(m.at("quantity")),
            number(m.at("ours"), unit), ""};
    if (m.contains("published")) {
      row.published = number(m["published"], unit);
      if (!m.at("sd").is_null()) row.published += " +- " + number(m["sd"]);
      row.inside = m.at("inside").get<bool>();
      row.source = m.at("source");
    }
    rows.push_back(row);
  }
  for (const Json& f : j.at("fit")) {
    fits.push_back({f.at("check").get<std::string>() + ", " + f.at("where").get<std::string>(),
                    number(f.at("value"), f.at("unit") == "mm" ? "mm" : ""),
                    range(f.at("low"), f.at("high")), f.at("passed").get<bool>(), "this project"});
  }
  std::vector<Row> all = {count("measures of bones", rows, "published means, standard deviations")};
  if (!fits.empty()) all.push_back(count("bones, discs and joints fit each other", fits, "all"));
  all.insert(all.end(), rows.begin(), rows.end());
  all.insert(all.end(), fits.begin(), fits.end());
  return all;
}

std::vector<Row> discRows(const Json& j) {
  std::vector<Row> rows;
  for (const Json& disc : j.at("discs")) {
    for (const Json& t : disc.at("tests")) {
      const std::string unit = t.at("unit").get<std::string>();
      Row row{disc.at("name").get<std::string>() + " " + text(t.at("quantity")),
              number(t.at("ours"), unit),
              number(t.at("published"), unit) + range(t.at("low"), t.at("high"))};
      // The preload's effect is published for whole segments and pigs only.
      if (t.at("fit") && t["quantity"] != "preload_ratio") row.inside = t.at("inside").get<bool>();
      row.source =
          t.at("source").get<std::string>() + " (" + t.at("provenance").get<std::string>() + ")";
      rows.push_back(row);
    }
  }
  rows.insert(rows.begin(), count("discs on the bench", rows, "published or derived ranges"));
  return rows;
}

std::vector<Row> shoulderRows(const Json& j) {
  const double raising = j.at("raising_ratio");
  std::vector<Row> rows = {
      headline({"glenohumeral to scapular motion, raising", fmt::format("{:.2f}:1", raising),
                "2:1 (2.0 - 2.4)", raising >= 2.0 && raising <= 2.4, "Inman 1944; Ludewig 2009"}),
      {"the same, lowering", fmt::format("{:.2f}:1", j.at("lowering_ratio").get<double>()), ""},
      {"scapula off its ellipsoid", number(j.at("gliding_distance_mm"), "mm"), ""},
      {"least clearance of scapula and ribs", number(j.at("clearance_mm"), "mm"), ""}};
  for (const Json& p : j.at("published")) {
    if (!p.contains("elevation_deg")) continue;
    const double elevation = p["elevation_deg"];
    const std::string key = p.at("quantity").get<std::string>() + "_deg";
    const Json* nearest = nullptr;
    for (const Json& pose : j.at("raising")) {
      if (!nearest || std::abs(pose.at("elevation_deg").get<double>() - elevation) <
                          std::abs(nearest->at("elevation_deg").get<double>() - elevation)) {
        nearest = &pose;
      }
    }
    if (!nearest || !nearest->contains(key)) continue;
    rows.push_back({fmt::format("{} at {:.0f} deg of elevation", text(p["quantity"]), elevation),
                    number((*nearest)[key], "deg"), number(p.at("value"), "deg"), std::nullopt,
                    p.at("source")});
  }
  return rows;
}

std::vector<Row> pressureRows(const Json& j) {
  std::vector<Row> rows, ours;
  const std::string disc = j.at("disc");
  // Published pressures are those of the whole body, not of one that lacks something.
  const bool whole = j.at("without").empty(), tables = j.at("body") == "tables";
  for (const Json& a : j.at("activities")) {
    const std::string title = a.at("title"), name = a.at("activity");
    const double measured = a.at("measured_mpa");
    // The goal: within 15 % in standing and holding, 30 % elsewhere.
    const bool strict = name == "standing" || name == "hold_close" || name == "hold_far";
    const auto row = [&](const std::string& how, const Json& loads, const char* key) {
      const double pressure = discOf(loads, disc).at(key);
      return Row{title + ", " + how,
                 fmt::format("{:.2f} MPa ({:+.0f} %)", pressure, 100 * (pressure / measured - 1)),
                 fmt::format("{:.2f} MPa", measured),
                 std::abs(pressure / measured - 1) <= (strict ? 0.15 : 0.3), "Wilke 1999, 2001"};
    };
    const char* on_his_area = "nucleus_pressure_area_of_subject_mpa";
    rows.push_back(row("servos only", a.at("servos"), on_his_area));
    rows.back().inside.reset();
    if (!a.contains("muscles")) continue;
    rows.push_back(row("muscles", a["muscles"], on_his_area));
    rows.back().headline = whole && !tables;
    if (!whole) rows.back().inside.reset();
    if (tables) {
      rows.push_back(row("muscles, our disc", a["muscles"], "nucleus_pressure_mpa"));
      ours.push_back(rows.back());
    }
    const auto plain = [&](const char* what, const std::string& value) {
      rows.push_back({title + ", " + what, value, ""});
    };
    rows.push_back({title + ", compression",
                    number(discOf(a["muscles"], disc).at("compression_n"), "N"),
                    number(a.at("measured_as_force_n"), "N"), std::nullopt,
                    "Nachemson 1960, of the measured pressure"});
    const double l3 = a.at("published_l3_l4_n");
    rows.push_back({title + ", compression of L3/L4",
                    number(discOf(a["muscles"], "L3/L4").at("compression_n"), "N"),
                    l3 > 0 ? number(l3, "N") : "", std::nullopt,
                    l3 > 0 ? "Nachemson 1966 - 1970" : ""});
    std::string levels;
    for (const Json& level : a["muscles"].at("discs")) {
      levels += fmt::format("{}{} {:.2f}", levels.empty() ? "" : ", ",
                            level.at("disc").get<std::string>(),
                            level.at("nucleus_pressure_mpa").get<double>());
    }
    plain("pressure in all nuclei [MPa]", levels);
    plain("lean of the body", number(a.at("lean_deg"), "deg"));
    double left = 0;
    for (const Json& moment : a["muscles"].at("servo_flexion_moments_nm")) {
      left = std::max(left, std::abs(moment.get<double>()));
    }
    plain("most that servos still give", number(left, "Nm"));
    plain("compression, servos only", number(discOf(a["servos"], disc).at("compression_n"), "N"));
    plain("pressure in the abdomen", number(a.at("abdominal_pressure_kpa"), "kPa"));
    for (const Json& b : a.at("balance")) {
      if (b.at("disc") != disc) continue;
      plain("moment of weight and load", number(b.at("weight_nm"), "Nm"));
      const double moment = b.at("muscles_nm"), pull = b.at("muscle_pull_n");
      plain("moments of muscles, abdomen and spine",
            fmt::format("{:.0f}, {:.1f}, {:.1f} Nm", -moment, -b.at("abdomen_nm").get<double>(),
                        -b.at("passive_nm").get<double>()));
      plain("muscles' pull along the disc", number(pull, "N"));
      plain("its arm behind the disc", number(pull > 0 ? -1e3 * moment / pull : 0, "mm"));
      plain("push of the abdomen", number(b.at("abdomen_push_n"), "N"));
    }
  }
  if (tables) rows.insert(rows.begin(), count("pressures in our own smaller disc", ours, "all"));
  return rows;
}

std::vector<Row> armRows(const Json& j) {
  std::vector<Row> rows;
  for (const Json& a : j.at("arms")) {
    for (const auto& [key, where] : {std::pair{"behind", "behind"}, {"beside", "beside"}}) {
      const double arm = a.at(fmt::format("{}_mm", key));
      const Json& published = a.at(fmt::format("{}_published_mm", key));
      rows.push_back(
          {fmt::format("{} {} {}", text(a.at("muscle")), where, a.at("disc").get<std::string>()),
           number(arm, "mm"),
           fmt::format("{} - {} mm", number(published.at(0)), number(published.at(1))),
           arm >= published[0] && arm <= published[1], "muscle_arms.csv"});
    }
  }
  rows.insert(rows.begin(), count("moment arms of muscles", rows, "published ranges"));
  return rows;
}

std::vector<Row> plainRows(const Json& j) {
  constexpr std::size_t kMany = 30;  // entries of an array beyond which it is no table
  std::vector<Row> rows;
  const std::function<void(const std::string&, const Json&)> add = [&](const std::string& path,
                                                                       const Json& value) {
    const auto below = [&](const std::string& key) {
      return path.empty() ? text(key) : path + ", " + text(key);
    };
    if (value.is_object()) {
      for (const auto& [key, part] : value.items()) add(below(key), part);
    } else if (value.is_array()) {
      if (value.size() > kMany) return;
      for (std::size_t i = 0; i < value.size(); i++) {
        // Named by its first text, if it has one.
        std::string name = std::to_string(i + 1);
        if (value[i].is_object() && !value[i].empty() && value[i].front().is_string()) {
          name = value[i].front();
        }
        add(below(name), value[i]);
      }
    } else if (value.is_number()) {
      rows.push_back({path, number(value), ""});
    } else if (value.is_boolean()) {
      rows.push_back({path, value.get<bool>() ? "yes" : "no", ""});
    }
  };
  add("", j);
  return rows;
}

}  // namespace torso::tools
