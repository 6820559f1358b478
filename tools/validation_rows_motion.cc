// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Rows of what moves: time steps, speed, falls, motion capture, optimal control; and of tests.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "tools/validation_figures.h"
#include "tools/validation_rows.h"

namespace torso::tools {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

// Rows of a comma-separated text by the names of its header; '"' quotes, '""' in quotes is one.
std::vector<std::map<std::string, std::string>> tableOf(const std::string& csv) {
  std::vector<std::vector<std::string>> lines = {{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); i++) {
    const char c = csv[i];
    if (c == '"' && quoted && i + 1 < csv.size() && csv[i + 1] == '"') {
      lines.back().back() += csv[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      lines.back().emplace_back();
    } else if (c == '\n' && !quoted) {
      lines.push_back({""});
    } else {
      lines.back().back() += c;
    }
  }
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t i = 1; i < lines.size(); i++) {
    if (lines[i].size() != lines[0].size()) continue;  // the empty line at the end
    rows.emplace_back();
    for (std::size_t k = 0; k < lines[0].size(); k++) rows.back()[lines[0][k]] = lines[i][k];
  }
  return rows;
}

// "0.1, 0.05, ..." of the rows of an optimisation.
std::string listOf(const Json& j, const char* key) {
  std::string list;
  if (!j.contains("rows")) return list;
  for (const Json& row : j["rows"]) list += (list.empty() ? "" : ", ") + number(row.at(key));
  return list;
}

}  // namespace

std::vector<Row> timestepRows(const Json& j) {
  std::vector<Row> rows;
  const Json& rates = j.at("rates_hz");
  const auto largest = [&](const char* key, const char* what) {
    if (!j.contains(key)) return;
    for (std::size_t i = 1; i < rates.size(); i++) {
      rows.push_back(headline({fmt::format("{}, {:g} Hz", what, rates[i].get<double>()),
                               fmt::format("{:.2f} %", j[key].at(i).get<double>()),
                               fmt::format("of {:g} Hz", rates.at(0).get<double>())}));
    }
  };
  largest("static_difference_percent", "largest static difference");
  largest("dynamic_difference_percent", "largest difference in a landing");
  for (const Json& q : j.at("quantities")) {
    for (std::size_t i = 0; i < rates.size(); i++) {
      rows.push_back(
          {fmt::format("{}, {:g} Hz", q.at("name").get<std::string>(), rates[i].get<double>()),
           number(q.at("values").at(i), q.at("unit")),
           fmt::format("{:+.2f} %", q.at("difference_percent").at(i).get<double>())});
    }
  }
  return rows;
}

std::vector<Row> benchRows(const Json& j) {
  const double rtf = j.at("rtf_600hz");
  std::vector<Row> rows = {
      headline({"real-time factor of one core, 600 Hz", fmt::format("{:.2f}", rtf), "0.03 - 0.13",
                std::nullopt, "Lee et al. 2023"}),
      {"real-time factor of one core, 200 Hz",
       fmt::format("{:.2f}", j.at("rtf_200hz").get<double>()), ""},
      {"a step at 600 Hz", number(j.at("step_us"), "us"), ""},
      {"a step at 200 Hz", number(j.at("step_200hz_us"), "us"), ""}};
  if (!j.at("ratio_to_fixed_torso").is_null()) {
    rows.push_back(headline({"cost of a step to that with a fixed torso",
                             fmt::format("{:.1f} x", j["ratio_to_fixed_torso"].get<double>()),
                             "60 x", std::nullopt, "Lee et al. 2023"}));
  }
  rows.push_back({"speed of two threads to that of one",
                  fmt::format("{:.2f} x", j.at("threads_2_speedup").get<double>()), ""});
  for (const auto& [part, us] : j.at("parts_us").items()) {
    rows.push_back({"part of a step at 600 Hz: " + part, number(us, "us"), ""});
  }
  rows.push_back({"mj_loadXML", number(j.at("viewing").at("load_s"), "s"), ""});
  const double frame = j["viewing"].at("frame_ms");
  rows.push_back({"a frame of the viewer", number(1e-3 * frame, "s"), ""});
  return rows;
}

