// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/person.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "model/body.h"
#include "model/body_warp.h"
#include "model/facet.h"
#include "model/ligament.h"
#include "tests/model/people.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

const Anatomy& tables() {
  static const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  return anatomy;
}

std::vector<std::string> bodies(const Anatomy& a) {
  std::vector<std::string> names = {"ribcage"};
  for (const Vertebra& v : a.vertebrae) names.push_back(v.name);
  for (const Segment& s : a.segments) {
    if (s.name == "pelvis" || s.name == "head") {
      names.push_back(s.name);
    } else {
      names.push_back("left_" + s.name);
      names.push_back("right_" + s.name);
    }
  }
  return names;
}

// The faces of a vertebral body and of a disc, from their frames and heights alone, as the meshes
// and the disc solver see them: front and rear rim of the upper (1) or lower (-1) face.
struct Face {
  Vector3d front, back;
  double pitch() const { return std::atan2(back.z() - front.z(), front.x() - back.x()); }
};
Face vertebraFace(const Vertebra& v, int side) {
  const double depth = side > 0 ? v.upper_endplate_depth : v.lower_endplate_depth;
  const double front = v.body_height_anterior, back = v.body_height_posterior;
  const double mean_depth = (v.upper_endplate_depth + v.lower_endplate_depth) / 2;
  const auto z = [&](double x) {
    return side * ((front + back) / 4 + x / mean_depth * (front - back) / 2);
  };
  return {v.frame() * Vector3d(depth / 2, 0, z(depth / 2)),
          v.frame() * Vector3d(-depth / 2, 0, z(-depth / 2))};
}
Face discFace(const Disc& d, int side) {
  return {d.frame * Vector3d(d.shape.depth / 2, 0, side * d.shape.height_anterior / 2),
          d.frame * Vector3d(-d.shape.depth / 2, 0, side * d.shape.height_posterior / 2)};
}

void expectSame(const Vector3d& a, const Vector3d& b, const std::string& what) {
  EXPECT_TRUE(a == b) << what << ": " << a.transpose() << " and " << b.transpose();
}

TEST(Person, NobodyInParticularIsTheTablesBitForBit) {
  const Anatomy& a = tables();
  const Anatomy b = personalAnatomy(a, Person());
  EXPECT_EQ(b.warp, nullptr);
  EXPECT_EQ(b.length_scale, 1);
  EXPECT_EQ(b.girth_scale, 1);
  EXPECT_EQ(b.sacral_slope, a.sacral_slope);
  for (std::size_t i = 0; i < a.discs.size(); i++) {
    EXPECT_TRUE(a.discs[i].frame.matrix() == b.discs[i].frame.matrix());
    EXPECT_EQ(a.discs[i].shape.height_anterior, b.discs[i].shape.height_anterior);
    EXPECT_EQ(a.discs[i].material.annulus_modulus, b.discs[i].material.annulus_modulus);
  }
  for (const auto& [name, place] : a.landmarks) expectSame(place, b.landmark(name), name);
  for (const std::string& body : bodies(a)) {
    const Inertial one = bodyInertial(a, body), two = bodyInertial(b, body);
    EXPECT_EQ(one.mass, two.mass) << body;
    expectSame(one.com, two.com, body);
    EXPECT_TRUE(one.inertia == two.inertia) << body;
  }
  const auto ligaments = makeLigaments(a), my_ligaments = makeLigaments(b);
  for (std::size_t i = 0; i < ligaments.size(); i++) {
    expectSame(ligaments[i].lower_point, my_ligaments[i].lower_point, ligaments[i].name);
    EXPECT_EQ(ligaments[i].max_length, my_ligaments[i].max_length);
  }
}

