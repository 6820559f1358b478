// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Bones of the limbs and the pelvis against osteometry, and against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "model/anatomy.h"
#include "model/bone_mesh.h"
#include "model/mesh_checks.h"
#include "model/tri_mesh.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr double kMm = 1e-3;

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

// The bones of a body, one by one.
const std::vector<TriMesh>& bones(const std::string& body) {
  static std::map<std::string, std::vector<TriMesh>> cache;
  const auto it = cache.find(body);
  if (it != cache.end()) return it->second;
  for (const BonePart& part : boneMesh(anatomy(), body)) {
    if (part.tissue == Tissue::kBone) cache[body] = connectedParts(part.mesh);
  }
  return cache[body];
}

// The longest bone of a body but `rank` others.
const TriMesh& bone(const std::string& body, int rank = 0) {
  std::vector<const TriMesh*> sorted;
  for (const TriMesh& b : bones(body)) sorted.push_back(&b);
  const auto length = [](const TriMesh* b) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : b->vertices) box.extend(v);
    return box.diagonal().norm();
  };
  std::sort(sorted.begin(), sorted.end(),
            [&](const TriMesh* a, const TriMesh* b) { return length(a) > length(b); });
  return *sorted.at(rank);
}

// Largest distance of two points [m], as between the plates of an osteometric board.
double maximumLength(const TriMesh& mesh) {
  double most = 0;
  for (const Vector3d& a : mesh.vertices) {
    for (const Vector3d& b : mesh.vertices) most = std::max(most, (a - b).squaredNorm());
  }
  return std::sqrt(most);
}

// Least signed distance of a's vertices to b [m], negative if one lies inside.
double clearance(const TriMesh& a, const TriMesh& b) {
  const MeshTree tree(b);
  double least = 1;
  for (const Vector3d& v : a.vertices) least = std::min(least, tree.signedDistance(v));
  return least;
}

// Left hip bone: the highest bone of the pelvis on that side.
const TriMesh& hipBone() {
  const TriMesh* found = nullptr;
  for (const TriMesh& b : bones("pelvis")) {
    const Vector3d mean =
        Eigen::Map<const Eigen::Matrix3Xd>(b.vertices[0].data(), 3, b.vertices.size())
            .rowwise()
            .mean();
    if (mean.y() > 40 * kMm) found = &b;
  }
  return *found;
}

// Trotter and Gleser 1952, Am J Phys Anthropol 10:463-514: maximum lengths of a man of 170 cm.
TEST(LimbBones, LengthsAreThoseOfTheStature) {
  const struct {
    const char* body;
    int rank;
    double length;
  } rows[] = {{"left_thigh", 0, 456 * kMm},     {"left_shin", 0, 363 * kMm},
              {"left_shin", 1, 366 * kMm},      {"left_upper_arm", 0, 323 * kMm},
              {"left_lower_arm", 0, 259 * kMm}, {"left_lower_arm", 1, 241 * kMm}};
  for (const auto& row : rows) {
    const double length = maximumLength(bone(row.body, row.rank));
    EXPECT_NEAR(length, row.length, 0.05 * row.length) << row.body << row.rank;
  }
}

TEST(LimbBones, GrowWithTheBody) {
  const std::vector<BonePart> tall = boneMesh(anatomy().scaled(1.1, 1.2), "left_upper_arm");
  const std::vector<BonePart> table = boneMesh(anatomy(), "left_upper_arm");
  EXPECT_NEAR(maximumLength(tall[0].mesh), 1.1 * maximumLength(table[0].mesh), 1e-6);
}

TEST(LimbBones, AllBonesAreThere) {
  const std::map<std::string, size_t> counts = {
      {"left_upper_arm", 1},
      {"left_lower_arm", 2},
      {"left_hand", 8 + 5 + 14 + 2},  // carpals, metacarpals, phalanges, sesamoids of the thumb
      {"left_thigh", 1},
      {"left_shin", 3},
      {"left_foot", 7 + 5 + 14 + 2}};
  for (const auto& [body, count] : counts) EXPECT_EQ(bones(body).size(), count) << body;
}

TEST(LimbBones, KeepWithinTheirBudgetOfTriangles) {
  const std::map<std::string, size_t> budgets = {
      {"pelvis", 10000},    {"left_upper_arm", 2000}, {"left_lower_arm", 2500}, {"left_hand", 5000},
      {"left_thigh", 2500}, {"left_shin", 3000},      {"left_foot", 5000}};
  for (const auto& [body, budget] : budgets) {
    size_t faces = 0;
    for (const TriMesh& b : bones(body)) faces += b.faces.size();
    EXPECT_LE(faces, budget) << body;
  }
}

