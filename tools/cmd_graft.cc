// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/commands.h"
#include "tools/graft.h"
#include "tools/paths.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

// The humanoid's bodies of a part: "'a', 'b'".
std::string quoted(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("'{}'", fmt::join(names, "', '"));
}

Json describe(const GraftReport& report, const GraftOptions& options) {
  Json changes = Json::array();
  for (const GraftChange& c : report.changes) {
    changes.push_back(
        {{"action", c.action}, {"kind", c.kind}, {"name", c.name}, {"detail", c.detail}});
  }
  Json parts = Json::object();
  for (const RecognisedPart& p : report.parts) {
    parts[p.part] = {{"bodies", p.bodies}, {"sureness", p.sureness}, {"reason", p.reason}};
  }
  return {{"input", options.input},
          {"output", options.dry_run ? Json() : Json(options.output)},
          {"parts", parts},
          {"length_scale", report.length_scale},
          {"mass_scale", report.mass_scale},
          {"mass_before_kg", report.mass_before},
          {"mass_after_kg", report.mass_after},
          {"hip_to_shoulder_before_m", report.hip_to_shoulder_before},
          {"hip_to_shoulder_after_m", report.hip_to_shoulder_after},
          {"limb_joints", report.limb_joints},
          {"changes", changes}};
}

void print(const GraftReport& report) {
  for (const RecognisedPart& p : report.parts) {
    fmt::print(stderr, "{:<16}{}: {} ({}){}\n", p.part, quoted(p.bodies), p.sureness, p.reason,
               p.sureness == "unsure" ? "; if it is not, give '" + p.part + "' in a --map" : "");
  }
  for (const GraftChange& c : report.changes) {
    fmt::print(stderr, "{:<9}{:<9} {}: {}\n", c.action, c.kind, c.name, c.detail);
  }
  fmt::print(stderr,
             "torso: {:.3f} x the length and {:.3f} x the mass of the tables'\n"
             "mass {:.3f} kg (was {:.3f}), hip to shoulder {:.3f} m (was {:.3f}), {} limb joints "
             "kept\n",
             report.length_scale, report.mass_scale, report.mass_after, report.mass_before,
             report.hip_to_shoulder_after, report.hip_to_shoulder_before, report.limb_joints);
}

}  // namespace

void addGraft(CLI::App& app) {
  struct Command {
    GraftOptions graft;
    std::string anatomy;
    bool json = false;
  };
  auto options = std::make_shared<Command>();
  CLI::App* command =
      app.add_subcommand("graft", "Put the torso into an MJCF humanoid, in place of its own.");
  command->footer(
      "Keeps legs, arms, assets, defaults, actuators, sensors, cameras and lights; replaces all\n"
      "between thighs, upper arms and the top of the head. The report on stderr names every\n"
      "element that is not as it was, and says how sure it is which body is what. Bone meshes go\n"
      "to torso_assets/ beside the output.\n\n"
      "Actuators of trunk joints become servos of the levels in their place, with name, place in\n"
      "ctrl, range and sense. --group adds lumbar_, thoracic_ and cervical_ x flexion,\n"
      "lateral_bending and axial_rotation [rad] for what those leave: servos on the rotation\n"
      "between a region's end bones, which its levels share by their stiffness.\n\n"
      "Examples:\n"
      "  torso graft /usr/share/mujoco/model/humanoid/humanoid.xml -o humanoid_torso.xml\n"
      "  torso graft humanoid.xml -o out.xml --dry-run --json | jq .changes\n"
      "  torso graft humanoid.xml -o out.xml --dry-run --write-map map.json\n"
      "  torso graft humanoid.xml -o out.xml --map map.json --group");
  command->add_option("HUMANOID", options->graft.input, "MJCF file")->required();
  command->add_option("-o,--output", options->graft.output, "MJCF file to write")->required();
  command->add_option("--prefix", options->graft.prefix, "Put before every name of the torso");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->add_option("--map", options->graft.map,
                      "JSON file that says which body is what, over what is recognised");
  command->add_option("--write-map", options->graft.write_map,
                      "Write what was recognised to this file, to be edited for --map");
  command->add_flag("--group", options->graft.groups,
                    "Add servos that bend the lumbar, thoracic and cervical levels together");
  command
      ->add_option("--timestep", options->graft.timestep,
                   "Time step [s]; otherwise the humanoid's, but at most 1/600")
      ->check(CLI::PositiveNumber);
  command->add_flag("--keep-integrator", options->graft.keep_integrator,
                    "Keep RK4, which is otherwise replaced by Euler");
  command->add_flag("--dry-run", options->graft.dry_run, "Report, but write nothing");
  command->add_flag("--json", options->json, "Print the report as JSON on stdout");
  command->callback([options] {
    if (options->anatomy.empty()) {
      options->anatomy = anatomyFolder();
      options->graft.meshes = mjcfFolder() + "/assets";
    }
    const GraftReport report = graft(Anatomy::load(options->anatomy), options->graft);
    if (options->json) {
      std::cout << describe(report, options->graft).dump(2) << '\n';
    } else {
      print(report);
      if (!options->graft.dry_run) fmt::print("{}\n", options->graft.output);
    }
  });
}

}  // namespace torso::tools