// The curves that the tables have, asked for by their angles, give the tables' body.
TEST(Person, TheTablesOwnCurvesChangeNothing) {
  const SagittalAlignment now = sagittalAlignment(tables());
  Person p;
  p.lordosis = now.lumbar_lordosis;
  p.kyphosis = now.thoracic_kyphosis;
  const Anatomy a = personalAnatomy(tables(), p);
  EXPECT_NEAR(a.sacral_slope, tables().sacral_slope, 1e-4);
  for (const auto& [name, place] : tables().landmarks) {
    EXPECT_LT((place - a.landmark(name)).norm(), 1e-4) << name;
  }
  for (const std::string& body : bodies(a)) {
    EXPECT_LT((bodyInertial(a, body).com - bodyInertial(tables(), body).com).norm(), 1e-4) << body;
  }
}

TEST(Person, StatureAndMassAreAsAsked) {
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    EXPECT_NEAR(a.stature(), *p.stature, 1e-9);
    double mass = 0;
    for (const std::string& body : bodies(a)) mass += bodyInertial(a, body).mass;
    EXPECT_NEAR(mass, *p.mass, 1e-3 * *p.mass);
  }
}

TEST(Person, CurvesMeasuredOnTheEndplatesAreAsAsked) {
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    const SagittalAlignment default_curves = sagittalAlignment(tables());
    const double s1 = discFace(a.discs.front(), -1).pitch();
    const double lordosis = s1 - vertebraFace(a.vertebra("L1"), 1).pitch();
    const double kyphosis =
        vertebraFace(a.vertebra("T4"), 1).pitch() - vertebraFace(a.vertebra("T12"), -1).pitch();
    EXPECT_NEAR(lordosis, p.lordosis.value_or(default_curves.lumbar_lordosis), 0.5 * kDeg);
    EXPECT_NEAR(kyphosis, p.kyphosis.value_or(default_curves.thoracic_kyphosis), 0.5 * kDeg);
    EXPECT_NEAR(s1, p.sacral_slope.value_or(s1), 0.5 * kDeg);
    // The gaze stays level.
    EXPECT_NEAR(a.c2.pitch, tables().c2.pitch, 1e-9);
    EXPECT_NEAR(sagittalAlignment(a).pelvic_incidence(),
                sagittalAlignment(tables()).pelvic_incidence(), 1e-9);
  }
}

// Discs fill the space between the endplates: each face lies on the face of its bone.
TEST(Person, DiscsFitBetweenTheEndplates) {
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    const auto offset = [](const Face& disc, const Face& bone) {
      const Vector3d middle = (disc.front + disc.back - bone.front - bone.back) / 2;
      return std::pair{middle.norm(), std::abs(disc.pitch() - bone.pitch())};
    };
    for (std::size_t i = 0; i < a.discs.size(); i++) {
      const Disc& d = a.discs[i];
      SCOPED_TRACE(d.name);
      EXPECT_GT(d.shape.height_anterior, 0.001);
      EXPECT_GT(d.shape.height_posterior, 0.001);
      EXPECT_EQ(checkDiscMesh(makeDiscMesh(d.shape)), "");
      const auto [above, above_angle] =
          offset(discFace(d, 1), vertebraFace(i + 1 < a.discs.size() ? a.vertebrae[i] : a.c2, -1));
      EXPECT_LT(above, 1e-4);
      EXPECT_LT(above_angle, 0.3 * kDeg);
      if (i == 0) continue;
      const auto [below, below_angle] =
          offset(discFace(d, -1), vertebraFace(a.vertebrae[i - 1], 1));
      EXPECT_LT(below, 1e-4);
      EXPECT_LT(below_angle, 0.3 * kDeg);
    }
  }
}

TEST(Person, TheBodyIsBalanced) {
  const double target = sagittalAlignment(tables()).centre_of_mass;
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    const SagittalAlignment s = sagittalAlignment(a);
    std::printf("%s: sacral slope %.1f, pelvic tilt %.1f, neck %.1f deg; C7 %.0f mm, CoM %.0f mm\n",
                describe(p).c_str(), s.sacral_slope / kDeg, s.pelvic_tilt / kDeg,
                s.cervical_lordosis / kDeg, 1e3 * s.c7_offset, 1e3 * s.centre_of_mass);
    EXPECT_GT(s.centre_of_mass, a.landmark("heel").x() - a.landmark("ankle").x());
    EXPECT_LT(s.centre_of_mass, a.landmark("toe_tip").x() - a.landmark("ankle").x());
    // Sex and a thicker belly move it by some millimetres, curves do not.
    if (p.sacral_slope) continue;
    EXPECT_NEAR(s.centre_of_mass, target * a.length_scale, 0.02);
  }
}

