// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>

#include "model/anatomy.h"
#include "model/loft.h"
#include "model/mesh_repair.h"
#include "model/mesh_section.h"
#include "tests/model/mesh_inside.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kMm = 1e-3;

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_FOLDER);
  return a;
}

std::vector<std::string> bodies() {
  std::vector<std::string> names = {"pelvis", "ribcage", "head"};
  for (const Vertebra& v : anatomy().vertebrae) names.push_back(v.name);
  for (const std::string side : {"left_", "right_"}) {
    for (const char* limb :
         {"clavicle", "scapula", "upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      names.push_back(side + limb);
    }
  }
  return names;
}

const std::vector<BonePart>& parts(const std::string& body) {
  static std::map<std::string, std::vector<BonePart>> cache;
  const auto it = cache.find(body);
  if (it != cache.end()) return it->second;
  // To save time, only one pair is made on both sides.
  if (body.rfind("right_", 0) != 0 || body == "right_clavicle") {
    return cache[body] = boneMesh(anatomy(), body);
  }
  std::vector<BonePart> pair = parts("left_" + body.substr(6));
  for (BonePart& part : pair) part.mesh = mirrored(part.mesh);
  return cache[body] = pair;
}

// Bone of a body, without cartilage.
const TriMesh& bone(const std::string& body) {
  for (const BonePart& p : parts(body)) {
    if (p.tissue == Tissue::kBone) return p.mesh;
  }
  throw std::runtime_error(body + " has no bone");
}

const MeshTree& tree(const std::string& body) {
  static std::map<std::string, MeshTree> cache;
  const auto it = cache.find(body);
  return it != cache.end() ? it->second : cache.emplace(body, MeshTree(bone(body))).first->second;
}

double signedVolume(const TriMesh& mesh, const std::vector<int>& faces) {
  double v = 0;
  for (int i : faces) {
    const auto& f = mesh.faces[i];
    v += mesh.vertices[f[0]].dot(mesh.vertices[f[1]].cross(mesh.vertices[f[2]])) / 6;
  }
  return v;
}

// Faces of each connected shell.
std::vector<std::vector<int>> shells(const TriMesh& mesh) {
  std::vector<int> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0);
  const std::function<int(int)> find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const auto& f : mesh.faces) {
    root[find(f[0])] = find(f[1]);
    root[find(f[1])] = find(f[2]);
  }
  std::map<int, std::vector<int>> by_root;
  for (size_t i = 0; i < mesh.faces.size(); i++) {
    by_root[find(mesh.faces[i][0])].push_back(static_cast<int>(i));
  }
  std::vector<std::vector<int>> out;
  for (auto& [r, faces] : by_root) out.push_back(std::move(faces));
  return out;
}

double distanceToVertices(const TriMesh& mesh, const Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector3d& v : mesh.vertices) nearest = std::min(nearest, (v - point).norm());
  return nearest;
}

Isometry3d endplateFrame(const Vertebra& v, bool upper) {
  const double height = (v.body_height_anterior + v.body_height_posterior) / 2;
  Isometry3d X = v.frame() * Eigen::Translation3d(0, 0, (upper ? 0.5 : -0.5) * height);
  X.linear() =
      AngleAxisd(upper ? v.upper_endplate_pitch : v.lower_endplate_pitch, Vector3d::UnitY())
          .toRotationMatrix();
  return X;
}

TEST(BoneMesh, ShellsAreClosedAndLookOutwards) {
  for (const std::string& body : bodies()) {
    for (const BonePart& part : parts(body)) {
      std::set<std::pair<int, int>> edges;
      for (const auto& f : part.mesh.faces) {
        for (int k = 0; k < 3; k++) {
          EXPECT_TRUE(edges.insert({f[k], f[(k + 1) % 3]}).second) << body << ": edge twice";
        }
      }
      for (const auto& [a, b] : edges) {
        ASSERT_TRUE(edges.count({b, a})) << body << ": open edge";
      }
      for (const auto& shell : shells(part.mesh)) {
        EXPECT_GT(signedVolume(part.mesh, shell), 1e-9) << body;
      }
    }
  }
}

TEST(BoneMesh, NoFaceIsDegenerate) {
  for (const std::string& body : bodies()) {
    for (const BonePart& part : parts(body)) {
      const auto& v = part.mesh.vertices;
      for (const Vector3d& p : v) ASSERT_TRUE(p.allFinite()) << body;
      for (const auto& f : part.mesh.faces) {
        EXPECT_GT((v[f[1]] - v[f[0]]).cross(v[f[2]] - v[f[0]]).norm() / 2, 1e-10)
            << body << " at " << v[f[0]].transpose();
      }
    }
  }
}

