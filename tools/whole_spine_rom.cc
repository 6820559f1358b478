// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/whole_spine_rom.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "model/csv.h"
#include "model/parallel.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180;
constexpr int kSteps = 2;

TurnAngles pureMotions(WholeSpine& spine, const std::function<SpineLoad(Turn)>& load) {
  TurnAngles angles;
  for (const Turn turn : kTurns) {
    const SpinePose end = spine.load(load(turn), kSteps).back();
    for (const Vector3d& level : end.levels) {
      angles[static_cast<int>(turn)].push_back(level.dot(turnAxis(turn)));
    }
  }
  return angles;
}

double centralRange(std::vector<double> angles) {
  std::sort(angles.begin(), angles.end());
  const auto at = [&](double share) {
    return angles[static_cast<std::size_t>(std::lround(share * (angles.size() - 1.0)))];
  };
  return at(0.975) - at(0.025);
}

}  // namespace

LevelSpread levelSpread(const std::array<std::vector<double>, 3>& angles) {
  return {centralRange(angles[1]), centralRange(angles[0]) / 2, centralRange(angles[2]) / 2};
}

const std::vector<SpineRegion>& spineRegions() {
  static const std::vector<SpineRegion> regions = {
      {"C3-T1", 17, 21}, {"T1-L1", 5, 16}, {"L1-S1", 0, 4}};
  return regions;
}

double regionMotion(const TurnAngles& angles, int first, int last, Motion motion) {
  double sum = 0;
  for (int i = first; i <= last; i++) {
    const auto of = [&](Turn turn) { return angles[static_cast<int>(turn)][i]; };
    sum += motion == kFlexion            ? of(Turn::kFlexion)
           : motion == kExtension        ? of(Turn::kExtension)
           : motion == kFlexionExtension ? of(Turn::kFlexion) + of(Turn::kExtension)
           : motion == kLateralBending   ? of(Turn::kLeftBending)
                                         : of(Turn::kLeftRotation);
  }
  return sum;
}

std::vector<PublishedMotion> readRegionMotion(const std::string& path) {
  const CsvTable table(path);
  std::vector<std::string> motions;
  for (int k = 0; k < kNumMotions; k++) motions.push_back(motionName(static_cast<Motion>(k)));
  std::vector<PublishedMotion> rows;
  for (int i = 0; i < table.rows(); i++) {
    const std::string& loading = table.text(i, "loading");
    rows.push_back({table.text(i, "region"), loading,
                    static_cast<Motion>(table.word(i, "motion", motions)),
                    table.number(i, "value") * (loading == "ribcage_removed" ? 0.01 : kDegree),
                    table.text(i, "source"), table.text(i, "provenance")});
  }
  return rows;
}

WholeSpineReport measureWholeSpine(const Anatomy& anatomy, const Skeleton& skeleton, int mixtures,
                                   unsigned seed, int threads,
                                   const std::function<void(double)>& progress) {
  WholeSpineReport report;
  const std::vector<Vector3d> weights = randomWeights(mixtures, seed);
  // The mixtures in two parts, so that two threads have as much to do as each other.
  std::vector<std::vector<Vector3d>> poses(mixtures);
  std::atomic<int> done{0};
  constexpr int kParts = 4;
  forEach(kParts, threads, [&](int part) {
    SpineParts parts;
    parts.ribcage = part != 1;
    WholeSpine spine(anatomy, skeleton, parts);
    if (part < 2) {
      spine.stand(laboratoryLoad(anatomy, Vector3d::Zero()));
      (part == 0 ? report.laboratory : report.laboratory_without_ribcage) =
          pureMotions(spine, [&](Turn t) { return laboratoryLoad(anatomy, turnAxis(t)); });
    } else {
      spine.stand(standingLoad(anatomy));
      if (part == 2) {
        report.voluntary = pureMotions(spine, [&](Turn t) { return voluntaryLoad(anatomy, t); });
      }
      for (int i = part - 2; i < mixtures; i += 2) {
        poses[i] = spine.load(mixedLoad(anatomy, weights[i]), 1).back().levels;
      }
    }
    progress(static_cast<double>(++done) / kParts);
  });
  if (mixtures == 0) return report;
  for (std::size_t level = 0; level < anatomy.discs.size(); level++) {
    std::array<std::vector<double>, 3> angles;
    for (const auto& pose : poses) {
      for (int k = 0; k < 3; k++) angles[k].push_back(pose[level][k]);
    }
    // Pure motions belong to them, those to one side mirrored to the other.
    const auto of = [&](Turn t) { return report.voluntary[static_cast<int>(t)][level]; };
    angles[1].insert(angles[1].end(), {of(Turn::kFlexion), -of(Turn::kExtension)});
    angles[0].insert(angles[0].end(), {of(Turn::kLeftBending), -of(Turn::kLeftBending)});
    angles[2].insert(angles[2].end(), {of(Turn::kLeftRotation), -of(Turn::kLeftRotation)});
    report.spread.push_back(levelSpread(angles));
  }
  return report;
}

}  // namespace torso::tools