TEST(LimbBones, NeighboursDoNotTouch) {
  const std::pair<const char*, const char*> pairs[] = {
      {"pelvis", "left_thigh"},        {"left_thigh", "left_shin"},
      {"left_shin", "left_foot"},      {"left_upper_arm", "left_lower_arm"},
      {"left_lower_arm", "left_hand"}, {"left_scapula", "left_upper_arm"}};
  for (const auto& [a, b] : pairs) {
    for (const TriMesh& one : bones(a)) {
      for (const TriMesh& other : bones(b)) {
        EXPECT_GT(clearance(one, other), 0) << a << " in " << b;
        EXPECT_GT(clearance(other, one), 0) << b << " in " << a;
      }
    }
  }
  for (const char* body : {"pelvis", "left_lower_arm", "left_hand", "left_shin", "left_foot"}) {
    for (const TriMesh& one : bones(body)) {
      for (const TriMesh& other : bones(body)) {
        if (&one == &other) continue;
        EXPECT_GT(clearance(one, other), 0) << body;
      }
    }
  }
}

// Cartilage on both sides of a joint is 2 to 7 mm thick in all.
TEST(LimbBones, JointsHaveRoomForCartilage) {
  const double plateau = clearance(bone("left_thigh"), bone("left_shin"));
  EXPECT_GT(plateau, 1.5 * kMm);
  EXPECT_LT(plateau, 7 * kMm);
  const double patella = clearance(bone("left_shin", 2), bone("left_thigh"));
  EXPECT_GT(patella, 2 * kMm);
  EXPECT_LT(patella, 5 * kMm);
  const double hip = clearance(bone("left_thigh"), hipBone());
  EXPECT_GT(hip, 1 * kMm);
  EXPECT_LT(hip, 4 * kMm);
}

// The face is about 15 cm^2 in men; the sacrum's is not modelled apart from its side.
TEST(HipBones, MeetTheSacrumAlongTheAuricularFace) {
  double area = 0;
  for (const TriMesh& other : bones("pelvis")) {
    if (&other == &hipBone()) continue;
    const MeshTree sacrum(other);
    const auto& v = hipBone().vertices;
    for (const auto& f : hipBone().faces) {
      const Vector3d middle = (v[f[0]] + v[f[1]] + v[f[2]]) / 3;
      if (sacrum.signedDistance(middle) > 2.5 * kMm) continue;
      area += (v[f[1]] - v[f[0]]).cross(v[f[2]] - v[f[0]]).norm() / 2;
    }
  }
  EXPECT_GT(area, 9e-4);
  EXPECT_LT(area, 22e-4);
}

TEST(HipBones, HaveABreadthOfTheIliaAsPublished) {
  double most = 0;
  for (const Vector3d& v : hipBone().vertices) most = std::max(most, v.y());
  EXPECT_NEAR(2 * most, 280 * kMm, 0.05 * 280 * kMm);
}

// A line through the foramen, from in front and outside to behind and inside, hits no bone.
TEST(HipBones, ObturatorForamenIsOpen) {
  const Vector3d centre = anatomy().landmark("hip_joint_centre") + Vector3d(8, -44, -36) * kMm;
  const Vector3d through = Vector3d(0.5, 0.6, -0.2).normalized();
  const MeshTree hip(hipBone());
  for (double t = -30; t <= 30; t += 1) {
    EXPECT_GT(hip.signedDistance(centre + t * kMm * through), 7 * kMm) << t;
  }
}

TEST(HipBones, AcetabulumIsACrescent) {
  const Vector3d centre = anatomy().landmark("hip_joint_centre");
  const MeshTree hip(hipBone());
  // Around the head of the femur: bone above, in front and behind, none at the notch below.
  EXPECT_NEAR(hip.signedDistance(centre + Vector3d(0, -8, 24).normalized() * 23 * kMm), 2.5 * kMm,
              1 * kMm);
  EXPECT_NEAR(hip.signedDistance(centre + Vector3d(20, -10, 0).normalized() * 23 * kMm), 2.5 * kMm,
              1 * kMm);
  EXPECT_NEAR(hip.signedDistance(centre + Vector3d(-20, -5, 0).normalized() * 23 * kMm), 2.5 * kMm,
              1 * kMm);
  EXPECT_GT(hip.signedDistance(centre + Vector3d(0, -6, -22).normalized() * 26 * kMm), 4 * kMm);
}

}  // namespace
}  // namespace torso