std::vector<Row> runRows(const Json& j) {
  const int failed = j.at("failed"), runs = j.at("runs");
  const auto both = [&](const char* key) {
    return fmt::format("99 % below {}, largest {} mm", number(j.at(key).at("p99")),
                       number(j[key].at("max")));
  };
  return {headline({"falls without a failure or a warning",
                    fmt::format("{} of {}", j.at("warnings") == 0 ? runs - failed : 0, runs), "all",
                    failed == 0 && j["warnings"] == 0, "this project"}),
          {"bodies that end on the floor",
           fmt::format("{:.0f} %", 100 * j.at("bodies_on_floor").get<double>()), ""},
          {"mean thickness of a disc",
           fmt::format("{:.2f} - {:.2f} of rest", j.at("min_disc_thickness_ratio").get<double>(),
                       j.at("max_disc_thickness_ratio").get<double>()),
           ""},
          {"thickness of single columns",
           fmt::format("{:.2f} - {:.2f} of rest", j.at("min_disc_column_ratio").get<double>(),
                       j.at("max_disc_column_ratio").get<double>()),
           ""},
          {"ligaments beyond their length", both("ligament_violation_mm"), ""},
          {"facets beyond their band", both("facet_violation_mm"), ""},
          {"largest pressure of a disc", number(j.at("max_disc_pressure_mpa"), "MPa"), ""},
          {"real-time factor of one core", number(j.at("real_time_factor")), ""}};
}

std::vector<Row> fallRows(const Json& j) {
  std::vector<Row> rows;
  for (const Json& model : j.at("models")) {
    const std::string torso = model.at("torso").get<std::string>() + " torso";
    for (const char* part : {"landing", "fall"}) {
      const Json& p = model.at(part);
      const std::string where = part == std::string("landing") ? ", on landing" : ", all the fall";
      const auto value = [&](const char* key, const std::string& unit, double scale = 1) {
        const auto at = [&](const char* which) {
          return scale * p.at(key).at(which).get<double>();
        };
        if (at("lowest") == at("highest")) return number(at("mean"), unit);
        return fmt::format("{} ({} - {})", number(at("mean"), unit), number(at("lowest")),
                           number(at("highest")));
      };
      const bool landing = part == std::string("landing");
      rows.push_back(
          {torso + where + ": force of the floor", value("floor_force_bw", "body weights"), ""});
      rows.back().headline = landing;
      rows.push_back(
          {torso + where + ": force of the floor", value("floor_force_n", "kN", 1e-3), ""});
      rows.push_back(
          {torso + where + ": acceleration of the head", value("head_acceleration_g", "g"), ""});
      rows.push_back({torso + where + ": exceeded for 3 ms", value("head_3ms_g", "g"),
                      "limit of crash tests: " + number(j.at("head_3ms_limit_g"), "g"),
                      p.at("head_3ms_g").at("highest") <= j["head_3ms_limit_g"],
                      "UN Regulation 94"});
      rows.back().headline = landing;
      rows.push_back({torso + where + ": HIC15", value("hic15", ""),
                      "limit of crash tests: " + number(j.at("hic15_limit")),
                      p.at("hic15").at("highest") <= j["hic15_limit"], "FMVSS 208"});
    }
    rows.push_back(
        {torso + ": runs in which the head meets the floor",
         fmt::format("{} of {}", number(model.at("heads_on_floor")), number(j.at("seeds"))), ""});
  }
  return rows;
}