TEST(BoneMesh, RightIsTheMirrorImageOfLeft) {
  for (const std::string& body : bodies()) {
    if (body.rfind("left_", 0) == 0) {
      const TriMesh &l = bone(body), &r = bone("right_" + body.substr(5));
      ASSERT_EQ(l.vertices.size(), r.vertices.size());
      for (size_t i = 0; i < l.vertices.size(); i++) {
        EXPECT_EQ(mirror(l.vertices[i]), r.vertices[i]);
      }
    } else if (body.rfind("right_", 0) != 0) {
      const Eigen::AlignedBox3d b = bounds(bone(body));
      EXPECT_NEAR(b.min().y(), -b.max().y(), 0.1 * kMm) << body;
    }
  }
}

TEST(BoneMesh, IsLight) {
  size_t total = 0;
  for (const std::string& body : bodies()) {
    for (const BonePart& part : parts(body)) total += part.mesh.faces.size();
  }
  for (const Vertebra& v : anatomy().vertebrae) EXPECT_LE(bone(v.name).faces.size(), 3000u);
  EXPECT_LE(bone("ribcage").faces.size(), 16000u);
  EXPECT_LE(bone("head").faces.size(), 18000u);
  EXPECT_LE(total, 150000u);
}

TEST(BoneMesh, TissuesAreThoseOfTheParts) {
  for (const std::string& body : bodies()) {
    std::vector<Tissue> tissues;
    for (const BonePart& part : parts(body)) tissues.push_back(part.tissue);
    EXPECT_EQ(boneTissues(anatomy(), body), tissues) << body;
  }
}

TEST(BoneMesh, UnknownNameIsRefused) {
  for (const char* name : {"", "L6", "C2", "clavicle", "left_", "left_tail", "middle_hand"}) {
    EXPECT_THROW(boneMesh(anatomy(), name), std::invalid_argument) << name;
    EXPECT_THROW(boneTissues(anatomy(), name), std::invalid_argument) << name;
  }
}

TEST(BoneMesh, EndplatesHaveTheTablesWidthAndDepth) {
  for (const Vertebra& v : anatomy().vertebrae) {
    for (bool upper : {true, false}) {
      const double width = upper ? v.upper_endplate_width : v.lower_endplate_width;
      const double depth = upper ? v.upper_endplate_depth : v.lower_endplate_depth;
      const Isometry3d into = endplateFrame(v, upper).inverse();
      // The outline 1.5 mm inside the endplate, where its edge is no longer rounded, and below the
      // neck's uncinate processes.
      const double level = (upper ? -1.5 : 1.5) * kMm;
      Eigen::AlignedBox3d for_width, for_depth;
      for (const auto& f : bone(v.name).faces) {
        for (int k = 0; k < 3; k++) {
          const Vector3d a = into * bone(v.name).vertices[f[k]];
          const Vector3d b = into * bone(v.name).vertices[f[(k + 1) % 3]];
          if ((a.z() < level) == (b.z() < level)) continue;
          const Vector3d q = a + (level - a.z()) / (b.z() - a.z()) * (b - a);
          // Not the arch.
          if (q.x() > -0.3 * depth && std::abs(q.y()) < 0.65 * width) for_width.extend(q);
          if (q.x() > -0.6 * depth && std::abs(q.y()) < 0.15 * width) for_depth.extend(q);
        }
      }
      // The roots of the neck's uncinate and transverse processes broaden the body a little.
      const double within = (v.region == Region::kCervical ? 1.1 : 0.6) * kMm;
      EXPECT_NEAR(for_width.sizes().y(), width, within) << v.name << upper;
      EXPECT_NEAR(for_depth.sizes().x(), depth, 0.8 * kMm) << v.name << upper;
    }
  }
}

TEST(BoneMesh, BodiesHaveTheTablesHeights) {
  for (const Vertebra& v : anatomy().vertebrae) {
    const double depth = (v.upper_endplate_depth + v.lower_endplate_depth) / 2;
    const Isometry3d X = v.frame();
    // The body's height at the rim, from its inside.
    const auto height = [&](double sign) {
      double most = 0;
      for (double in = 1; in <= 3.5; in += 0.25) {
        const Vector3d p = X * Vector3d(sign * (depth / 2 - in * kMm), 0.7 * kMm, 0);
        const Vector3d z = X.linear().col(2);
        most = std::max(most, rayLength(bone(v.name), p, z) + rayLength(bone(v.name), p, -z));
      }
      return most;
    };
    EXPECT_NEAR(height(1), v.body_height_anterior, 0.6 * kMm) << v.name;
    EXPECT_NEAR(height(-1), v.body_height_posterior, 0.6 * kMm) << v.name;
  }
}

