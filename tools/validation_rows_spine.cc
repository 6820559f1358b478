// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Rows of how the spine moves.

#include <fmt/format.h>

#include <cmath>

#include "model/csv.h"
#include "tools/paths.h"
#include "tools/validation_figures.h"
#include "tools/validation_rows.h"

namespace torso::tools {

std::vector<Row> romRows(const Json& j) {
  std::vector<Row> rows;
  for (const Json& m : j.at("motions")) {
    rows.push_back({m.at("disc").get<std::string>() + " " + text(m.at("motion")),
                    number(m.at("ours_deg"), "deg"),
                    number(m.at("mean_deg"), "deg") + range(m.at("low_deg"), m.at("high_deg")),
                    m.at("inside").get<bool>(), m.at("sources")});
  }
  rows.insert(rows.begin(), count("range of motion of segments", rows, "published ranges"));
  return rows;
}

std::vector<Row> wholeSpineRows(const Json& j) {
  std::vector<Row> rows;
  for (const Json& r : j.at("regions")) {
    const std::string name = r.at("region").get<std::string>() + " " + text(r.at("motion"));
    const double ours = r.at("voluntary_deg"), published = r.at("in_vivo_deg");
    rows.push_back(headline(
        {name + ", voluntary", number(ours, "deg"),
         fmt::format("{} ({:+.0f} %)", number(published, "deg"), 100 * (ours / published - 1)),
         r.at("inside").get<bool>(), r.at("source")}));
    rows.push_back({name + ", laboratory moments", number(r.at("laboratory_deg"), "deg"), ""});
    if (!r.contains("published_without_ribcage")) continue;
    const double more =
        100 * (r.at("without_ribcage_deg").get<double>() / r["laboratory_deg"].get<double>() - 1);
    for (const Json& p : r["published_without_ribcage"]) {
      rows.push_back({name + ", wider without rib cage", fmt::format("{:+.0f} %", more),
                      fmt::format("{:+.0f} %", 100 * p.at("increase").get<double>()), std::nullopt,
                      p.at("source")});
    }
  }
  return rows;
}

std::vector<Row> identifyRows(const Json& j) {
  std::vector<Row> rows, shorter;
  for (const Json& disc : j.at("discs")) {
    const std::string name = disc.at("disc");
    for (const Json& p : disc.at("poses")) {
      rows.push_back({name + " " + text(p.at("turn")), number(p.at("reached_deg"), "deg"),
                      number(p.at("target_deg"), "deg"), p.at("feasible").get<bool>(),
                      "range_of_motion.csv"});
    }
    for (const Json& s : disc.at("a_step_shorter")) {
      const bool tight = !s.at("loses").is_null() || s.at("slack").get<bool>();
      shorter.push_back({name + " " + s.at("ligament").get<std::string>() + ", a step shorter",
                         s.at("slack").get<bool>() ? "slack in all poses"
                         : tight                   ? "loses a pose"
                                                   : "loses none",
                         "loses a pose", tight, "feasibility test of Lee et al. 2023"});
    }
  }
  std::vector<Row> all = {count("extreme poses that random actions reach", rows, "all"),
                          count("ligaments that could not be shorter", shorter, "all")};
  all.insert(all.end(), rows.begin(), rows.end());
  all.insert(all.end(), shorter.begin(), shorter.end());
  return all;
}

std::vector<Row> preloadRows(const Json& j) {
  const CsvTable table(anatomyFolder() + "/preload.csv");
  std::vector<Row> rows;
  for (const Json& load : j) {
    const double follower = load.at("follower_n");
    for (const std::string quantity : {"stiffness", "motion"}) {
      for (const auto& [motion, ratio] : load.at(quantity).items()) {
        Row row{fmt::format("{} of {} N, {}", quantity, number(follower), text(motion)),
                fmt::format("{:.2f} x", ratio.get<double>()), ""};
        for (int i = 0; i < table.rows(); i++) {
          const std::string& which = table.text(i, "motion");
          if (table.text(i, "region") != "L1-S1" || table.text(i, "quantity") != quantity ||
              table.number(i, "follower_n") != follower || (which != "all" && which != motion)) {
            continue;
          }
          row.published = fmt::format("{:.2f} x", table.number(i, "ratio"));
          row.source = table.text(i, "source");
        }
        rows.push_back(row);
      }
    }
  }
  return rows;
}

std::vector<Row> ablateRows(const Json& j) {
  std::vector<Row> rows;
  for (const char* spine : {"whole", "without_ligaments"}) {
    if (!j.contains(spine)) continue;
    const Json &forward = j[spine].at("hanging_forward"), &back = j[spine].at("hanging_backward");
    const Json& bend = j[spine].at("forward_bend");
    const std::string name = spine == std::string("whole") ? "whole spine" : text(spine);
    const auto both = [](const Json& low, const Json& high) {
      return fmt::format("{:.1f} to {:.1f} deg", low.get<double>(), high.get<double>());
    };
    const bool without = name != "whole spine";
    rows.push_back(
        headline({name + ", L5 against the sacrum, back to forward",
                  both(back.at("levels_deg").at("L5/S1"), forward.at("levels_deg").at("L5/S1")),
                  without ? "-30 to 60 deg" : "", std::nullopt, without ? "Lee et al. 2023" : ""}));
    rows.push_back({name + ", T12 against the sacrum",
                    both(back.at("flexion_deg"), forward.at("flexion_deg")), ""});
    rows.push_back({name + ", forward bend",
                    fmt::format("{:.0f} deg at {:.0f} Nm", bend.at("flexion_deg").get<double>(),
                                bend.at("moment_nm").get<double>()),
                    "65 deg asked for"});
    rows.push_back({name + ", largest share of one of six levels in it",
                    fmt::format("{:.0f} %", 100 * bend.at("largest_share").get<double>()), ""});
    for (const auto& [level, angle] : forward.at("levels_deg").items()) {
      rows.push_back({name + ", " + level, both(back["levels_deg"].at(level), angle), ""});
    }
  }
  for (const char* spine : {"gaps", "gaps_without_discs"}) {
    if (!j.contains(spine)) continue;
    const std::string name = spine == std::string("gaps") ? "whole spine" : "without discs";
    for (const Json& gap : j[spine]) {
      rows.push_back({fmt::format("{}, {}: poses in which the bodies collide", name,
                                  gap.at("disc").get<std::string>()),
                      fmt::format("{:.0f} %", 100 * gap.at("collisions").get<double>()), ""});
      rows.push_back({fmt::format("{}, {}: mean gap", name, gap["disc"].get<std::string>()),
                      number(gap.at("mean_mm"), "mm"),
                      fmt::format("{} mm at rest", number(gap.at("rest_mm")))});
    }
  }
  return rows;
}

}  // namespace torso::tools
