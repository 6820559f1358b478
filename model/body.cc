// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/body.h"

namespace torso {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Elliptic cylinder with its axis along z.
Matrix3d ellipticCylinder(double mass, double half_depth, double half_width, double height) {
  const double a = half_depth * half_depth / 4, b = half_width * half_width / 4,
               h = height * height / 12;
  return mass * Vector3d(b + h, a + h, a + b).asDiagonal().toDenseMatrix();
}

double sliceHeight(const Vertebra& v) {
  // Body and one disc; 1.25 is the mean ratio of their sum to the body alone.
  return 1.25 * (v.body_height_anterior + v.body_height_posterior) / 2;
}

Matrix3d pointInertia(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

// What the slice of one vertebra leaves to the rib cage. The vertebra's own share sits at its
// body's centre (bone and the muscles behind it), so the rest is further forward than the slice.
Inertial ribcageShare(const Anatomy& a, const Vertebra& v) {
  // Of the thorax, vertebrae.csv.
  const double half_width = 0.140 * a.girth_scale, half_depth = 0.100 * a.girth_scale;
  Inertial share;
  share.mass = v.slice_mass * (1 - v.mass_fraction);
  share.com = v.frame() * (v.slice_com / (1 - v.mass_fraction));
  const Matrix3d R = v.frame().linear();
  share.inertia =
      R * ellipticCylinder(share.mass, half_depth, half_width, sliceHeight(v)) * R.transpose();
  return share;
}

Inertial ribcageInertial(const Anatomy& a) {
  Inertial sum;
  for (const Vertebra& v : a.vertebrae) {
    if (v.mass_fraction >= 1) continue;
    const Inertial share = ribcageShare(a, v);
    sum.com = (sum.mass * sum.com + share.mass * share.com) / (sum.mass + share.mass);
    sum.mass += share.mass;
  }
  for (const Vertebra& v : a.vertebrae) {
    if (v.mass_fraction >= 1) continue;
    const Inertial share = ribcageShare(a, v);
    sum.inertia += share.inertia + pointInertia(share.mass, share.com - sum.com);
  }
  return sum;
}

Inertial vertebraInertial(const Vertebra& v) {
  Inertial out;
  out.mass = v.slice_mass * v.mass_fraction;
  out.com = v.frame() * (v.mass_fraction < 1 ? Vector3d::Zero() : v.slice_com);
  const Matrix3d R = v.frame().linear();
  out.inertia = R *
                ellipticCylinder(out.mass, v.slice_half_depth, v.slice_half_width, sliceHeight(v)) *
                R.transpose();
  return out;
}

bool isVertebra(const Anatomy& a, const std::string& body) {
  for (const Vertebra& v : a.vertebrae) {
    if (v.name == body) return true;
  }
  return false;
}

}  // namespace

std::pair<Side, std::string> splitSide(const std::string& body) {
  if (body.rfind("left_", 0) == 0) return {Side::kLeft, body.substr(5)};
  if (body.rfind("right_", 0) == 0) return {Side::kRight, body.substr(6)};
  return {Side::kMiddle, body};
}

std::string pairedName(const Anatomy& anatomy, Side side, const std::string& name) {
  if (side == Side::kMiddle || name == "pelvis" || name == "ribcage" || name == "head" ||
      isVertebra(anatomy, name)) {
    return name;
  }
  return (side == Side::kLeft ? "left_" : "right_") + name;
}

std::string bodyOfLevel(const Anatomy& anatomy, const std::string& level) {
  if (level == "S1") return "pelvis";
  return level == anatomy.c2.name ? "head" : level;
}

Isometry3d bodyFrame(const Anatomy& a, const std::string& body) {
  if (isVertebra(a, body)) return a.vertebra(body).frame();
  Isometry3d X = Isometry3d::Identity();
  if (body == "pelvis") return X;
  if (body == "ribcage") {
    X.translation() = a.landmark("suprasternal_notch_IJ");
    return X;
  }
  const auto [side, name] = splitSide(body);
  for (const BallJoint& joint : a.joints) {
    if (joint.child != name) continue;
    X.translation() = side == Side::kRight ? mirror(joint.position) : joint.position;
    return X;
  }
  throw std::runtime_error("anatomy: no body is called '" + body + "'");
}

Inertial bodyInertial(const Anatomy& a, const std::string& body) {
  if (isVertebra(a, body)) return vertebraInertial(a.vertebra(body));
  if (body == "ribcage") return ribcageInertial(a);
  const auto [side, name] = splitSide(body);
  const Segment& s = a.segment(name);
  Inertial out;
  out.mass = s.mass;
  out.com = s.com;
  const Vector3d k2 = s.gyration.cwiseAbs2();
  out.inertia = s.axes * (s.mass * k2).asDiagonal() * s.axes.transpose();
  if (side == Side::kRight) {
    const Matrix3d M = Vector3d(1, -1, 1).asDiagonal();
    out.com = mirror(out.com);
    out.inertia = M * out.inertia * M;
  }
  return out;
}

}  // namespace torso