TEST(BoneMesh, DiscsFitBetweenTheEndplates) {
  for (const Disc& d : anatomy().discs) {
    const TriMesh& above = bone(d.upper == "C2" ? "head" : d.upper);
    const TriMesh& below = bone(d.lower == "S1" ? "pelvis" : d.lower);
    const Vector3d up = d.frame.linear().col(2);
    for (double x : {-0.3, 0.0, 0.25}) {
      for (double y : {-0.25, 0.0, 0.25}) {
        const double height = d.shape.height_posterior +
                              (d.shape.height_anterior - d.shape.height_posterior) * (x + 0.5);
        const Vector3d p = d.frame * Vector3d(x * d.shape.depth, y * d.shape.width + 0.7 * kMm, 0);
        // The endplates are hollow by less than half a millimetre.
        EXPECT_NEAR(rayLength(above, p, up), height / 2, 0.5 * kMm) << d.name;
        EXPECT_NEAR(rayLength(below, p, -up), height / 2, 0.5 * kMm) << d.name;
      }
    }
  }
}

TEST(BoneMesh, ProcessesReachTheTablesTips) {
  for (const Vertebra& v : anatomy().vertebrae) {
    const Isometry3d into = v.frame().inverse();
    const Vector3d towards(-std::cos(v.spinous_declination), 0, -std::sin(v.spinous_declination));
    double span = 0, reach = 0;
    Vector3d tip = Vector3d::Zero();
    for (const Vector3d& p : bone(v.name).vertices) {
      const Vector3d q = into * p;
      span = std::max(span, 2 * std::abs(q.y()));
      if (q.dot(towards) > reach) {
        reach = q.dot(towards);
        tip = q;
      }
    }
    EXPECT_NEAR(span, v.transverse_process_span, 0.5 * kMm) << v.name;
    EXPECT_NEAR(reach, v.spinous_tip_distance, 0.5 * kMm) << v.name;
    EXPECT_LT((tip - reach * towards).norm(), 10 * kMm) << v.name;  // a corner of the process
  }
}

TEST(BoneMesh, FacetFacesLieWhereTheTableSays) {
  for (const ArticularFacet& f : anatomy().facets) {
    size_t above = 0;  // the bone above
    while (f.level != "S1" && anatomy().vertebrae[above].name != f.level) above++;
    if (f.level != "S1") above++;
    const bool last = above == anatomy().vertebrae.size();
    const TriMesh& superior = bone(f.level == "S1" ? "pelvis" : f.level);
    const TriMesh& inferior = bone(last ? "head" : anatomy().vertebrae[above].name);
    const Isometry3d X = anatomy().boneFrame(f.level);
    for (double side : {1.0, -1.0}) {
      const auto sided = [&](const Vector3d& p) { return side > 0 ? p : mirror(p); };
      const Vector3d p = sided(X * f.position), n = sided(X.linear() * f.normal);
      EXPECT_NEAR(rayLength(superior, p + 1 * kMm * n, -n), 1 * kMm, 0.3 * kMm) << f.level;
      // The table's S1 facet lies so high that its counterpart is in L5's pedicle.
      if (f.level == "S1") continue;
      EXPECT_NEAR(rayLength(inferior, p, n), 2 * kMm, 0.3 * kMm) << f.level;
    }
  }
}

TEST(BoneMesh, VertebralCanalIsOpen) {
  for (const Vertebra& v : anatomy().vertebrae) {
    const Isometry3d X = v.frame();
    const double back = (v.upper_endplate_depth + v.lower_endplate_depth) / 4;
    const double length = 0.5 * v.body_height_posterior;
    for (int k = 0; k < 12; k++) {  // room for the cord; the facets narrow the corners
      const double a = 2 * M_PI * (k + 0.3) / 12;
      const Vector3d p = X * Vector3d(-back - v.canal_depth * (0.45 + 0.25 * std::cos(a)),
                                      0.25 * v.canal_width * std::sin(a), 0);
      for (double side : {1.0, -1.0}) {
        EXPECT_GT(rayLength(bone(v.name), p, side * X.linear().col(2)), length) << v.name << k;
      }
    }
  }
}

// Euler's formula counts the holes of a surface: the vertebral canal, and in the neck the two
// foramina of the vertebral arteries.
TEST(BoneMesh, VertebraeHaveTheirHolesAndNoOthers) {
  for (const Vertebra& v : anatomy().vertebrae) {
    const TriMesh& mesh = bone(v.name);
    ASSERT_EQ(shells(mesh).size(), 1u) << v.name;
    const int vertices = static_cast<int>(mesh.vertices.size());
    const int faces = static_cast<int>(mesh.faces.size());
    const int holes = (2 - (vertices - faces / 2)) / 2;
    EXPECT_EQ(holes, v.region == Region::kCervical ? 3 : 1) << v.name;
  }
}

