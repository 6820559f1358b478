// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/person.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "model/body.h"
#include "model/body_warp.h"
#include "model/rotation.h"
#include "model/spine_curve.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr double kDeg = EIGEN_PI / 180;

struct Range {
  double low, high;
  const char* why;
};
constexpr const char* kStanding =
    "which is about what 300 healthy adults standing had, Vialle et al. 2005";
constexpr Range kStature = {1.40, 2.10, "adults; the tables' proportions are no child's"};
constexpr Range kLordosis = {30, 85, kStanding}, kKyphosis = {10, 70, kStanding},
                kSacralSlope = {15, 65, kStanding};
constexpr Range kMassIndex = {16, 40, "beyond, flesh would no longer lie around the bones as here"};

std::string text(double x) {
  std::ostringstream out;
  out.precision(4);
  out << x;
  return out.str();
}

void check(const char* name, double value, const char* unit, const Range& range,
           const std::string& note = "") {
  if (value > range.low - 1e-9 && value < range.high + 1e-9) return;
  throw std::invalid_argument(std::string(name) + " " + text(value) + ": must be from " +
                              text(range.low) + " to " + text(range.high) + " " + unit + note +
                              " (" + range.why + ")");
}

void check(const Anatomy& tables, const Person& person) {
  if (person.stature) check("stature", *person.stature, "m", kStature);
  if (person.stature || person.mass) {
    const double stature = person.stature.value_or(tables.stature());
    const double square = stature * stature;
    check("mass", person.mass.value_or(tables.mass()), "kg",
          {kMassIndex.low * square, kMassIndex.high * square, kMassIndex.why},
          " at a stature of " + text(stature) + " m, a body mass index of 16 to 40");
  }
  if (person.lordosis) check("lordosis", *person.lordosis / kDeg, "degrees", kLordosis);
  if (person.kyphosis) check("kyphosis", *person.kyphosis / kDeg, "degrees", kKyphosis);
  if (person.sacral_slope) {
    check("sacral-slope", *person.sacral_slope / kDeg, "degrees", kSacralSlope);
  }
}

double centreOfMass(const Anatomy& a) {  // x in the standing body [m]
  double moment = 0, mass = 0;
  const auto add = [&](const std::string& body) {
    const Inertial part = bodyInertial(a, body);
    moment += part.mass * part.com.x();
    mass += part.mass;
  };
  add("ribcage");
  for (const Vertebra& v : a.vertebrae) add(v.name);
  for (const Segment& s : a.segments) {
    if (s.name == "pelvis" || s.name == "head") {
      add(s.name);
    } else {
      add("left_" + s.name);
      add("right_" + s.name);
    }
  }
  return moment / mass;
}

// ---- sex ----------------------------------------------------------------------------------------

// Ratios of sex.csv; all 1 for the tables' own sex.
class Ratios {
 public:
  Ratios(const Anatomy& tables, Person::Sex sex)
      : tables_(tables), female_(sex == Person::Sex::kFemale) {}
  const SexDifference& row(const std::string& quantity) const {
    const auto it = tables_.sex_differences.find(quantity);
    if (it == tables_.sex_differences.end()) {
      throw std::runtime_error("anatomy: sex.csv has no row for " + quantity);
    }
    return it->second;
  }
  bool female() const { return female_; }
  double operator()(const std::string& quantity) const {
    return female_ ? row(quantity).ratio() : 1;
  }

 private:
  const Anatomy& tables_;
  bool female_;
};

// Vertebral bodies and discs become slender. What lies behind the bodies keeps its size and its
// distance from their rear wall (spacing of the facets: see sex.csv).
void slender(Anatomy& a, double width, double depth) {
  // Heights at the front and back follow, so that wedges keep their angles.
  const auto deepen = [&](double& anterior, double& posterior) {
    const double change = (depth - 1) * (anterior - posterior) / 2;
    anterior += change;
    posterior -= change;
  };
  const auto shift = [&](const std::string& level) {
    const double d =
        level == "S1" ? 2 * a.discs.front().shape.depth - a.vertebrae.front().lower_endplate_depth
                      : meanDepth(a.vertebra(level));
    return (1 - depth) * d / 2;
  };
  for (ArticularFacet& f : a.facets) f.position.x() += shift(f.level);
  for (CostalJoint& j : a.costal_joints) {
    j.position.x() += shift(j.level);
    if (!j.costotransverse) j.position.y() *= width;
  }
  for (Vertebra* v : levels(a)) v->spinous_tip_distance -= shift(v->name);
  for (Vertebra* v : levels(a)) {
    v->upper_endplate_width *= width;
    v->lower_endplate_width *= width;
    v->upper_endplate_depth *= depth;
    v->lower_endplate_depth *= depth;
    deepen(v->body_height_anterior, v->body_height_posterior);
  }
  for (Disc& d : a.discs) {
    d.shape.width *= width;
    d.shape.depth *= depth;
    deepen(d.shape.height_anterior, d.shape.height_posterior);
  }
}

