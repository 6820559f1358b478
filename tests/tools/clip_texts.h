// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Small motion capture files for tests: a person made of our own body's joint centres.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/body.h"

namespace torso::tools {

struct TestJoint {
  std::string name;
  int parent;
  Eigen::Vector3d place;  // at rest, our axes [m]
  bool end = false;
};

// Hips, two joints of the trunk, neck, head, clavicles, arms and legs of our standing body; names
// by `rename` (of "hips", "spine", "chest", "neck", "head", "left_clavicle", ... "left_foot" as
// Anatomy has them), ends apart.
inline std::vector<TestJoint> testPerson(
    const Anatomy& a, const std::function<std::string(const std::string&)>& rename =
                          [](const std::string& n) { return n; }) {
  std::vector<TestJoint> joints;
  const auto add = [&](const std::string& name, const std::string& parent,
                       const Eigen::Vector3d& place, bool end = false) {
    int p = -1;
    for (size_t j = 0; j < joints.size(); j++) {
      if (joints[j].name == parent) p = static_cast<int>(j);
    }
    joints.push_back({name, p, place, end});
  };
  const auto disc = [&](const char* name) { return a.disc(name).frame.translation(); };
  add("hips", "", Eigen::Vector3d::Zero());
  add("spine", "hips", disc("L4/L5"));
  add("chest", "spine", disc("T12/L1"));
  add("neck", "chest", disc("C7/T1"));
  add("head", "neck", a.landmark("head_pivot"));
  add("head_end", "head", a.landmark("head_vertex"), true);
  for (const std::string side : {"left_", "right_"}) {
    const auto at = [&](const char* landmark) {
      return side == "left_" ? a.landmark(landmark) : mirror(a.landmark(landmark));
    };
    add(side + "clavicle", "chest", at("sternoclavicular_joint_SC"));
    add(side + "upper_arm", side + "clavicle", at("glenohumeral_centre_GH"));
    add(side + "lower_arm", side + "upper_arm", at("elbow"));
    add(side + "hand", side + "lower_arm", at("wrist"));
    add(side + "hand_end", side + "hand", at("hand_tip"), true);
    add(side + "thigh", "hips", at("hip_joint_centre"));
    add(side + "shin", side + "thigh", at("knee"));
    add(side + "foot", side + "shin", at("ankle"));
    add(side + "toe_end", side + "foot", at("toe_tip"), true);
  }
  for (TestJoint& joint : joints) {
    if (!joint.end) joint.name = rename(joint.name);
  }
  return joints;
}

// The upper body of a testPerson with its own names.
inline std::vector<TestJoint> withoutLegs(const std::vector<TestJoint>& person) {
  std::vector<TestJoint> joints;
  std::vector<int> index(person.size(), -1);
  for (size_t j = 0; j < person.size(); j++) {
    const std::string part = splitSide(person[j].name).second;
    if (part == "thigh" || part == "shin" || part == "foot" || part == "toe_end") continue;
    index[j] = static_cast<int>(joints.size());
    joints.push_back(person[j]);
    if (person[j].parent >= 0) joints.back().parent = index[person[j].parent];
  }
  return joints;
}

// How a clip is written.
struct BvhStyle {
  double unit = 0.01;                                                                  // [m]
  Eigen::Matrix3d axes = (Eigen::Matrix3d() << 0, 1, 0, 0, 0, 1, 1, 0, 0).finished();  // from ours
  double rate = 60;                                                                    // [Hz]
};

// Turn of a joint against its parent in a frame, our axes; the root's place in the world [m].
using TestTurn = std::function<Eigen::Matrix3d(size_t joint, size_t frame)>;
using TestPlace = std::function<Eigen::Vector3d(size_t frame)>;

inline std::string bvhText(const std::vector<TestJoint>& joints, size_t frames,
                           const TestTurn& turn, const TestPlace& place,
                           const BvhStyle& style = {}) {
  std::string text = "HIERARCHY\n";
  std::vector<size_t> order;
  std::function<void(size_t, int)> write = [&](size_t j, int depth) {
    const std::string pad(static_cast<size_t>(depth), '\t');
    const bool root = joints[j].parent < 0;
    const Eigen::Vector3d from = root ? Eigen::Vector3d(joints[j].place)
                                      : joints[static_cast<size_t>(joints[j].parent)].place;
    const Eigen::Vector3d offset = style.axes * (joints[j].place - from) / style.unit;
    text += joints[j].end ? pad + "End Site\n"
                          : fmt::format("{}{} {}\n", pad, root ? "ROOT" : "JOINT", joints[j].name);
    text += fmt::format("{0}{{\n{0}\tOFFSET {1:.8g} {2:.8g} {3:.8g}\n", pad, offset.x(), offset.y(),
                        offset.z());
    if (!joints[j].end) {
      order.push_back(j);
      text += fmt::format("{}\tCHANNELS {} {}Zrotation Xrotation Yrotation\n", pad, root ? 6 : 3,
                          root ? "Xposition Yposition Zposition " : "");
    }
    for (size_t k = j + 1; k < joints.size(); k++) {
      if (joints[k].parent == static_cast<int>(j)) write(k, depth + 1);
    }
    text += pad + "}\n";
  };
  for (size_t j = 0; j < joints.size(); j++) {
    if (joints[j].parent < 0) write(j, 0);
  }
  text += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.9g}\n", frames, 1 / style.rate);
  for (size_t f = 0; f < frames; f++) {
    for (size_t j : order) {
      if (joints[j].parent < 0) {
        const Eigen::Vector3d p = style.axes * place(f) / style.unit;
        text += fmt::format("{:.8g} {:.8g} {:.8g} ", p.x(), p.y(), p.z());
      }
      const Eigen::Matrix3d R = style.axes * turn(j, f) * style.axes.transpose();
      const Eigen::Vector3d angles = R.eulerAngles(2, 0, 1) * 180 / M_PI;
      text += fmt::format("{:.8g} {:.8g} {:.8g} ", angles[0], angles[1], angles[2]);
    }
    text += "\n";
  }
  return text;
}

