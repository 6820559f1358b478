// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_registration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "model/mesh_section.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// About n points, each for the same share of the surface.
std::vector<Vector3d> evenPoints(const TriMesh& mesh, int n) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  const std::vector<SurfacePoint> dense = surfacePoints(mesh, box.diagonal().norm() / 60);
  double total = 0, sum = 0;
  for (const auto& p : dense) total += p.area;
  std::vector<Vector3d> out;
  for (const auto& p : dense) {
    sum += p.area;
    while (sum >= total * (static_cast<double>(out.size()) + 0.5) / n) out.push_back(p.position);
  }
  return out;
}

struct Cloud {
  explicit Cloud(std::vector<Vector3d> p) : points(std::move(p)) {
    for (const Vector3d& x : points) centre += x / static_cast<double>(points.size());
    for (const Vector3d& x : points) size += (x - centre).squaredNorm();
    size = std::sqrt(size / static_cast<double>(points.size()));
  }
  std::vector<Vector3d> points;
  Vector3d centre = Vector3d::Zero();
  double size = 0;  // root mean square distance from the centre
};

const Vector3d& nearest(const std::vector<Vector3d>& set, const Vector3d& p, double* distance) {
  const Vector3d& q = set[nearestIndex(set, p)];
  *distance = (q - p).norm();
  return q;
}

Registration iterate(const Cloud& mesh, const Cloud& reference, const Matrix3d& start) {
  Registration r;
  r.rotation = start;
  r.scale = reference.size / mesh.size;
  r.translation = reference.centre - r.scale * start * mesh.centre;
  constexpr int kIterations = 40;
  for (int iteration = 0;; iteration++) {
    struct Pair {
      Vector3d from, to;
      double distance;
    };
    std::vector<Pair> pairs;
    double sum = 0;
    // Both ways: from the mesh to the reference, and back.
    for (const Vector3d& p : mesh.points) {
      double d;
      const Vector3d& q = nearest(reference.points, r.scale * r.rotation * p + r.translation, &d);
      pairs.push_back({p, q, d});
      sum += d;
    }
    for (std::size_t i = 0; i < reference.points.size(); i += 2) {
      const Vector3d& q = reference.points[i];
      double d;
      const Vector3d& p =
          nearest(mesh.points, r.rotation.transpose() * (q - r.translation) / r.scale, &d);
      pairs.push_back({p, q, d * r.scale});
      sum += d * r.scale;
    }
    r.misfit = sum / static_cast<double>(pairs.size()) / reference.size;
    if (iteration == kIterations) return r;
    std::sort(pairs.begin(), pairs.end(),
              [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
    pairs.resize(pairs.size() * 9 / 10);
    Eigen::Matrix3Xd from(3, pairs.size()), to(3, pairs.size());
    for (std::size_t i = 0; i < pairs.size(); i++) {
      from.col(i) = pairs[i].from;
      to.col(i) = pairs[i].to;
    }
    const Eigen::Matrix4d T = Eigen::umeyama(from, to, true);
    r.scale = T.col(0).head<3>().norm();
    r.rotation = T.topLeftCorner<3, 3>() / r.scale;
    r.translation = T.topRightCorner<3, 1>();
  }
}

// Landmarks that a body carries; the first of the line hangs it on its parent.
struct Carried {
  const char *joint, *anchor;
  std::vector<const char*> landmarks;
};
const std::map<std::string, Carried>& carriedBy() {
  static const std::map<std::string, Carried> kCarried = {
      {"pelvis", {"", "S1_endplate_centre", {"hip_joint_centre"}}},
      {"thigh", {"hip", "hip_joint_centre", {"knee"}}},
      {"shin", {"knee", "knee", {"ankle"}}},
      {"foot", {"ankle", "ankle", {"heel", "toe_tip", "sole"}}},
      {"ribcage",
       {"",
        "",
        {"sternoclavicular_joint_SC", "suprasternal_notch_IJ", "xiphoid_PX",
         "rib_cage_max_breadth_point"}}},
      {"clavicle",
       {"sternoclavicular", "sternoclavicular_joint_SC", {"acromioclavicular_joint_AC"}}},
      {"scapula",
       {"acromioclavicular",
        "acromioclavicular_joint_AC",
        {"glenohumeral_centre_GH", "acromion_angle_AA", "scapula_root_of_spine_TS",
         "scapula_inferior_angle_AI"}}},
      {"upper_arm", {"glenohumeral", "glenohumeral_centre_GH", {"elbow"}}},
      {"lower_arm", {"elbow", "elbow", {"wrist"}}},
      {"hand", {"wrist", "wrist", {"hand_tip"}}},
      {"head", {"head", "head_pivot", {"head_vertex", "external_auditory_meatus"}}}};
  return kCarried;
}

const Carried& carried(const std::string& body) {
  const auto it = carriedBy().find(body);
  if (it == carriedBy().end()) throw std::invalid_argument("no body is called '" + body + "'");
  return it->second;
}

// Moves a body as a whole, with all that hangs on it: x -> to + ratio * (x - from).
void move(const std::string& body, const Vector3d& from, const Vector3d& to, double ratio,
          Anatomy* a) {
  const auto moved = [&](const Vector3d& p) -> Vector3d { return to + ratio * (p - from); };
  for (Segment& s : a->segments) {
    if (s.name != body) continue;
    s.com = moved(s.com);
    s.gyration *= ratio;
  }
  for (const char* name : carried(body).landmarks) {
    Vector3d& p = a->landmarks.at(name);
    const Vector3d old = p;
    p = moved(p);
    for (const auto& [child, c] : carriedBy()) {
      if (std::string(c.anchor) != name) continue;
      for (BallJoint& joint : a->joints) {
        if (joint.name == c.joint) joint.position = p;
      }
      move(child, old, p, 1, a);
    }
  }
}

}  // namespace

std::vector<Matrix3d> axisTurns() {
  std::vector<Matrix3d> out;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      if (i == j) continue;
      for (double si : {1.0, -1.0}) {
        for (double sj : {1.0, -1.0}) {
          Matrix3d R = Matrix3d::Zero();
          R(0, i) = si;
          R(1, j) = sj;
          R.row(2) = R.row(0).cross(R.row(1));
          out.push_back(R);
        }
      }
    }
  }
  return out;
}

Registration registerBone(const TriMesh& mesh, const TriMesh& reference,
                          const std::vector<Matrix3d>& starts) {
  const Cloud from(evenPoints(mesh, 300)), to(evenPoints(reference, 500));
  Registration best;
  best.misfit = std::numeric_limits<double>::infinity();
  for (const Matrix3d& start : starts) {
    const Registration r = iterate(from, to, start);
    if (r.misfit < best.misfit) best = r;
  }
  const Cloud fine_from(evenPoints(mesh, 800)), fine_to(evenPoints(reference, 1500));
  return iterate(fine_from, fine_to, best.rotation);
}

Vector3d bodyAnchor(const Anatomy& anatomy, const std::string& body) {
  if (body != "ribcage") return anatomy.landmark(carried(body).anchor);
  // The middle of the joints that hold the cage to the spine.
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const CostalJoint& joint : anatomy.costal_joints) {
    if (joint.costotransverse) continue;
    const Vector3d p = anatomy.boneFrame(joint.level) * joint.position;
    sum += Vector3d(p.x(), 0, p.z());
    count++;
  }
  return sum / std::max(1, count);
}

void resizeBody(const std::string& body, double ratio, Anatomy* anatomy) {
  const Vector3d anchor = bodyAnchor(*anatomy, body);
  move(body, anchor, anchor, ratio, anatomy);
}

}  // namespace torso
