// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/motion_bvh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "plugin/mujoco_torso.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

struct Bone {
  int body;
  int parent;  // bone, -1: the root
  std::vector<int> children;
};

// From the world's axes (x forward, y left, z up) to BVH's (x left, y up, z forward), [cm].
Vector3d bvhVector(const Vector3d& v) { return 100 * Vector3d(v.y(), v.z(), v.x()); }
Matrix3d bvhRotation(const Matrix3d& R) {
  static const Matrix3d P = (Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished();
  return P * R * P.transpose();
}

// Bodies with joints as a tree, parents first.
std::vector<Bone> boneTree(const mjModel* m) {
  std::vector<int> parent_body(m->nbody, 0);
  for (int b = 1; b < m->nbody; b++) parent_body[b] = m->body_parentid[b];
  for (int i = 0; i < torsoOf(m, "model").ndisc; i++) {
    int bodies[2];
    torso_discBodies(m, i, bodies);
    if (m->body_parentid[bodies[1]] == 0) parent_body[bodies[1]] = bodies[0];
  }
  const int ribcage = mj_name2id(m, mjOBJ_BODY, "ribcage"), t7 = mj_name2id(m, mjOBJ_BODY, "T7");
  if (ribcage > 0 && t7 > 0) parent_body[ribcage] = t7;
  std::vector<Bone> bones;
  std::vector<int> bone_of_body(m->nbody, -1);
  // As many rounds as the tree is deep.
  for (bool found = true; found;) {
    found = false;
    for (int b = 1; b < m->nbody; b++) {
      if (bone_of_body[b] >= 0 || m->body_jntnum[b] == 0) continue;
      const int parent = parent_body[b] ? bone_of_body[parent_body[b]] : -1;
      if (parent_body[b] && parent < 0) continue;
      bone_of_body[b] = static_cast<int>(bones.size());
      if (parent >= 0) bones[parent].children.push_back(bone_of_body[b]);
      bones.push_back({b, parent, {}});
      found = true;
    }
  }
  return bones;
}

struct Pose {
  Vector3d position;
  Quaterniond rotation;
};

std::vector<Pose> poses(const mjModel* m, mjData* d, const std::vector<Bone>& bones) {
  mj_kinematics(m, d);
  std::vector<Pose> result;
  for (const Bone& bone : bones) {
    const mjtNum *p = d->xpos + 3 * bone.body, *q = d->xquat + 4 * bone.body;
    result.push_back({{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}});
  }
  return result;
}

void writeJoint(const mjModel* m, const std::vector<Bone>& bones, const std::vector<Pose>& rest,
                int i, int depth, std::string* text, std::vector<int>* order) {
  order->push_back(i);
  const Bone& bone = bones[i];
  const std::string indent(2 * depth, ' ');
  const Vector3d offset =
      bone.parent < 0 ? Vector3d::Zero() : bvhVector(rest[i].position - rest[bone.parent].position);
  *text += fmt::format("{}{} {}\n{}{{\n", indent, bone.parent < 0 ? "ROOT" : "JOINT",
                       nameOf(m, mjOBJ_BODY, bone.body), indent);
  *text +=
      fmt::format("{}  OFFSET {:.5f} {:.5f} {:.5f}\n", indent, offset.x(), offset.y(), offset.z());
  *text += fmt::format("{}  CHANNELS {}Zrotation Xrotation Yrotation\n", indent,
                       bone.parent < 0 ? "6 Xposition Yposition Zposition " : "3 ");
  for (int child : bone.children) writeJoint(m, bones, rest, child, depth + 1, text, order);
  if (bone.children.empty()) {
    // To the centre of mass: in the middle of a hand, a foot or the head.
    const mjtNum* c = m->body_ipos + 3 * bone.body;
    const Vector3d end = bvhVector(2 * (rest[i].rotation * Vector3d(c[0], c[1], c[2])));
    *text += fmt::format("{}  End Site\n{}  {{\n{}    OFFSET {:.5f} {:.5f} {:.5f}\n{}  }}\n",
                         indent, indent, indent, end.x(), end.y(), end.z(), indent);
  }
  *text += indent + "}\n";
}

}  // namespace

std::string motionBvh(const mjModel* m, const Motion& motion) {
  const DataPtr d = makeData(m);
  const std::vector<Bone> bones = boneTree(m);
  const std::vector<Pose> rest = poses(m, d.get(), bones);
  std::string text = "HIERARCHY\n";
  std::vector<int> order;  // of the channels
  for (std::size_t i = 0; i < bones.size(); i++) {
    if (bones[i].parent < 0) writeJoint(m, bones, rest, static_cast<int>(i), 0, &text, &order);
  }
  text += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.8f}\n", motion.frames(), 1 / motion.rate);
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    const std::vector<Pose> now = poses(m, d.get(), bones);
    const auto turn = [&](int i) { return now[i].rotation * rest[i].rotation.conjugate(); };
    std::string line;
    for (int i : order) {
      Quaterniond relative = turn(i);
      if (bones[i].parent < 0) {
        const Vector3d p = bvhVector(now[i].position);
        line += fmt::format(" {:.5f} {:.5f} {:.5f}", p.x(), p.y(), p.z());
      } else {
        relative = turn(bones[i].parent).conjugate() * relative;
      }
      // R = Rz(z) Rx(x) Ry(y)
      const Matrix3d R = bvhRotation(relative.toRotationMatrix());
      const double x = std::asin(std::min(1.0, std::max(-1.0, R(2, 1))));
      const double z = std::atan2(-R(0, 1), R(1, 1)), y = std::atan2(-R(2, 0), R(2, 2));
      const double degrees = 180 / EIGEN_PI;
      line += fmt::format(" {:.5f} {:.5f} {:.5f}", degrees * z, degrees * x, degrees * y);
    }
    text += line.substr(1) + "\n";
  }
  return text;
}

}  // namespace torso::tools
