// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/run_report.h"

#include <fmt/format.h>

#include <string>

#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

Json place(const mjModel* m, const Extreme& extreme, const char* kind) {
  if (extreme.id < 0) return nullptr;
  std::string name;
  if (std::string(kind) == "tendon") {
    name = nameOf(m, mjOBJ_TENDON, extreme.id);
  } else {
    const char* found = std::string(kind) == "disc" ? torso_discName(m, extreme.id)
                                                    : torso_facetName(m, extreme.id);
    name = found ? found : std::to_string(extreme.id);
  }
  return {{kind, name}, {"seed", extreme.seed}, {"time_s", extreme.time}};
}

// "0.93 (L4/L5, seed 3, 0.82 s)"
std::string withPlace(double value, const Json& where) {
  if (where.is_null()) return fmt::format("{:.3g}", value);
  return fmt::format("{:.3g} ({}, seed {}, {:.2f} s)", value, where.begin()->get<std::string>(),
                     where["seed"].dump(), where["time_s"].get<double>());
}

}  // namespace

Json describeRuns(const mjModel* m, const RolloutSummary& s, int discs) {
  const Extremes& e = s.extremes;
  Json json = {{"runs", s.runs.size()},
               {"failed", s.failed},
               {"warnings", s.warnings},
               {"dof", m->nv},
               {"timestep_s", m->opt.timestep},
               {"simulated_s", s.simulated_seconds},
               {"core_s", s.core_seconds},
               {"wall_s", s.wall_seconds},
               {"real_time_factor", s.core_seconds > 0 ? s.simulated_seconds / s.core_seconds : 0},
               {"active_constraints", s.mean_constraints},
               {"bodies_on_floor", s.has_floor ? Json(s.on_floor) : Json()},
               {"state_hash", fmt::format("{:016x}", s.state_hash)}};
  if (discs > 0) {
    json["max_disc_pressure_mpa"] = 1e-6 * e.max_disc_pressure.value;
    json["min_disc_thickness_ratio"] = e.min_disc_thickness.value;
    json["max_disc_thickness_ratio"] = e.max_disc_thickness.value;
    json["min_disc_column_ratio"] = e.min_disc_column.value;
    json["max_disc_column_ratio"] = e.max_disc_column.value;
  } else {
    for (const char* key :
         {"max_disc_pressure_mpa", "min_disc_thickness_ratio", "max_disc_thickness_ratio",
          "min_disc_column_ratio", "max_disc_column_ratio"}) {
      json[key] = nullptr;
    }
  }
  json["ligament_violation_mm"] = {{"p99", 1e3 * s.violations.ligament.quantile(0.99)},
                                   {"max", 1e3 * e.max_ligament_violation.value}};
  json["facet_violation_mm"] = {{"p99", 1e3 * s.violations.facet.quantile(0.99)},
                                {"max", 1e3 * e.max_facet_violation.value}};
  json["at"] = {{"max_disc_pressure", place(m, e.max_disc_pressure, "disc")},
                {"min_disc_thickness", place(m, e.min_disc_thickness, "disc")},
                {"max_disc_thickness", place(m, e.max_disc_thickness, "disc")},
                {"min_disc_column", place(m, e.min_disc_column, "disc")},
                {"max_disc_column", place(m, e.max_disc_column, "disc")},
                {"max_ligament_violation", place(m, e.max_ligament_violation, "tendon")},
                {"max_facet_violation", place(m, e.max_facet_violation, "facet")}};
  Json failures = Json::array();
  for (const RunResult& run : s.runs) {
    if (!run.failure.empty()) failures.push_back({{"seed", run.seed}, {"what", run.failure}});
  }
  json["failures"] = failures;
  return json;
}

void printRuns(const Json& j) {
  const auto row = [](const char* name, const std::string& value) {
    fmt::print("{:<36}{}\n", name, value);
  };
  const auto number = [&](const char* key) { return j[key].get<double>(); };
  row("runs", fmt::format("{} ({} failed, {} warnings)", j["runs"].dump(), j["failed"].dump(),
                          j["warnings"].dump()));
  row("degrees of freedom", j["dof"].dump());
  row("active constraints, mean", fmt::format("{:.0f}", number("active_constraints")));
  row("simulated time [s]", fmt::format("{:.2f}, in steps of {:.3g} ms", number("simulated_s"),
                                        1e3 * number("timestep_s")));
  row("wall time [s]", fmt::format("{:.2f}", number("wall_s")));
  row("real-time factor of one core", fmt::format("{:.2f}", number("real_time_factor")));
  if (!j["bodies_on_floor"].is_null()) {
    row("runs that end on the floor", fmt::format("{:.0f} %", 100 * number("bodies_on_floor")));
  }
  if (j["max_disc_pressure_mpa"].is_null()) return;
  const Json& at = j["at"];
  row("largest disc pressure [MPa]",
      withPlace(number("max_disc_pressure_mpa"), at["max_disc_pressure"]));
  row("disc thickness to that at rest, min",
      withPlace(number("min_disc_thickness_ratio"), at["min_disc_thickness"]));
  row("  max", withPlace(number("max_disc_thickness_ratio"), at["max_disc_thickness"]));
  row("  min of any column", withPlace(number("min_disc_column_ratio"), at["min_disc_column"]));
  row("  max of any column", withPlace(number("max_disc_column_ratio"), at["max_disc_column"]));
  row("ligament violation [mm], 99 %",
      fmt::format("{:.3g}", j["ligament_violation_mm"]["p99"].get<double>()));
  row("  max", withPlace(j["ligament_violation_mm"]["max"], at["max_ligament_violation"]));
  row("facet violation [mm], 99 %",
      fmt::format("{:.3g}", j["facet_violation_mm"]["p99"].get<double>()));
  row("  max", withPlace(j["facet_violation_mm"]["max"], at["max_facet_violation"]));
}

}  // namespace torso::tools