// Row of sex.csv for a trunk slice or a body.
std::string massRow(const Vertebra& v) {
  if (v.region == Region::kCervical) return "head_mass";
  if (v.region == Region::kThoracic && std::stoi(v.name.substr(1)) <= 8) return "upper_trunk_mass";
  return v.name == "L4" || v.name == "L5" ? "lower_trunk_mass" : "middle_trunk_mass";
}
std::string massRow(const Segment& s) {
  if (s.name == "clavicle" || s.name == "scapula") return "upper_trunk_mass";
  return s.name == "pelvis" ? "lower_trunk_mass" : s.name + "_mass";
}

void redistributeMass(Anatomy& a, const Ratios& ratio) {
  for (Vertebra& v : a.vertebrae) v.slice_mass *= ratio(massRow(v));
  for (Segment& s : a.segments) {
    s.mass *= ratio(massRow(s));
    if (!a.sex_differences.count(s.name + "_com")) continue;
    const SexDifference& com = ratio.row(s.name + "_com");
    s.com += (com.female - com.male) * (a.landmark(s.distal) - a.landmark(s.proximal));
    for (int i = 0; i < 3; i++) {
      s.gyration[i] *= ratio(s.name + "_gyration_" + std::string(1, "xyz"[i]));
    }
  }
}

// ---- everything that goes with the spine --------------------------------------------------------

// Brings what the tables say of a body with the tables' curves to the spine of `a`.
void carry(const Anatomy& tables, const BodyWarp::Growth& growth, Anatomy& a) {
  a.warp = std::make_shared<const BodyWarp>(tables, a, growth);
  const BodyWarp& place = *a.warp;
  const auto carried = [&](const std::string& carrier, const Vector3d& p) -> Vector3d {
    for (std::size_t i = 0; i < a.discs.size(); i++) {
      if (a.discs[i].name == carrier) {
        return p + a.discs[i].frame.translation() - tables.discs[i].frame.translation();
      }
    }
    for (const Vertebra& v : a.vertebrae) {
      if (v.name != carrier) continue;
      const Vertebra& old = tables.vertebra(carrier);
      const double shift = old.spinous_tip_distance - v.spinous_tip_distance;
      return v.frame() * (old.frame().inverse() * p + Vector3d(shift, 0, 0));
    }
    return carrier == "pelvis" || carrier == "ribcage" || carrier == "head"
               ? place(carrier, p)
               : place("left_" + carrier, p);
  };
  for (auto& [name, p] : a.landmarks) {
    p = carried(a.landmark_carriers.at(name), tables.landmark(name));
  }
  for (BallJoint& j : a.joints) j.position = a.landmark(j.landmark);
  for (Segment& s : a.segments) {
    s.com = carried(s.name, s.com);
    const Vector3d along = a.landmark(s.distal) - a.landmark(s.proximal);
    const Vector3d before = tables.landmark(s.distal) - tables.landmark(s.proximal);
    if (before.norm() > 0) {
      s.axes = leastRotation(-Vector3d::UnitZ(), along).toRotationMatrix();
      s.gyration *= along.norm() / before.norm();
    } else if (s.name == "pelvis") {
      s.axes = place.pelvisRotation() * s.axes;
    }
  }
}

double overAnkles(const Anatomy& a) { return centreOfMass(a) - a.landmark("ankle").x(); }

// The sacral slope that brings the centre of mass to `target` in front of the ankles: regula falsi,
// for the one moves almost linearly with the other.
template <typename Body>
Anatomy balanced(const Body& body, double target) {
  double low = kSacralSlope.low * kDeg, high = kSacralSlope.high * kDeg;
  double at_low = overAnkles(body(low)) - target, at_high = overAnkles(body(high)) - target;
  if (!(at_low < 0 && at_high > 0)) {
    throw std::invalid_argument(
        "lordosis and kyphosis: with these curves the body would fall over, whatever the pelvis "
        "does: its sacral slope would be " +
        std::string(at_low < 0 ? "above 65" : "below 15") + " degrees");
  }
  double slope = low;
  for (int i = 0; i < 60; i++) {
    slope = low - at_low * (high - low) / (at_high - at_low);
    const double at = overAnkles(body(slope)) - target;
    if (std::abs(at) < 1e-6) break;
    (at < 0 ? low : high) = slope;
    (at < 0 ? at_low : at_high) = at;
  }
  return body(slope);
}

