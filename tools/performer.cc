// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/performer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/limb_lengths.h"
#include "model/median.h"
#include "tools/error.h"
#include "tools/graft_host.h"
#include "tools/role_tree.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

using Place = std::function<Vector3d(int joint)>;  // in one pose

Vector3d mid(const Place& at, const std::array<int, 2>& pair) {
  return 0.5 * (at(pair[0]) + at(pair[1]));
}

double angle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

// How far a pose is from standing upright [deg]: the largest angle of thighs and shins against the
// trunk, and a third of that between the lines of hips and of shoulders and of the head's lean.
double leaning(const Roles& r, const Place& at) {
  Vector3d up;
  if (r.hasArms() && r.hasLegs()) {
    up = mid(at, r.upper_arm) - mid(at, r.thigh);
  } else if (r.head >= 0) {
    up = at(r.head) - (r.hasLegs() ? mid(at, r.thigh) : at(r.hips));
  } else {
    return 180;
  }
  double worst = 0;
  for (int k = 0; k < 2 && r.hasLegs(); k++) {
    const Vector3d knee = at(r.shin[k]);
    worst = std::max(worst, angle(-up, knee - at(r.thigh[k])));
    if (r.foot[k] >= 0) worst = std::max(worst, angle(-up, at(r.foot[k]) - knee));
  }
  if (r.hasArms() && r.hasLegs()) {
    const double twist =
        angle(at(r.upper_arm[0]) - at(r.upper_arm[1]), at(r.thigh[0]) - at(r.thigh[1]));
    worst = std::max(worst, twist);
  }
  if (r.head >= 0 && r.hasArms()) {
    worst = std::max(worst, angle(up, at(r.head) - mid(at, r.upper_arm)) / 3);
  }
  return std::isfinite(worst) ? worst : 180;
}

// The file's up axis: what it declares counts most for glTF and FBX, little for BVH; then a rest
// pose that stands, then how the trunk is held on the mean of the clip.
Vector3d upAxis(const Clip& clip, const Roles& r, const RoleTree& tree, double rest_leaning) {
  const bool bvh = !clip.unit;
  std::array<double, 6> votes{};  // x, y, z, -x, -y, -z
  const auto vote = [&](const Vector3d& direction, double weight) {
    for (int k = 0; k < 3; k++) {
      votes[k] += weight * std::max(0.0, direction[k]);
      votes[3 + k] += weight * std::max(0.0, -direction[k]);
    }
  };
  if (clip.up) vote(*clip.up, bvh ? 1.2 : 4);
  const auto upwards = [&](const Place& at) {
    const Vector3d low = r.hasLegs() ? mid(at, r.foot[0] >= 0 ? r.foot : r.thigh) : at(r.hips);
    const Vector3d high = r.head >= 0 ? at(r.head) : mid(at, r.upper_arm);
    return Vector3d((high - low).normalized());
  };
  if (rest_leaning < 40) {
    vote(upwards([&](int j) { return Vector3d(clip.rest[j].translation()); }), 1.0);
  }
  Vector3d mean = Vector3d::Zero();
  for (size_t f : tree.sample) {
    mean += upwards([&](int j) { return tree.position(f, j); });
  }
  mean /= static_cast<double>(tree.sample.size());
  if (mean.allFinite()) vote(mean, 1.5);
  const auto best = std::max_element(votes.begin(), votes.end()) - votes.begin();
  return (best < 3 ? 1 : -1) * Vector3d::Unit(best % 3);
}

}  // namespace

Clip inWorld(const Clip& clip, const Performer& p) {
  Clip out = clip;
  const auto turn = [&](Isometry3d& X) {
    X.translation() = p.unit * (p.axes * X.translation()).eval();
    X.linear() = (p.axes * X.linear()).eval();
  };
  for (Isometry3d& X : out.rest) turn(X);
  for (Isometry3d& X : out.poses) turn(X);
  out.unit = 1;
  out.up = Vector3d::UnitZ();
  return out;
}

const Isometry3d& standingPose(const Clip& world, const Performer& p, int joint) {
  return p.standing_frame < 0 ? world.rest[joint]
                              : world.pose(static_cast<size_t>(p.standing_frame), joint);
}