std::vector<Row> truthRows(const Json& j) {
  std::vector<Row> rows;
  double worst = 0, core = 0;
  const Json& motions = j.is_array() ? j : j.at("motions");
  for (const Json& m : motions) {
    const std::string name = m.at("motion");
    worst = std::max(worst, m.at("worst_level_rms_deg").get<double>());
    core = std::max(core, m.at("core_s_per_s").get<double>());
    rows.push_back({name + ", worst level " + m.at("worst_level").get<std::string>(),
                    number(m["worst_level_rms_deg"], "deg rms"), ""});
    rows.push_back({name + ", lumbar, thoracic, cervical, scapula",
                    fmt::format("{}, {}, {}, {} deg rms", number(m.at("lumbar_rms_deg")),
                                number(m.at("thoracic_rms_deg")), number(m.at("cervical_rms_deg")),
                                number(m.at("scapula_rms_deg"))),
                    ""});
    rows.push_back({name + ", what is held",
                    fmt::format("{} mm, {} deg", number(m.at("held_error_mm")),
                                number(m.at("held_error_deg"))),
                    ""});
    rows.push_back({name + ", cost", number(m["core_s_per_s"], "core-s a second"), "250",
                    std::nullopt, "Lee et al. 2023"});
  }
  rows.insert(rows.begin(),
              {headline({"known motions found again, worst level", number(worst, "deg rms"), ""}),
               headline({"core-seconds for a second of motion, at most", number(core), "about 250",
                         std::nullopt, "Lee et al. 2023"})});
  return rows;
}

std::vector<Row> retrofitRows(const Json& j) {
  const std::vector<std::map<std::string, std::string>> takes = tableOf(j.get<std::string>());
  int failed = 0, close = 0, near = 0, loud = 0, jumpy = 0;
  double frames = 0, flagged = 0, within_3mm = 0, within_10mm = 0;
  std::vector<double> cost, power, jump;
  for (const auto& take : takes) {
    if (!take.at("error").empty()) {
      failed++;
      continue;
    }
    const auto value = [&](const char* column) { return std::stod(take.at(column)); };
    frames += value("frames");
    flagged += value("frames_flagged");
    within_3mm += value("frames_within_3mm_1deg");
    within_10mm += value("frames_within_10mm_3deg");
    close += value("held_median_mm") < 3 && value("held_median_deg") < 1;
    near += value("held_p95_mm") < 10 && value("held_p95_deg") < 3;
    cost.push_back(value("core_s_per_s"));
    if (take.at("power_above_band_over_input").empty()) continue;
    power.push_back(value("power_above_band_over_input"));
    jump.push_back(value("largest_jump_deg"));
    loud += power.back() > 1;
    jumpy += jump.back() > 8;
  }
  const std::string all = fmt::format("{} of {}", takes.size() - failed, takes.size());
  const auto share = [&](double part) { return fmt::format("{:.1f} %", 100 * part / frames); };
  const auto of = [&](int part, std::size_t whole) { return fmt::format("{} of {}", part, whole); };
  const std::size_t done = takes.size() - failed;
  if (done == 0) return {headline({"takes that go through", all, "all", false})};
  std::vector<Row> rows = {
      headline({"takes that go through", all, ""}),
      {"frames", number(frames), ""},
      headline({"held bones within 10 mm and 3 deg", share(within_10mm), ""}),
      {"held bones within 3 mm and 1 deg", share(within_3mm), ""},
      {"frames flagged", share(flagged), ""},
      {"takes with medians below 3 mm and 1 deg", of(close, done), ""},
      {"takes with 95 % of the frames below 10 mm and 3 deg", of(near, done), ""},
      headline({"core-seconds for a second of motion, median take", number(median(cost)),
                "about 250", std::nullopt, "Lee et al. 2023"})};
  if (power.empty()) return rows;
  rows.push_back(
      {"power above the input's band to the input's, median take", number(median(power)), ""});
  rows.push_back({"takes with more than the input's", of(loud, power.size()), ""});
  rows.push_back({"largest second difference of a level or scapula, median take",
                  number(median(jump), "deg a frame"), ""});
  rows.push_back({"takes with one above 8 deg a frame", of(jumpy, jump.size()), ""});
  return rows;
}

