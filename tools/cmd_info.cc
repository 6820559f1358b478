// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/commands.h"
#include "tools/extent.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model;
  bool json = false;
};

Json describe(const mjModel* m, const torsoInfo& torso, const std::string& path) {
  int free_joints = 0, ball_joints = 0;
  for (int j = 0; j < m->njnt; j++) {
    free_joints += m->jnt_type[j] == mjJNT_FREE;
    ball_joints += m->jnt_type[j] == mjJNT_BALL;
  }
  Json discs = Json::array();
  for (int i = 0; i < torso.ndisc; i++) {
    int nodes = 0, tets = 0;
    torso_discSize(m, i, &nodes, &tets);
    discs.push_back({{"name", torso_discName(m, i)}, {"nodes", nodes}, {"tets", tets}});
  }
  return {{"model", path},
          {"torsos", torso.ntorso},
          {"dof", m->nv},
          {"free_joints", free_joints},
          {"ball_joints", ball_joints},
          {"discs", discs},
          {"ligaments", torso.nligament},
          {"ligament_segments", torso.nligsegment},
          {"facets", torso.nfacet},
          {"facet_points", torso.nfacetpoint},
          {"mass_kg", mj_getTotalmass(m)},
          {"stature_m", stature(m)},
          {"bodies", m->nbody - 1},
          {"geoms", m->ngeom},
          {"actuators", m->nu},
          {"sensors", m->nsensor},
          {"equality_constraints", m->neq},
          {"tendons", m->ntendon},
          {"timestep_s", m->opt.timestep},
          {"userdata", m->nuserdata},
          {"userdata_of_discs", torso.nuserdata}};
}

void print(const Json& info) {
  fmt::print("{}\n", info["model"].get<std::string>());
  for (const auto& [key, value] : info.items()) {
    if (key == "model" || key == "torsos" || key == "discs") continue;
    fmt::print("  {:<21}{}\n", key, value.dump());
  }
  if (info["torsos"] == 0) {
    fmt::print("  It holds no torso data: MuJoCo simulates it without the torso plugin's part.\n");
    return;
  }
  fmt::print("  {} torso, {} discs:\n", info["torsos"].dump(), info["discs"].size());
  for (const Json& disc : info["discs"]) {
    fmt::print("    {:<9}{:>4} nodes {:>5} tetrahedra\n", disc["name"].get<std::string>(),
               disc["nodes"].get<int>(), disc["tets"].get<int>());
  }
}

void info(const Options& options) {
  const ModelPtr m = loadModel(options.model);
  const Json json = describe(m.get(), torsoOf(m.get(), options.model), options.model);
  if (options.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    print(json);
  }
}

}  // namespace

void addInfo(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "What a model contains, and whether it is sound.");
  command->footer(
      "The stature is that of the pose qpos0, from the bottom of the lowest to the top of the\n"
      "highest geom of the bodies.\n\n"
      "Examples:\n"
      "  torso info mjcf/human.xml\n"
      "  torso info mjcf/human.xml --json | jq .dof");
  command->add_option("MODEL", options->model, "MJCF, URDF or MJB file")->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { info(*options); });
}

}  // namespace torso::tools