// The rib cage's joints are where its ribs are, whatever the spine does.
TEST(Person, RibsMeetTheirVertebraeAndTheSternumTheClavicles) {
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    if (!a.warp) continue;
    for (std::size_t i = 0; i < a.costal_joints.size(); i++) {
      const CostalJoint &joint = a.costal_joints[i], &old = tables().costal_joints[i];
      const Vector3d on_rib =
          (*a.warp)("ribcage", tables().boneFrame(old.level) * old.position) * a.length_scale;
      EXPECT_LT((a.boneFrame(joint.level) * joint.position - on_rib).norm(), 1e-9) << joint.level;
    }
    const Vector3d sc = tables().landmark("sternoclavicular_joint_SC");
    EXPECT_LT(((*a.warp)("ribcage", sc) - (*a.warp)("left_clavicle", sc)).norm(), 1e-9);
  }
}

TEST(Person, IsMirrorSymmetric) {
  const Eigen::Matrix3d M = Vector3d(1, -1, 1).asDiagonal();
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    for (const std::string& body : bodies(a)) {
      const Inertial one = bodyInertial(a, body);
      if (splitSide(body).first == Side::kMiddle) {
        EXPECT_NEAR(one.com.y(), 0, 1e-12) << body;
        continue;
      }
      if (splitSide(body).first == Side::kRight) continue;
      const Inertial other = bodyInertial(a, "right_" + splitSide(body).second);
      EXPECT_LT((mirror(one.com) - other.com).norm(), 1e-12) << body;
      EXPECT_LT((M * one.inertia * M - other.inertia).norm(), 1e-12) << body;
    }
    if (!a.warp) continue;
    for (const char* body : {"pelvis", "ribcage", "head"}) {
      for (const auto& [name, place] : tables().landmarks) {
        EXPECT_LT((mirror((*a.warp)(body, place)) - (*a.warp)(body, mirror(place))).norm(), 1e-12);
      }
    }
  }
}

// Facets keep their points on the ellipsoids, and no ligament is taut at rest.
TEST(Person, FacetsAndLigamentsAreAtRest) {
  for (const Person& p : people()) {
    SCOPED_TRACE(describe(p));
    const Anatomy a = personalAnatomy(tables(), p);
    const auto facets = makeFacets(a), default_facets = makeFacets(tables());
    ASSERT_EQ(facets.size(), default_facets.size());
    for (const Facet& f : facets) {
      EXPECT_GT(f.radii.minCoeff(), 0) << f.name;
      for (const Vector3d& point : f.points) {
        const Vector3d q = (f.ellipsoid.inverse() * point).cwiseQuotient(f.radii);
        EXPECT_NEAR(q.norm(), 1, 1e-9) << f.name;
      }
    }
    const auto ligaments = makeLigaments(a), default_ligaments = makeLigaments(tables());
    for (std::size_t i = 0; i < ligaments.size(); i++) {
      const double length = (ligaments[i].upper_point - ligaments[i].lower_point).norm();
      EXPECT_LT(length, ligaments[i].max_length) << ligaments[i].name;
      EXPECT_GT(length, 0.0005) << ligaments[i].name;
    }
  }
}

