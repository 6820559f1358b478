// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/rom_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "model/csv.h"
#include "model/parallel.h"

namespace torso::tools {
namespace {

constexpr int kSteps = 10;
constexpr double kDegree = EIGEN_PI / 180;

// The turns that a motion consists of.
std::vector<Turn> turnsOf(Motion motion) {
  switch (motion) {
    case kFlexion:
      return {Turn::kFlexion};
    case kExtension:
      return {Turn::kExtension};
    case kFlexionExtension:
      return {Turn::kFlexion, Turn::kExtension};
    case kLateralBending:
      return {Turn::kLeftBending};
    default:
      return {Turn::kLeftRotation};
  }
}

}  // namespace

double followerLoad(Region region) { return region == Region::kCervical ? 100 : 400; }

RomReport measureRom(const Anatomy& anatomy, const Skeleton& skeleton,
                     const std::vector<std::string>& names, const SegmentParts& parts,
                     bool follower, int threads, const std::function<void(double)>& progress) {
  std::vector<const Disc*> discs;
  for (const Disc& disc : anatomy.discs) {
    if (names.empty() || std::find(names.begin(), names.end(), disc.name) != names.end()) {
      discs.push_back(&disc);
    }
  }
  const int n = static_cast<int>(discs.size()), turns = static_cast<int>(std::size(kTurns));
  std::vector<LevelCurve> curves(n * turns);
  std::atomic<int> done{0};
  forEach(n, threads, [&](int i) {
    const Disc& disc = *discs[i];
    SegmentBench bench(anatomy, skeleton, disc.name, parts,
                       follower ? followerLoad(disc.region) : 0);
    for (int k = 0; k < turns; k++) {
      curves[i * turns + k] = {disc.name, kTurns[k],
                               bench.load(kTurns[k], laboratoryMoment(disc.region), kSteps)};
    }
    progress(static_cast<double>(++done) / n);
  });
  RomReport report;
  for (int i = 0; i < n; i++) {
    const auto end = [&](Turn turn) {
      return curves[i * turns + static_cast<int>(turn)].poses.back().angle;
    };
    const double flexion = end(Turn::kFlexion), extension = end(Turn::kExtension);
    const double angles[kNumMotions] = {flexion, extension, flexion + extension,
                                        end(Turn::kLeftBending), end(Turn::kLeftRotation)};
    const RangeOfMotion& range = anatomy.range_of_motion.at(discs[i]->name);
    for (int k = 0; k < kNumMotions; k++) {
      report.motions.push_back({discs[i]->name, static_cast<Motion>(k), angles[k], range[k]});
    }
  }
  report.curves = std::move(curves);
  return report;
}

double regionSum(const Anatomy& anatomy, const RomReport& report, Region region, Motion motion) {
  double sum = 0;
  for (const LevelMotion& m : report.motions) {
    if (m.motion == motion && anatomy.disc(m.disc).region == region) sum += m.angle;
  }
  return sum;
}

double laxZone(const std::vector<SegmentPose>& poses) {
  const SegmentPose &end = poses.back(), &before = poses[poses.size() - 2];
  const double slope = (end.angle - before.angle) / (end.moment - before.moment);
  return std::max(0.0, end.angle - slope * end.moment);
}

double coupledMotion(const LevelCurve& curve) {
  const Turn other = curve.turn == Turn::kLeftBending ? Turn::kLeftRotation : Turn::kLeftBending;
  const SegmentPose& end = curve.poses.back();
  return end.rotation.dot(turnAxis(other)) / end.angle;
}

std::vector<PublishedKinematics> readPublishedKinematics(const std::string& path) {
  std::vector<PublishedKinematics> rows;
  const CsvTable table(path);
  for (int i = 0; i < table.rows(); i++) {
    const std::string& quantity = table.text(i, "quantity");
    const double unit = quantity.rfind("neutral_zone_", 0) == 0 ? kDegree : 1;
    rows.push_back({table.text(i, "disc"), quantity, unit * table.number(i, "value"),
                    table.text(i, "sources"), table.text(i, "provenance")});
  }
  return rows;
}

std::vector<MotionBounds> boundsOfMisses(const Anatomy& anatomy, const Skeleton& skeleton,
                                         const RomReport& report, int threads) {
  std::vector<MotionBounds> misses;
  for (const LevelMotion& motion : report.motions) {
    if (!motion.inside()) misses.push_back({motion, 0, 0, {}});
  }
  forEach(static_cast<int>(misses.size()), threads, [&](int i) {
    MotionBounds& miss = misses[i];
    const Disc& disc = anatomy.disc(miss.motion.disc);
    const auto turn = [&](const SegmentParts& parts, std::vector<std::string>* taut) {
      SegmentBench bench(anatomy, skeleton, disc.name, parts);
      double angle = 0;
      for (const Turn t : turnsOf(miss.motion.motion)) {
        const SegmentPose end = bench.load(t, laboratoryMoment(disc.region), kSteps).back();
        angle += end.angle;
        if (!taut) continue;
        for (const std::string& name : bench.taut(end)) {
          if (std::find(taut->begin(), taut->end(), name) == taut->end()) taut->push_back(name);
        }
      }
      return angle;
    };
    miss.disc = turn({false, false}, nullptr);
    miss.disc_and_facets = turn({false, true}, nullptr);
    turn({true, true}, &miss.taut);
  });
  return misses;
}

std::string reason(const MotionBounds& bounds) {
  const LevelMotion& m = bounds.motion;
  std::string text = fmt::format("the bare disc turns by {:.1f} deg, with facets by {:.1f}; ",
                                 bounds.disc / kDegree, bounds.disc_and_facets / kDegree);
  if (m.disc == "C2/C3") {
    return text +
           "no ligaments and no facets are here, as the head's ball joint stands for C0-C2, too, "
           "which turn by 15 deg in flexion, 32 in extension, 12 in bending, 46 in rotation "
           "(Panjabi 1989, Proc SPIE 1030)";
  }
  if (bounds.taut.empty()) {
    text += "no ligament holds, as each is longer in another extreme pose";
    if (m.disc[0] == 'T') {
      text += "; the segments of Wilke 2017 had their costovertebral joints, which are not here";
    }
    if (m.disc == "L5/S1") {
      text +=
          "; the iliolumbar ligaments, which are not here, take 0.3 deg (Yamamoto 1990, Spine "
          "15:1138-1141)";
    }
    return text;
  }
  return text + fmt::format("these hold it: {}", fmt::join(bounds.taut, ", "));
}

}  // namespace torso::tools