std::vector<Row> optimizeRows(const Json& j) {
  const std::string task = j.at("task").get<std::string>();
  std::vector<Row> rows;
  if (j.contains("bodies")) {
    for (const Json& body : j["bodies"]) {
      const std::string name = task + ", " + body.at("model").get<std::string>();
      rows.push_back(headline(
          {name + ", mean cost of the seeds", number(body.at("mean_cost")), "", std::nullopt, ""}));
      if (!body.at("sd").is_null()) rows.push_back({name + ", SD", number(body["sd"]), ""});
      rows.push_back({name + ", a run [core-s]", number(body.at("core_s")), "at most 1800",
                      body["core_s"].get<double>() <= 1800, ""});
      for (const Json& spine : body.value("spines", Json::array())) {
        rows.push_back({name + ", power of the neck above 10 Hz",
                        number(spine.at("neck_power_above_10_hz")), ""});
      }
    }
    if (j.contains("core_s_ratio")) {
      rows.push_back({"cost of the detailed torso to that of the fixed one",
                      number(j["core_s_ratio"]), "60", std::nullopt, "Lee et al. 2023"});
    }
  } else {
    rows = {headline({task + ", best cost", number(j.at("best_cost")), "", std::nullopt, ""}),
            {"cost at the start", number(j.at("start_cost")), ""},
            {"parameters", number(j.at("parameters")), ""},
            {"nominal cost of each iteration", listOf(j, "nominal_cost"), ""},
            {"best cost of each iteration", listOf(j, "best_cost"), ""}};
    if (j.contains("spine")) {
      rows.push_back(
          {"power of the neck above 10 Hz", number(j["spine"].at("neck_power_above_10_hz")), ""});
    }
  }
  rows.push_back({"iterations", number(j.at("iterations")), "30", std::nullopt, "Lee et al. 2023"});
  rows.push_back({"simulated in an iteration [s]", number(j.at("simulated_s_per_iteration")), ""});
  for (const char* key : {"samples", "horizon_s", "timestep_s", "temperature", "noise", "seed"}) {
    if (j.at("settings").contains(key)) rows.push_back({text(key), number(j["settings"][key]), ""});
  }
  return rows;
}

std::vector<Row> benchmarkRows(const Json& j) {
  std::vector<Row> rows;
  std::istringstream lines(j.get<std::string>());
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find(' '), at = line.find_first_not_of(' ', end);
    if (line.find('/') >= end || at == std::string::npos) continue;  // not a benchmark's name
    rows.push_back({line.substr(0, end), line.substr(at), ""});
  }
  return rows;
}

std::vector<Row> testRows(const Json& j) {
  std::vector<Row> rows;
  std::istringstream lines(j.get<std::string>());
  int passed = 0, all = 0;
  std::string name;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t run = line.find("[ RUN      ] ");
    if (run != std::string::npos) name = line.substr(run + 13);
    // " 7/46 Test  #78: name ... Passed  1.2 sec"
    if (line.find(" Test ") < line.find('#') && line.find(" sec") != std::string::npos) {
      all++;
      passed += line.find(" Passed ") != std::string::npos;
    }
    // "12: text": what a test prints.
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos || colon > 5) continue;
    const std::string said = line.substr(colon + 2);
    if (said.empty() || said[0] == '[' || said.find_first_of("0123456789") == std::string::npos ||
        said.find("gtest") != std::string::npos || said.find("Test ") == 0 ||
        said.find("tests ran") != std::string::npos) {
      continue;
    }
    rows.push_back({name, said, ""});
  }
  rows.insert(rows.begin(), headline({"tests that print figures, passed",
                                      fmt::format("{} of {}", passed, all), "all", passed == all}));
  return rows;
}

}  // namespace torso::tools