namespace {

struct UsualUnit {
  double size;  // [m]
  const char* name;
};
// The unit of the CMU data base is 1/0.45 inch.
constexpr UsualUnit kUsualUnits[] = {
    {0.01, "cm"},  {1, "m"},    {0.0254 / 0.45, "CMU's unit"},           {0.0254, "inch"},
    {0.001, "mm"}, {0.1, "dm"}, {0.000254 / 0.45, "1/100 of CMU's unit"}};
constexpr double kShortest = 1.3, kTallest = 2.2;  // persons whose unit is believed [m]

// Length of a limb's segment in the file's unit: median over a sample of the clip, mean of both
// sides; 0 if the clip does not have it.
double segmentLength(const RoleTree& tree, const std::array<int, 2>& from,
                     const std::array<int, 2>& to) {
  double sum = 0;
  for (int k = 0; k < 2; k++) {
    if (from[k] < 0 || to[k] < 0) return 0;
    std::vector<double> lengths;
    for (size_t f : tree.sample) {
      lengths.push_back((tree.position(f, to[k]) - tree.position(f, from[k])).norm());
    }
    sum += median(lengths);
  }
  return sum / 2;
}

void findUnit(const Anatomy& tables, const Clip& clip, double body_ratio, Performer& p) {
  // body_ratio: the tables' lengths [m] times this are the file's.
  const auto stature = [&](double unit) { return tables.stature() * body_ratio * unit; };
  const auto plausible = [&](double unit) {
    return stature(unit) > kShortest && stature(unit) < kTallest;
  };
  if (clip.unit && plausible(*clip.unit)) {
    p.unit = *clip.unit;
    return;
  }
  for (const UsualUnit& unit : kUsualUnits) {
    if (!plausible(unit.size)) continue;
    p.unit = unit.size;
    p.notes.push_back(fmt::format("the unit is taken to be {}: a stature of {:.2f} m", unit.name,
                                  stature(unit.size)));
    return;
  }
  p.unit = 1 / body_ratio;
  p.notes.push_back(fmt::format(
      "no usual unit gives a person's stature; it is taken to be {:.2f} m, a unit of {:.3g} m",
      tables.stature(), p.unit));
}

// Where the shoulders of the standing pose would be with hanging arms: as they are to the chest in
// the frames in which the arms hang.
std::array<Vector3d, 2> hangingShoulders(const Clip& clip, const Roles& r, const Performer& p,
                                         const Place& standing) {
  std::array<Vector3d, 2> shoulders = {standing(r.upper_arm[0]), standing(r.upper_arm[1])};
  if (r.lower_arm[0] < 0 || r.clavicle[0].empty()) return shoulders;  // they are fixed to the chest
  const Vector3d up = 0.5 * (shoulders[0] + shoulders[1]) -
                      (r.hasLegs() ? mid(standing, r.thigh) : standing(r.hips));
  constexpr double kHanging = 40;  // [deg] against the trunk
  const Isometry3d& chest = standingPose(clip, p, r.chest());
  const Vector3d local_up = chest.linear().transpose() * up;
  for (int k = 0; k < 2; k++) {
    const double raised = angle(standing(r.lower_arm[k]) - shoulders[k], -up);
    if (raised < kHanging) continue;
    std::vector<std::pair<double, Vector3d>> places;  // how far raised, and where in the chest
    double least = 180;
    for (size_t f = 0; f < clip.frames(); f++) {
      const Isometry3d inverse = clip.pose(f, r.chest()).inverse();
      const Vector3d shoulder = inverse * clip.pose(f, r.upper_arm[k]).translation();
      const Vector3d elbow = inverse * clip.pose(f, r.lower_arm[k]).translation();
      places.emplace_back(angle(elbow - shoulder, -local_up), shoulder);
      least = std::min(least, places.back().first);
    }
    if (least > raised - 20) continue;
    // Where arms never hang, the frames in which they hang most.
    Vector3d sum = Vector3d::Zero();
    size_t count = 0;
    for (const auto& [degrees, shoulder] : places) {
      if (degrees > std::max(kHanging, least + 10)) continue;
      sum += shoulder;
      count++;
    }
    shoulders[k] = chest * (sum / (static_cast<double>(count) * p.standing_size)).eval();
  }
  return shoulders;
}

}  // namespace

