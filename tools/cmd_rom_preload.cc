// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/csv.h"
#include "tools/bone_files.h"
#include "tools/paths.h"
#include "tools/preload_study.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMotions[] = {"flexion_extension", "lateral_bending", "axial_rotation"};

struct Published {
  double follower, ratio;
  std::string region, quantity, motion, source;
};

std::vector<Published> readPublished(const std::string& path) {
  const CsvTable table(path);
  std::vector<Published> rows;
  for (int i = 0; i < table.rows(); i++) {
    rows.push_back({table.number(i, "follower_n"), table.number(i, "ratio"),
                    table.text(i, "region"), table.text(i, "quantity"), table.text(i, "motion"),
                    table.text(i, "source")});
  }
  return rows;
}

// Those beside ours, in a word: "1.71 (Gardner-Morse & Stokes 2004)".
std::string beside(const std::vector<Published>& rows, double follower, const std::string& quantity,
                   const std::string& motion) {
  std::string text;
  for (const Published& row : rows) {
    if (row.region != "L1-S1" || row.follower != follower || row.quantity != quantity) continue;
    if (row.motion != "all" && row.motion != motion) continue;
    text += fmt::format("{}{:.2f} ({})", text.empty() ? "" : ", ", row.ratio, row.source);
  }
  return text;
}

}  // namespace

void romPreload(bool json) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const std::vector<Published> published = readPublished(anatomyFolder() + "/preload.csv");
  const std::vector<PreloadEffect> effects =
      measurePreload(anatomy, skeleton, {250, 500, 720, 1200});
  if (json) {
    Json rows = Json::array();
    for (const PreloadEffect& effect : effects) {
      Json row = {{"follower_n", effect.follower}};
      for (int k = 0; k < 3; k++) {
        row["stiffness"][kMotions[k]] = effect.stiffness[k];
        row["motion"][kMotions[k]] = effect.motion[k];
      }
      rows.push_back(row);
    }
    std::cout << rows.dump(2) << '\n';
    return;
  }
  fmt::print("L1 against the sacrum, as a ratio to that without follower load\n");
  fmt::print("{:>9}  {:<20}{:>10}  {:<44}{:>8}  {}\n", "load [N]", "motion", "stiffness",
             "published", "range", "published");
  for (const PreloadEffect& effect : effects) {
    for (int k = 0; k < 3; k++) {
      fmt::print("{:>9.0f}  {:<20}{:>10.2f}  {:<44}{:>8.2f}  {}\n", effect.follower, kMotions[k],
                 effect.stiffness[k], beside(published, effect.follower, "stiffness", kMotions[k]),
                 effect.motion[k], beside(published, effect.follower, "motion", kMotions[k]));
    }
  }
}

}  // namespace torso::tools