TEST(Person, WomenHaveNarrowerBodiesAndChestsAndWiderHips) {
  const Anatomy woman = personalAnatomy(tables(), person(Person::Sex::kFemale, 1.7, 72));
  EXPECT_NEAR(woman.vertebra("L3").upper_endplate_width,
              0.93 * woman.length_scale * tables().vertebra("L3").upper_endplate_width, 1e-9);
  EXPECT_LT(woman.landmark("rib_cage_max_breadth_point").y(),
            0.96 * tables().landmark("rib_cage_max_breadth_point").y());
  EXPECT_LT(woman.landmark("acromioclavicular_joint_AC").y(),
            0.96 * tables().landmark("acromioclavicular_joint_AC").y());
  EXPECT_GT(woman.landmark("hip_joint_centre").y(),
            1.04 * tables().landmark("hip_joint_centre").y());
  // de Leva 1996: two thighs hold 29.6 % of a woman, 28.3 % of a man.
  EXPECT_NEAR(2 * bodyInertial(woman, "left_thigh").mass / 72, 0.2956, 0.003);
  EXPECT_NEAR(2 * bodyInertial(tables(), "left_thigh").mass / tables().mass(), 0.2832, 0.003);
}

// The same discs in a body of the same stature that is heavier; thicker limbs turn harder.
TEST(Person, AHeavierBodyHasTheSameBonesAndDiscs) {
  const Anatomy light = personalAnatomy(tables(), person(Person::Sex::kMale, 1.8, 60));
  const Anatomy heavy = personalAnatomy(tables(), person(Person::Sex::kMale, 1.8, 110));
  for (std::size_t i = 0; i < light.discs.size(); i++) {
    EXPECT_EQ(light.discs[i].shape.width, heavy.discs[i].shape.width);
    EXPECT_EQ(light.discs[i].material.annulus_modulus, heavy.discs[i].material.annulus_modulus);
    EXPECT_EQ(light.discs[i].material.annulus_modulus, tables().discs[i].material.annulus_modulus);
  }
  for (const auto& [name, place] : light.landmarks) {
    EXPECT_LT((place - heavy.landmark(name)).norm(), 1e-12) << name;
  }
  const auto about = [](const Anatomy& a, int axis) {
    const Inertial thigh = bodyInertial(a, "left_thigh");
    return thigh.inertia(axis, axis) / thigh.mass;
  };
  EXPECT_NEAR(about(heavy, 2) / about(light, 2), 110.0 / 60, 0.05);
  EXPECT_LT(about(heavy, 0) / about(light, 0), 1.2);
  EXPECT_GT(about(heavy, 0) / about(light, 0), 1.02);
}

TEST(Person, RefusesWhomTheTablesCannotBeStretchedTo) {
  const auto message = [](const Person& p) -> std::string {
    try {
      personalAnatomy(tables(), p);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  Person p;
  p.stature = 3;
  EXPECT_THAT(message(p), HasSubstr("stature 3: must be from 1.4 to 2.1 m (adults"));
  p.stature = std::nan("");
  EXPECT_THAT(message(p), HasSubstr("stature nan: must be"));
  p.stature = 1.8;
  p.mass = 200;
  EXPECT_THAT(message(p),
              HasSubstr("mass 200: must be from 51.84 to 129.6 kg at a stature of 1.8"));
  p.mass.reset();
  p.lordosis = 5 * kDeg;
  EXPECT_THAT(message(p), HasSubstr("lordosis 5: must be from 30 to 85 degrees"));
  p.lordosis.reset();
  p.kyphosis = 120 * kDeg;
  EXPECT_THAT(message(p), HasSubstr("kyphosis 120: must be from 10 to 70 degrees"));
  p.kyphosis.reset();
  p.sacral_slope = 2 * kDeg;
  EXPECT_THAT(message(p), HasSubstr("sacral-slope 2: must be from 15 to 65 degrees"));
  p.sacral_slope = 18 * kDeg;
  EXPECT_THAT(message(p), HasSubstr("sacral-slope 18: the body would fall backwards"));
  p.sacral_slope.reset();
  p.lordosis = 31 * kDeg;
  p.kyphosis = 69 * kDeg;
  EXPECT_THAT(message(p), HasSubstr("no error"));
}

TEST(Person, AGivenAnatomyMustBeTheTables) {
  const Anatomy tall = personalAnatomy(tables(), person(Person::Sex::kMale, 2, 80));
  EXPECT_THROW(personalAnatomy(tall, Person()), std::invalid_argument);
}

}  // namespace
}  // namespace torso