// World poses of the joints, our axes [m]: frames x joints.
inline std::vector<Eigen::Isometry3d> testPoses(const std::vector<TestJoint>& joints, size_t frames,
                                                const TestTurn& turn, const TestPlace& place) {
  std::vector<Eigen::Isometry3d> poses;
  for (size_t f = 0; f < frames; f++) {
    const size_t first = poses.size();
    for (size_t j = 0; j < joints.size(); j++) {
      Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
      if (joints[j].parent < 0) {
        X.translation() = place(f);
      } else {
        const auto parent = static_cast<size_t>(joints[j].parent);
        X = poses[first + parent] * Eigen::Translation3d(joints[j].place - joints[parent].place);
      }
      if (!joints[j].end) X.rotate(turn(j, f));
      poses.push_back(X);
    }
  }
  return poses;
}

inline Eigen::Matrix3d turnAbout(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix();
}

// A smooth motion of all of testPerson's joints, by their plain names: arms and legs swing and
// bend, the trunk bends and twists, the head turns. `phase` in turns.
inline Eigen::Matrix3d testTurn(const std::string& name, double phase) {
  const double s = std::sin(2 * M_PI * phase), c = 1 - std::cos(2 * M_PI * phase);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const auto [side, part] = splitSide(name);
  const double left = side == Side::kRight ? -1 : 1;
  if (name == "hips") return turnAbout(z, 30 * s) * turnAbout(y, 8 * s);
  if (name == "spine") return turnAbout(y, 8 * c) * turnAbout(z, 6 * s);
  if (name == "chest") return turnAbout(y, 5 * c) * turnAbout(x, 5 * s);
  if (name == "neck") return turnAbout(z, 12 * s);
  if (name == "head") return turnAbout(z, 15 * s) * turnAbout(y, 6 * s);
  if (part == "upper_arm") return turnAbout(x, left * 25 * c) * turnAbout(y, -25 * left * s);
  if (part == "lower_arm") return turnAbout(y, -30 * c);
  if (part == "thigh") return turnAbout(y, -20 * left * s - 10 * c) * turnAbout(z, left * 5 * s);
  if (part == "shin") return turnAbout(y, 20 * c);
  if (part == "foot") return turnAbout(y, 5 * s);
  return Eigen::Matrix3d::Identity();
}

