// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Bones of people of other sizes and curves than the tables'.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "model/body_warp.h"
#include "model/bone_mesh.h"
#include "model/skeleton.h"
#include "tests/model/mesh_inside.h"
#include "tests/model/people.h"

namespace torso {
namespace {

using Eigen::Vector3d;

const Anatomy& tables() {
  static const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  return anatomy;
}

// Bones are carried, not mangled: no edge of their surfaces is stretched or squeezed much, in the
// people above nor in the most bent and the straightest back, and none is turned inside out.
TEST(PersonBones, BonesKeepTheirShape) {
  std::vector<Person> all = people();
  Person bent, straight;
  bent.kyphosis = 65 * kDeg;
  straight.kyphosis = 20 * kDeg;
  for (Person* p : {&bent, &straight}) {
    p->stature = 1.7;
    p->mass = 72;
    all.push_back(*p);
  }
  for (const char* body : {"ribcage", "pelvis", "head"}) {
    std::vector<TriMesh> meshes;
    for (const BonePart& part : boneMesh(tables(), body)) meshes.push_back(part.mesh);
    for (const Person& p : all) {
      const Anatomy a = personalAnatomy(tables(), p);
      if (!a.warp) continue;
      const auto carried = [&](const Vector3d& q) { return (*a.warp)(body, q); };
      std::vector<double> stretch;
      double least_volume = 1;
      for (const TriMesh& mesh : meshes) {
        for (std::size_t i = 0; i < mesh.faces.size(); i += 7) {
          const Vector3d &u = mesh.vertices[mesh.faces[i][0]], &v = mesh.vertices[mesh.faces[i][1]];
          if ((u - v).norm() < 5e-4) continue;
          stretch.push_back((carried(u) - carried(v)).norm() / (u - v).norm());
          Eigen::Matrix3d J;
          for (int k = 0; k < 3; k++) {
            const Vector3d d = 1e-6 * Vector3d::Unit(k);
            J.col(k) = (carried(u + d) - carried(u - d)) / 2e-6;
          }
          least_volume = std::min(least_volume, J.determinant());
        }
      }
      std::sort(stretch.begin(), stretch.end());
      const auto share = [&](double s) { return stretch[std::size_t(s * (stretch.size() - 1))]; };
      std::printf("%s, %s: edges %.2f (1 %%) to %.2f (99 %%), extremes %.2f and %.2f\n",
                  describe(p).c_str(), body, share(0.01), share(0.99), share(0), share(1));
      EXPECT_GT(least_volume, 0.4) << describe(p) << ", " << body;
      EXPECT_GT(share(0.01), 0.8) << describe(p) << ", " << body;
      EXPECT_LT(share(0.99), 1.35) << describe(p) << ", " << body;
      EXPECT_LT(share(1), 1.9) << describe(p) << ", " << body;
    }
  }
}

// Neighbours do not reach into each other deeper than the tables' bones may (bone_mesh_test).
TEST(PersonBones, NeighboursKeepApart) {
  constexpr double kDepth = 1.5e-3;
  // Others are in bone_fit_test.
  for (const Person& p : {withCurves(person(Person::Sex::kMale, 1.60, 90), 75, 60)}) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    std::vector<std::string> chain, made = {"ribcage", "left_scapula"};
    for (const Vertebra& v : a.vertebrae) chain.push_back(v.name);
    chain.push_back("head");
    made.insert(made.end(), chain.begin(), chain.end());
    const Skeleton bones(a, made, 2);
    // In a lordosis of 75 deg lumbar spinous processes may touch (Baastrup's kissing spine).
    const int most = p.lordosis && *p.lordosis > 1.2 ? 2 : 0;
    const auto expectApart = [&](const std::string& one, const std::string& two, double depth) {
      EXPECT_LE(pointsInside(bones.bone(one), bones.bone(two), depth), most)
          << one << " in " << two;
      EXPECT_LE(pointsInside(bones.bone(two), bones.bone(one), depth), most)
          << two << " in " << one;
    };
    for (std::size_t i = 1; i < chain.size(); i++) {
      expectApart(chain[i - 1], chain[i], kDepth * a.length_scale);
    }
    for (const Vertebra& v : a.vertebrae) {
      if (v.region == Region::kThoracic) expectApart("ribcage", v.name, kDepth * a.length_scale);
    }
    expectApart("ribcage", "left_scapula", 0);
  }
}

// A body that is only taller has the tables' bones, enlarged.
TEST(PersonBones, StatureScalesThem) {
  const Anatomy tall = personalAnatomy(tables(), person(Person::Sex::kMale, 1.87, 90));
  const auto box = [](const Anatomy& a, const char* body) {
    Eigen::AlignedBox3d b;
    for (const BonePart& part : boneMesh(a, body)) {
      for (const Vector3d& v : part.mesh.vertices) b.extend(v);
    }
    return b;
  };
  for (const char* body : {"L4", "left_scapula", "right_clavicle", "ribcage"}) {
    const Eigen::AlignedBox3d small = box(tables(), body), large = box(tall, body);
    EXPECT_LT((1.1 * small.min() - large.min()).norm(), 3e-4) << body;
    EXPECT_LT((1.1 * small.max() - large.max()).norm(), 3e-4) << body;
  }
}

}  // namespace
}  // namespace torso
