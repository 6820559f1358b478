// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/body.h"
#include "tools/graft_host.h"
#include "tools/retarget.h"
#include "tools/retarget_floor.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Axes of a bone: z against its direction, y as near to `left` as may be, x forward.
Matrix3d boneAxes(const Vector3d& direction, const Vector3d& left) {
  Matrix3d R;
  R.col(2) = -direction.normalized();
  R.col(1) = (left - left.dot(R.col(2)) * R.col(2)).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

// A limb: its joints in the clip, and what of them is constant.
struct LimbChain {
  std::array<int, 4> joint;  // upper, lower, end, tip; -1: none
  std::array<LimbBody, 3> body;
  std::array<const char*, 4> landmark;  // of the joints of our body; the tip's: where it points
  bool arm;
};

const LimbChain& chainOf(bool arm) {
  static const LimbChain chains[2] = {
      {{}, {kThigh, kShin, kFoot}, {"hip_joint_centre", "knee", "ankle", "toe_tip"}, false},
      {{},
       {kUpperArm, kLowerArm, kHand},
       {"glenohumeral_centre_GH", "elbow", "wrist", "hand_tip"},
       true}};
  return chains[arm];
}

class TargetMaker {
 public:
  TargetMaker(const Clip& world, const Roles& roles, const Performer& performer)
      : w_(world), r_(roles), p_(performer), a_(performer.anatomy) {}

  Targets make();

 private:
  Vector3d at(size_t frame, int joint) const { return w_.pose(frame, joint).translation(); }
  Matrix3d turn(size_t frame, int joint) const { return w_.pose(frame, joint).linear(); }
  Vector3d standingAt(int joint) const { return standingPose(w_, p_, joint).translation(); }
  Matrix3d standingTurn(int joint) const { return standingPose(w_, p_, joint).linear(); }
  // Of our standing body, left or right.
  Vector3d landmark(const char* name, int side) const {
    const Vector3d p = a_.landmark(name);
    return side ? mirror(p) : p;
  }
  Vector3d rest(int body) const { return bodyFrame(a_, heldBodies()[body]).translation(); }
  Isometry3d& pose(size_t frame, int body) { return t_.poses[frame * heldBodies().size() + body]; }

  void findStandingAxes();
  void placePelvis();
  void placeShouldersAndHead();
  void placeLimb(int side, bool arm);
  struct Hinge {
    Vector3d upper = Vector3d::Zero(), lower = Vector3d::Zero();
    Vector3d our_upper = Vector3d::Zero(), our_lower = Vector3d::Zero();
  };
  std::optional<Hinge> hingeOf(const LimbChain& chain, const std::array<Vector3d, 4>& ours) const;
  void restOnParent(size_t frame, int body, int parent);

  const Clip& w_;
  const Roles& r_;
  const Performer& p_;
  const Anatomy& a_;
  Targets t_;
  Matrix3d standing_;  // axes of the person in the standing pose, as our body's at rest
};

void TargetMaker::findStandingAxes() {
  std::array<Vector3d, 2> hip, shoulder;
  const auto both = [&](const std::array<int, 2>& joints, std::array<Vector3d, 2>& places) {
    for (int k = 0; k < 2; k++) places[k] = standingAt(joints[k]);
  };
  const auto& ours = [&](const char* name) {
    return std::array{landmark(name, 0), landmark(name, 1)};
  };
  std::array<Vector3d, 2> our_hip = ours("hip_joint_centre");
  std::array<Vector3d, 2> our_shoulder = ours("glenohumeral_centre_GH");
  // What is missing is taken below or above what there is, in the clip and in our body.
  const auto moved = [](const std::array<Vector3d, 2>& pair, const Vector3d& to) {
    const Vector3d way = to - 0.5 * (pair[0] + pair[1]);
    return std::array<Vector3d, 2>{pair[0] + way, pair[1] + way};
  };
  if (r_.hasLegs()) both(r_.thigh, hip);
  if (r_.hasArms()) both(r_.upper_arm, shoulder);
  if (!r_.hasLegs()) {
    hip = moved(shoulder, standingAt(r_.hips));
    our_hip = moved(our_shoulder, rest(kPelvis));
  } else if (!r_.hasArms()) {
    const bool head = r_.head >= 0;
    shoulder = moved(hip, head ? standingAt(r_.head) : hip[0] + Vector3d::UnitZ());
    our_shoulder = moved(our_hip, head ? rest(kHead) : our_hip[0] + Vector3d::UnitZ());
  }
  standing_ = trunkAxes(hip, shoulder) * trunkAxes(our_hip, our_shoulder).transpose();
}

void TargetMaker::placePelvis() {
  t_.has[kPelvis] = true;
  const Matrix3d C = standingTurn(r_.hips).transpose() * standing_;
  Vector3d middle = rest(kPelvis);  // of our hips
  if (r_.hasLegs())
    middle = 0.5 * (landmark("hip_joint_centre", 0) + landmark("hip_joint_centre", 1));
  for (size_t f = 0; f < t_.frames; f++) {
    Isometry3d& X = pose(f, kPelvis);
    X.linear() = turn(f, r_.hips) * C;
    const Vector3d hips =
        r_.hasLegs() ? Vector3d(0.5 * (at(f, r_.thigh[0]) + at(f, r_.thigh[1]))) : at(f, r_.hips);
    X.translation() = hips - X.linear() * (middle - rest(kPelvis));
  }
}

// Where our shoulders and head are in the clip's chest and head: they differ from the clip's joints
// by what they do in standing.
void TargetMaker::placeShouldersAndHead() {
  const int chest = r_.chest();
  const Vector3d origin = r_.hasLegs()
                              ? Vector3d(0.5 * (standingAt(r_.thigh[0]) + standingAt(r_.thigh[1])))
                              : standingAt(r_.hips);
  const Vector3d our_origin =
      r_.hasLegs()
          ? Vector3d(0.5 * (landmark("hip_joint_centre", 0) + landmark("hip_joint_centre", 1)))
          : rest(kPelvis);
  // From the clip's point to ours in standing, in world axes.
  const auto offset = [&](const Vector3d& theirs, const Vector3d& ours) {
    return Vector3d(standing_ * (ours - our_origin) - p_.standing_size * (theirs - origin));
  };
  t_.has_chest = r_.hasArms();
  const Matrix3d C = standingTurn(chest).transpose() * standing_;
  for (size_t f = 0; f < t_.frames; f++) {
    t_.chest.emplace_back(turn(f, chest) * C);
  }
  for (int k = 0; k < 2 && r_.hasArms(); k++) {
    const int joint = r_.upper_arm[k];
    const Vector3d local =
        standingTurn(chest).transpose() * offset(p_.unit * (p_.axes * p_.hanging_shoulders[k]),
                                                 landmark("glenohumeral_centre_GH", k));
    for (size_t f = 0; f < t_.frames; f++) {
      pose(f, heldBody(k, kUpperArm)).translation() = at(f, joint) + turn(f, chest) * local;
    }
  }
  if (r_.head < 0) return;
  t_.has[kHead] = true;
  // The pivot of the head keeps its place on the neck.
  const int neck = r_.neck.empty() ? chest : r_.neck.back();
  const Vector3d local = standingTurn(neck).transpose() * offset(standingAt(r_.head), rest(kHead));
  const Matrix3d H = standingTurn(r_.head).transpose() * standing_;
  for (size_t f = 0; f < t_.frames; f++) {
    Isometry3d& X = pose(f, kHead);
    X.linear() = turn(f, r_.head) * H;
    X.translation() = at(f, r_.head) + turn(f, neck) * local;
  }
}

// The axis to the body's left about which a limb's middle joint bends, in the frames of its upper
// and of its lower bone, in the clip and in our body: the normal of the plane of both bones (knees
// bend backwards, elbows forwards), on the mean of the frames, the more the limb is bent. Ours is
// bent by as much in each frame, for where bones do not lie in one plane (the elbow's carrying
// angle) the normal depends on that. Nothing if the limb does not bend enough to tell.
std::optional<TargetMaker::Hinge> TargetMaker::hingeOf(const LimbChain& c,
                                                       const std::array<Vector3d, 4>& ours) const {
  const auto& [upper, lower, end, tip] = c.joint;
  const double sense = c.arm ? -1 : 1;
  const Vector3d our_upper = (ours[1] - ours[0]).normalized(),
                 our_lower = (ours[2] - ours[1]).normalized();
  // Ours bent by an angle between its bones.
  const auto bent = [&](double cosine) {
    double low = 0, high = M_PI;
    for (int k = 0; k < 25; k++) {
      const double middle = (low + high) / 2;
      const Vector3d s = Eigen::AngleAxisd(sense * middle, Vector3d::UnitY()) * our_lower;
      (our_upper.dot(s) > cosine ? low : high) = middle;
    }
    return Eigen::AngleAxisd(sense * low, Vector3d::UnitY()).toRotationMatrix();
  };
  Hinge sum;
  double weight = 0;
  const size_t step = 1 + t_.frames / 2000;
  size_t count = 0;
  for (size_t f = 0; f < t_.frames; f += step, count++) {
    const Vector3d d = (at(f, lower) - at(f, upper)).normalized();
    const Vector3d s = (at(f, end) - at(f, lower)).normalized();
    Vector3d left = sense * d.cross(s);
    if (!left.allFinite() || left.norm() < 0.15) continue;
    const double share = left.norm();  // a straight limb says little
    left *= share;
    sum.upper += turn(f, upper).transpose() * left;
    sum.lower += turn(f, lower).transpose() * left;
    const Matrix3d R = bent(d.dot(s));
    const Vector3d our_left = sense * our_upper.cross(R * our_lower) * share;
    sum.our_upper += our_left;
    sum.our_lower += R.transpose() * our_left;
    weight += left.norm();
  }
  if (weight < 0.02 * static_cast<double>(count) || sum.upper.norm() < 0.8 * weight) return {};
  return sum;
}

void TargetMaker::restOnParent(size_t frame, int body, int parent) {
  const Isometry3d X =
      bodyFrame(a_, heldBodies()[parent]).inverse() * bodyFrame(a_, heldBodies()[body]);
  pose(frame, body) = pose(frame, parent) * X;
}

void TargetMaker::placeLimb(int side, bool arm) {
  LimbChain c = chainOf(arm);
  c.joint = arm ? std::array{r_.upper_arm[side], r_.lower_arm[side], r_.hand[side], -1}
                : std::array{r_.thigh[side], r_.shin[side], r_.foot[side], r_.toe[side]};
  const std::array<int, 3> body = {heldBody(side, c.body[0]), heldBody(side, c.body[1]),
                                   heldBody(side, c.body[2])};
  std::array<Vector3d, 4> ours;  // joints of our body at rest
  for (int k = 0; k < 4; k++) ours[k] = landmark(c.landmark[k], side);
  // Rest axes of our bones; elbows and knees bend about y.
  std::array<Matrix3d, 3> axes;
  for (int k = 0; k < 3; k++) axes[k] = boneAxes(ours[k + 1] - ours[k], Vector3d::UnitY());

  // What is constant in the clip: the left axis, in the frame of each joint.
  std::array<Vector3d, 3> left;
  const auto standingLeft = [&](int joint, const Vector3d& direction) {
    // Forward stays forward however the arm is raised in the standing pose.
    const Vector3d z = -direction.normalized(), forward = standing_.col(0);
    return Vector3d(standingTurn(joint).transpose() * z.cross(forward).normalized());
  };
  const bool has_upper = c.joint[0] >= 0 && c.joint[1] >= 0;
  const bool has_lower = has_upper && c.joint[2] >= 0 && !w_.joints[c.joint[1]].end;
  if (has_upper) {
    left[0] = standingLeft(c.joint[0], standingAt(c.joint[1]) - standingAt(c.joint[0]));
    t_.has[body[0]] = true;
  }
  if (has_lower) {
    t_.has[body[1]] = true;
    if (const std::optional<Hinge> hinge = hingeOf(c, ours)) {
      const double apart = std::acos(std::clamp(hinge->upper.normalized().dot(left[0]), -1.0, 1.0));
      if (p_.stands && apart > M_PI / 3) {
        t_.notes.push_back(fmt::format(
            "the {} {} bends {:.0f} degrees away from where it should by the standing pose",
            side ? "right" : "left", arm ? "elbow" : "knee", apart * 180 / M_PI));
      }
      left[0] = hinge->upper;
      left[1] = hinge->lower;
      axes[0] = boneAxes(ours[1] - ours[0], hinge->our_upper);
      axes[1] = boneAxes(ours[2] - ours[1], hinge->our_lower);
    } else {
      left[1] = standingLeft(c.joint[1], standingAt(c.joint[2]) - standingAt(c.joint[1]));
    }
  }
  // Hands and feet turn as their joints do, from the standing pose.
  Matrix3d end_turn = Matrix3d::Identity();
  const bool has_end = has_lower && !w_.joints[c.joint[2]].end;
  if (has_end) {
    const int joint = c.joint[2];
    if (arm) {
      // Straight on the forearm, the thumb in front, in a rest pose that stands; or else, for a
      // hand may be anywhere in a single frame, as the forearm on the mean of the clip.
      const Vector3d fore = standingAt(joint) - standingAt(c.joint[1]);
      Vector3d along = standingTurn(joint).transpose() * fore;
      Vector3d across = standingLeft(joint, fore);
      Matrix3d forearm = boneAxes(ours[2] - ours[1], Vector3d::UnitY());
      if (!p_.stands || p_.standing_frame >= 0) {
        along = across = Vector3d::Zero();
        forearm = axes[1];
        for (size_t f = 0; f < t_.frames; f += 1 + t_.frames / 2000) {
          along += turn(f, joint).transpose() * (at(f, joint) - at(f, c.joint[1])).normalized();
          across += turn(f, joint).transpose() * turn(f, c.joint[1]) * left[1];
        }
      }
      end_turn = boneAxes(along, across) * forearm.transpose();
    } else {
      end_turn = footTurn(w_, joint, c.joint[3], standingTurn(joint).transpose() * standing_,
                          ours[3] - ours[2]);
    }
    t_.has[body[2]] = true;
  }

  for (size_t f = 0; f < t_.frames; f++) {
    if (!arm) {
      const Isometry3d& pelvis = pose(f, kPelvis);
      pose(f, body[0]).translation() = pelvis * (ours[0] - rest(kPelvis));
    }
    for (int k = 0; k < 2; k++) {
      const bool has = k ? has_lower : has_upper;
      if (!has) {
        if (k || !arm || !has_upper) restOnParent(f, body[k], k ? body[0] : kPelvis);
        continue;
      }
      const Vector3d direction = at(f, c.joint[k + 1]) - at(f, c.joint[k]);
      const Matrix3d R = boneAxes(direction, turn(f, c.joint[k]) * left[k]);
      pose(f, body[k]).linear() = R * axes[k].transpose();
      pose(f, body[k + 1]).translation() = pose(f, body[k]) * (ours[k + 1] - ours[k]);
    }
    if (has_end) {
      pose(f, body[2]).linear() = turn(f, c.joint[2]) * end_turn;
    } else {
      restOnParent(f, body[2], body[1]);
    }
  }
}

Targets TargetMaker::make() {
  t_.frames = w_.frames();
  t_.poses.assign(t_.frames * heldBodies().size(), Isometry3d::Identity());
  t_.contact.assign(t_.frames, {0, 0});
  findStandingAxes();
  placePelvis();
  placeShouldersAndHead();
  for (int side = 0; side < 2; side++) {
    placeLimb(side, true);
    placeLimb(side, false);
  }
  for (size_t f = 0; f < t_.frames && r_.head < 0; f++) restOnParent(f, kHead, kPelvis);
  standOnFloor(w_, r_, a_, t_);
  return std::move(t_);
}

}  // namespace

const std::vector<std::string>& heldBodies() {
  static const std::vector<std::string> bodies = [] {
    std::vector<std::string> names = {"pelvis", "head"};
    for (const std::string side : {"left_", "right_"}) {
      for (const char* limb : {"upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
        names.push_back(side + limb);
      }
    }
    return names;
  }();
  return bodies;
}

Targets makeTargets(const Clip& world, const Roles& roles, const Performer& performer) {
  return TargetMaker(world, roles, performer).make();
}

}  // namespace torso::tools