// ASCII FBX of three joints in a row, each 10 cm above the last: "a", "b" with a PreRotation of 90
// degrees about x, "c". b turns about its own z from 0 to 90 degrees in 4 frames of 1/30 s.
inline std::string fbxText() {
  std::string models, connections;
  const char* const names[] = {"a", "b", "c"};
  for (int k = 0; k < 3; k++) {
    models += fmt::format(
        "  NodeAttribute: {0}, \"NodeAttribute::{1}\", \"LimbNode\" {{\n    TypeFlags: "
        "\"Skeleton\"\n"
        "  }}\n"
        "  Model: {2}, \"Model::{1}\", \"LimbNode\" {{\n    Version: 232\n    Properties70:  {{\n"
        "      P: \"RotationActive\", \"bool\", \"\", \"\",1\n"
        "      P: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",{3},0,0\n"
        "      P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,{4},0\n    }}\n"
        "    Shading: Y\n    Culling: \"CullingOff\"\n  }}\n",
        20 + k, names[k], 10 + k, k == 1 ? 90 : 0, k == 0 ? 0 : 10);
    connections += fmt::format("  C: \"OO\",{},{}\n  C: \"OO\",{},{}\n", 20 + k, 10 + k, 10 + k,
                               k == 0 ? 0 : 9 + k);
  }
  std::string times, values;
  for (int f = 0; f < 4; f++) {  // FBX counts 46186158000 to the second
    times += fmt::format("{}{}", f ? "," : "", f * 1539538600L);
    values += fmt::format("{}{}", f ? "," : "", 30 * f);
  }
  return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n  FBXHeaderVersion: 1003\n"
         "  FBXVersion: 7400\n}\nGlobalSettings:  {\n  Version: 1000\n  Properties70:  {\n"
         "    P: \"UpAxis\", \"int\", \"Integer\", \"\",1\n"
         "    P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n"
         "    P: \"TimeMode\", \"enum\", \"\", \"\",6\n  }\n}\n"
         "Definitions:  {\n  Version: 100\n  Count: 4\n}\nObjects:  {\n" +
         models +
         "  AnimationStack: 30, \"AnimStack::take\", \"\" {\n    Properties70:  {\n"
         "      P: \"LocalStop\", \"KTime\", \"Time\", \"\",4618615800\n    }\n  }\n"
         "  AnimationLayer: 31, \"AnimLayer::base\", \"\" {\n  }\n"
         "  AnimationCurveNode: 32, \"AnimCurveNode::R\", \"\" {\n    Properties70:  {\n"
         "      P: \"d|X\", \"Number\", \"\", \"A\",0\n      P: \"d|Y\", \"Number\", \"\", "
         "\"A\",0\n"
         "      P: \"d|Z\", \"Number\", \"\", \"A\",0\n    }\n  }\n"
         "  AnimationCurve: 33, \"AnimCurve::\", \"\" {\n    Default: 0\n    KeyVer: 4008\n"
         "    KeyTime: *4 {\n      a: " +
         times + "\n    }\n    KeyValueFloat: *4 {\n      a: " + values +
         "\n    }\n    KeyAttrFlags: *1 {\n      a: 24836\n    }\n    KeyAttrDataFloat: *4 {\n"
         "      a: 0,0,0,0\n    }\n    KeyAttrRefCount: *1 {\n      a: 4\n    }\n  }\n}\n"
         "Connections:  {\n" +
         connections +
         "  C: \"OO\",31,30\n  C: \"OO\",32,31\n  C: \"OP\",32,11, \"Lcl Rotation\"\n"
         "  C: \"OP\",33,32, \"d|Z\"\n}\n";
}

}  // namespace torso::tools