// Neither has a point more than `under` below the other's surface.
void expectApart(const std::string& a, const std::string& b, double under = 0) {
  EXPECT_EQ(pointsInside(tree(a), tree(b), under), 0) << a << " in " << b;
  EXPECT_EQ(pointsInside(tree(b), tree(a), under), 0) << b << " in " << a;
}

TEST(BoneMesh, NeighbouringVertebraeKeepApart) {
  std::vector<std::string> chain;
  for (const Vertebra& v : anatomy().vertebrae) chain.push_back(v.name);
  chain.push_back("head");
  for (size_t i = 1; i < chain.size(); i++) expectApart(chain[i - 1], chain[i]);
}

TEST(BoneMesh, RibCageLeavesTheVertebraeFree) {
  for (const Vertebra& v : anatomy().vertebrae) {
    if (v.region == Region::kThoracic) expectApart("ribcage", v.name, 1.5 * kMm);
  }
}

TEST(BoneMesh, RibCageHasTheLandmarksBreadth) {
  const double breadth = anatomy().landmark("rib_cage_max_breadth_point").y();
  EXPECT_NEAR(bounds(bone("ribcage")).max().y(), breadth, 3 * kMm);
}

TEST(BoneMesh, ScapulaGlidesOnTheRibs) {
  const TriMesh &scapula = bone("left_scapula"), &ribs = bone("ribcage");
  expectApart("left_scapula", "ribcage");
  double nearest = 1;
  for (const Vector3d& v : scapula.vertices) {
    nearest = std::min(nearest, distanceToVertices(ribs, v));
  }
  EXPECT_GT(nearest, 7 * kMm);   // muscles in between
  EXPECT_LT(nearest, 15 * kMm);  // and it does not stand off
}

TEST(BoneMesh, StatureIsTheTables) {
  const double top = bounds(bone("head")).max().z(), sole = bounds(bone("left_foot")).min().z();
  EXPECT_NEAR(top - sole, anatomy().stature(), 5 * kMm);
}

TEST(BoneMesh, BonesMeetTheirLandmarks) {
  const struct {
    const char *body, *landmark;
    double within;  // [m]; joint centres lie inside a ball or between two bones
  } rows[] = {{"left_clavicle", "sternoclavicular_joint_SC", 12 * kMm},
              {"left_clavicle", "acromioclavicular_joint_AC", 12 * kMm},
              {"left_scapula", "acromioclavicular_joint_AC", 15 * kMm},
              {"left_scapula", "acromion_angle_AA", 12 * kMm},
              {"left_scapula", "scapula_root_of_spine_TS", 8 * kMm},
              {"left_scapula", "scapula_inferior_angle_AI", 8 * kMm},
              {"left_scapula", "glenohumeral_centre_GH", 28 * kMm},
              {"left_upper_arm", "glenohumeral_centre_GH", 26 * kMm},
              {"left_upper_arm", "elbow", 14 * kMm},
              {"left_lower_arm", "elbow", 20 * kMm},
              {"left_lower_arm", "wrist", 12 * kMm},
              {"left_hand", "wrist", 12 * kMm},
              {"left_hand", "hand_tip", 4 * kMm},
              {"pelvis", "hip_joint_centre", 27 * kMm},
              {"left_thigh", "hip_joint_centre", 25 * kMm},
              {"left_thigh", "knee", 24 * kMm},
              {"left_shin", "knee", 30 * kMm},
              {"left_shin", "ankle", 30 * kMm},
              {"left_foot", "ankle", 20 * kMm},
              {"left_foot", "heel", 8 * kMm},
              {"left_foot", "toe_tip", 12 * kMm},
              {"ribcage", "suprasternal_notch_IJ", 8 * kMm},
              {"ribcage", "xiphoid_PX", 5 * kMm},
              {"head", "head_vertex", 8 * kMm}};
  for (const auto& row : rows) {
    EXPECT_LT(distanceToVertices(bone(row.body), anatomy().landmark(row.landmark)), row.within)
        << row.body << " " << row.landmark;
  }
}

TEST(BoneMesh, BallsFitTheirSockets) {
  const struct {
    const char *ball, *socket;
  } rows[] = {{"left_thigh", "pelvis"}, {"left_upper_arm", "left_scapula"}};
  for (const auto& row : rows) expectApart(row.ball, row.socket);
}

}  // namespace
}  // namespace torso