Performer measurePerformer(const Anatomy& tables, const Clip& clip, const Roles& r) {
  const RoleTree tree(clip);
  Performer p;
  const Place rest = [&](int j) { return Vector3d(clip.rest[j].translation()); };

  // ---- where the person stands
  const double rest_leaning = leaning(r, rest);
  p.stands = rest_leaning < 35;
  if (!p.stands) {
    double least = 60;
    for (size_t f = 0; f < clip.frames(); f += 1 + clip.frames() / 500) {
      const double lean = leaning(r, [&](int j) { return tree.position(f, j); });
      if (lean >= least) continue;
      least = lean;
      p.standing_frame = static_cast<int>(f);
      p.stands = true;
    }
    p.notes.push_back(
        p.stands ? fmt::format("the rest pose is no standing one; neutral posture is taken from "
                               "frame {}, which is within {:.0f} degrees of standing",
                               p.standing_frame + 1, least)
                 : "nobody stands in the rest pose or in any frame; the neutral posture of pelvis "
                   "and head is guessed from the rest pose");
  }

  // ---- axes
  const Vector3d up = upAxis(clip, r, tree, rest_leaning);
  Eigen::Index axis;
  up.cwiseAbs().maxCoeff(&axis);
  p.axes.setZero();
  p.axes(2, axis) = p.axes(0, (axis + 1) % 3) = p.axes(1, (axis + 2) % 3) = 1;
  if (up[axis] < 0) p.axes.bottomRows<2>() *= -1;
  if (clip.up && up.dot(*clip.up) < 0.5) {
    p.notes.push_back(
        fmt::format("up is {}{}, by the posture", up[axis] < 0 ? "-" : "", "xyz"[axis]));
  }

  // ---- lengths in the file's unit, and the tables'
  const std::array<double, 4> theirs = {
      segmentLength(tree, r.upper_arm, r.lower_arm), segmentLength(tree, r.lower_arm, r.hand),
      segmentLength(tree, r.thigh, r.shin), segmentLength(tree, r.shin, r.foot)};
  const auto length = [&](const char* from, const char* to) {
    return (tables.landmark(to) - tables.landmark(from)).norm();
  };
  const std::array<double, 4> ours = {length("glenohumeral_centre_GH", "elbow"),
                                      length("elbow", "wrist"), length("hip_joint_centre", "knee"),
                                      length("knee", "ankle")};
  const auto checked = [&](const char* segment, const std::array<int, 2>& joints, double value) {
    if (joints[0] < 0 || value > 0) return;
    throw Error(fmt::format("{}: the {} has no length; export the clip with the skeleton's bones",
                            clip.path, segment));
  };
  if (r.lower_arm[0] >= 0) checked("upper arm", r.lower_arm, theirs[0]);
  if (r.shin[0] >= 0) checked("thigh", r.shin, theirs[2]);
  const Place standing = [&](int j) {
    return p.standing_frame < 0 ? rest(j) : tree.position(static_cast<size_t>(p.standing_frame), j);
  };
  // The rest pose may be in another unit than the frames.
  const auto& bone = r.hasLegs() ? std::pair(r.thigh, r.shin) : std::pair(r.upper_arm, r.lower_arm);
  const double then = (standing(bone.second[0]) - standing(bone.first[0])).norm() +
                      (standing(bone.second[1]) - standing(bone.first[1])).norm();
  const double now = 2 * theirs[r.hasLegs() ? 2 : 0];
  if (then > 0 && now > 0) p.standing_size = now / then;
  double limbs = 0, our_limbs = 0;
  for (int k = 0; k < 4; k++) {
    if (theirs[k] > 0) limbs += theirs[k], our_limbs += ours[k];
  }
  double torso = 0, our_torso = 0;
  if (r.hasArms()) {
    p.hanging_shoulders = hangingShoulders(clip, r, p, standing);
    const Vector3d shoulder = 0.5 * (p.hanging_shoulders[0] + p.hanging_shoulders[1]);
    const Vector3d hip = r.hasLegs() ? mid(standing, r.thigh) : standing(r.hips);
    const auto middle = [&](const char* landmark) {
      Vector3d x = tables.landmark(landmark);
      x.y() = 0;
      return x;
    };
    torso = (shoulder - hip).norm();
    our_torso = (middle("glenohumeral_centre_GH") -
                 (r.hasLegs() ? middle("hip_joint_centre") : Vector3d::Zero()))
                    .norm();
    torso *= p.standing_size;
  }
  if (!(torso > 0 && std::isfinite(torso))) {
    if (r.hasArms() && r.hasLegs()) {
      throw Error(clip.path + ": hips and shoulders are in one place; the trunk has no length");
    }
    torso = limbs / our_limbs, our_torso = 1;
    p.notes.push_back("the trunk's size goes with the limbs'");
  }
  if (!(limbs > 0)) throw Error(clip.path + ": its limbs have no length");

  // ---- size
  findUnit(tables, clip, (limbs + torso) / (our_limbs + our_torso), p);
  p.torso_scale = p.unit * torso / our_torso;
  const auto ratio = [&](int k, int other) {
    const int use = theirs[k] > 0 ? k : other;
    return theirs[use] > 0 ? p.unit * theirs[use] / (ours[use] * p.torso_scale) : 1.0;
  };
  p.limb_scale = {{"upper_arm", ratio(0, 1)},
                  {"lower_arm", ratio(1, 0)},
                  {"thigh", ratio(2, 3)},
                  {"shin", ratio(3, 2)}};
  // Hands and feet, whose ends clips have in different places, go with the rest of the limb.
  p.limb_scale["hand"] = (p.limb_scale["upper_arm"] + p.limb_scale["lower_arm"]) / 2;
  p.limb_scale["foot"] = (p.limb_scale["thigh"] + p.limb_scale["shin"]) / 2;
  for (const auto& [segment, scale] : p.limb_scale) {
    if (scale < 0.5 || scale > 1.6) {
      p.notes.push_back(
          fmt::format("odd proportions: a {} {:.2f} times as long as a person's with this trunk",
                      segment, scale));
    }
    if (scale > 0.15 && scale < 7) continue;
    throw Error(
        fmt::format("{}: a {} {:.2g} times as long as a person's with this trunk; check "
                    "the roles with --explain, or give a --map",
                    clip.path, segment, scale));
  }
  p.anatomy = withLimbs(tables.scaled(p.torso_scale, std::pow(p.torso_scale, 3)), p.limb_scale);
  return p;
}

}  // namespace torso::tools