// ---- stature and mass ---------------------------------------------------------------------------

Anatomy sized(const Anatomy& a, double length, double mass) {
  if (length == 1 && mass == 1) return a;
  Anatomy s = a.scaled(length, mass);
  for (std::size_t i = 0; i < s.discs.size(); i++) s.discs[i].material = a.discs[i].material;
  // Flesh fills mass / length of cross-section.
  const double thicker = std::sqrt(mass / length) / length;
  s.girth_scale *= thicker;
  for (Vertebra& v : s.vertebrae) {
    v.slice_half_width *= thicker;
    v.slice_half_depth *= thicker;
    v.slice_com.x() *= thicker;
  }
  for (Segment& segment : s.segments) {
    if (segment.name == "head" || segment.name == "hand" || segment.name == "foot") continue;
    // Across the segment, x and y hold half the square of z's radius and a share of its length.
    Vector3d& k = segment.gyration;
    const double grown = (thicker * thicker - 1) * k.z() * k.z();
    k = Vector3d(k.x() * k.x() + grown / 2, k.y() * k.y() + grown / 2, k.z() * k.z() + grown)
            .cwiseSqrt();
  }
  return s;
}

}  // namespace

SagittalAlignment sagittalAlignment(const Anatomy& a) {
  SagittalAlignment s;
  s.sacral_slope = a.sacral_slope;
  s.lumbar_lordosis = a.sacral_slope - a.vertebra("L1").upper_endplate_pitch;
  const double t12 = a.vertebra("T12").lower_endplate_pitch;
  s.thoracic_kyphosis = a.vertebra("T4").upper_endplate_pitch - t12;
  s.kyphosis_t1_t12 = a.vertebra("T1").upper_endplate_pitch - t12;
  s.cervical_lordosis = a.vertebra("C7").lower_endplate_pitch - a.c2.lower_endplate_pitch;
  const Vector3d& hip = a.landmark("hip_joint_centre");
  s.pelvic_tilt = std::atan2(hip.x(), -hip.z());
  const double depth = 2 * a.discs.front().shape.depth - a.vertebrae.front().lower_endplate_depth;
  s.c7_offset = a.vertebra("C7").position.x() + depth / 2 * std::cos(a.sacral_slope);
  s.centre_of_mass = overAnkles(a);
  return s;
}

Anatomy personalAnatomy(const Anatomy& tables, const Person& person) {
  if (tables.length_scale != 1 || tables.warp) {
    throw std::invalid_argument("personalAnatomy: needs the tables as they are loaded");
  }
  check(tables, person);
  Anatomy a = tables;
  const Ratios ratio(tables, person.sex);
  BodyWarp::Growth growth;
  if (ratio.female()) {
    slender(a, ratio("endplate_width"), ratio("endplate_depth"));
    redistributeMass(a, ratio);
    growth = {ratio("thorax_width"), ratio("thorax_depth"), ratio("pelvis_width"),
              ratio("ischial_width"), ratio("head_size")};
  }
  const Anatomy uncarried = a;
  if (ratio.female()) carry(tables, growth, a);
  if (person.lordosis || person.kyphosis || person.sacral_slope) {
    const auto body = [&](double sacral_slope) {
      Anatomy b = uncarried;
      bendSpine(b, person, sacral_slope);
      carry(tables, growth, b);
      return b;
    };
    a = person.sacral_slope ? body(*person.sacral_slope) : balanced(body, overAnkles(a));
  }
  a = sized(a, person.stature.value_or(tables.stature()) / a.stature(),
            person.mass.value_or(tables.mass()) / a.mass());
  // To stand, the centre of mass must keep off the ends of the feet.
  const double heel = a.landmark("heel").x(), toe = a.landmark("toe_tip").x();
  const double share = (centreOfMass(a) - heel) / (toe - heel);
  if (!(share > 0.1 && share < 0.7)) {
    throw std::invalid_argument("sacral-slope " + text(a.sacral_slope / kDeg) +
                                ": the body would fall " + (share < 0.5 ? "back" : "for") +
                                "wards over its feet; leave it out to get the one that balances");
  }
  return a;
}

}  // namespace torso
