// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/bone_measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "model/body.h"
#include "model/csv.h"
#include "model/loft.h"
#include "model/mesh_repair.h"
#include "model/tri_mesh.h"
#include "model/vertebra_measure.h"

namespace torso {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// The largest distance between two of its vertices.
double greatestLength(const TriMesh& mesh) {
  double most = 0;
  for (const Vector3d& p : mesh.vertices) {
    for (const Vector3d& q : mesh.vertices) most = std::max(most, (p - q).squaredNorm());
  }
  return std::sqrt(most);
}

// The connected parts, largest first.
std::vector<TriMesh> partsBySize(const TriMesh& mesh) {
  std::vector<TriMesh> parts = connectedParts(mesh);
  std::sort(parts.begin(), parts.end(),
            [](const TriMesh& a, const TriMesh& b) { return volume(a) > volume(b); });
  return parts;
}

class Measurer {
 public:
  Measurer(const Anatomy& anatomy, const Skeleton& skeleton) : a_(anatomy), s_(skeleton) {}

  std::vector<BoneMeasure> run() {
    for (const Vertebra& v : a_.vertebrae) {
      if (s_.has(v.name)) vertebra(v.name);
    }
    if (s_.has("pelvis")) pelvis();
    if (s_.has("ribcage")) ribCage();
    if (s_.has("head")) skull();
    if (s_.has("left_clavicle")) {
      clavicle();
    }
    if (s_.has("left_scapula")) scapula();
    longBones();
    return std::move(out_);
  }

 private:
  void add(const std::string& bone, const std::string& quantity, double value) {
    if (std::isfinite(value)) out_.push_back({bone, quantity, value});
  }

  void superiorFacet(const std::string& level, const MeshTree& bone) {
    for (const ArticularFacet& facet : a_.facets) {
      if (facet.level != level) continue;
      const auto face =
          findFace(bone, facet.position, facet.normal, Vector3d::UnitZ(), a_.length_scale);
      if (!face) continue;
      const Vector3d n = face->normal;
      add(level, "superior_facet_width", face->width);
      add(level, "superior_facet_height", face->height);
      add(level, "superior_facet_area", face->area);
      add(level, "superior_facet_transverse_angle", std::acos(n.z()));
      add(level, "superior_facet_frontal_angle", std::atan2(-n.y(), -n.x()));
    }
  }

  void vertebra(const std::string& name) {
    const MeshTree bone(transformed(s_.bone(name).mesh(), bodyFrame(a_, name).inverse()));
    const VertebraShape shape(bone, a_.length_scale);
    for (bool upper : {true, false}) {
      const std::string endplate = upper ? "upper_endplate" : "lower_endplate";
      add(name, endplate + "_width", shape.endplate(upper).width);
      add(name, endplate + "_depth", shape.endplate(upper).depth);
    }
    add(name, "body_height_anterior", shape.height(true));
    add(name, "body_height_posterior", shape.height(false));
    add(name, "canal_depth", shape.canalDepth());
    if (shape.pedicle()) {
      add(name, "canal_width", 2 * shape.pedicle()->medial);
      add(name, "pedicle_width", shape.pedicle()->width);
      add(name, "pedicle_height", shape.pedicle()->height);
    }
    add(name, "transverse_process_span", shape.transverseSpan());
    add(name, "spinous_tip_distance", shape.spinousTipDistance());
    superiorFacet(name, bone);
    add(name, "volume", volume(bone.mesh()));
    add(name, "body_volume", shape.bodyVolume());
  }

  void pelvis() {
    const TriMesh& mesh = s_.bone("pelvis").mesh();
    const Isometry3d frame = a_.boneFrame("S1");
    superiorFacet("S1", MeshTree(transformed(mesh, frame.inverse())));
    add("pelvis", "bi_iliac_breadth", bounds(mesh).sizes().y());
    // The anterior superior iliac spines: what lies foremost above the hip joints.
    const double above = a_.landmark("hip_joint_centre").z() + 0.04 * a_.length_scale;
    Vector3d spine(-INFINITY, 0, 0);
    for (const Vector3d& p : mesh.vertices) {
      if (p.z() > above && p.y() > 0 && p.x() > spine.x()) spine = p;
    }
    add("pelvis", "interspinous_distance", 2 * spine.y());
    for (const TriMesh& part : connectedParts(mesh)) {
      const AlignedBox3d box = bounds(part);
      if (box.min().y() > 0 || box.max().y() < 0) continue;
      // The sacrum, with or without the coccyx; not a small loose part of the mid-line.
      if (box.sizes().y() < 0.05 * a_.length_scale) continue;
      add("sacrum", "width", box.sizes().y());
      add("sacrum", "volume", volume(part));
    }
  }

  void ribCage() {
    const AlignedBox3d box = bounds(s_.bone("ribcage").mesh());
    add("rib_cage", "width", box.sizes().y());
    add("rib_cage", "depth", box.sizes().x());
    add("rib_cage", "height", box.sizes().z());
  }

  void skull() {
    const TriMesh cranium = partsBySize(s_.bone("head").mesh()).front();
    const AlignedBox3d box = bounds(cranium);
    // The vault, without the face.
    AlignedBox3d vault;
    for (const Vector3d& p : cranium.vertices) {
      if (p.z() > box.max().z() - 0.095 * a_.length_scale) vault.extend(p);
    }
    add("skull", "length", vault.sizes().x());
    add("skull", "breadth", vault.sizes().y());
  }

  void clavicle() {
    const TriMesh& mesh = s_.bone("left_clavicle").mesh();
    const double length = greatestLength(mesh), slab = 0.006 * a_.length_scale;
    add("clavicle", "length", length);
    add("clavicle", "volume", volume(mesh));
    const auto inner = [](const Vector3d& p, const Vector3d& q) { return p.y() < q.y(); };
    const auto [medial, lateral] =
        std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(), inner);
    const Vector3d along = (*lateral - *medial).normalized();
    const Vector3d front = along.cross(Vector3d::UnitZ()).normalized();
    double breadth = 0;
    for (double from = 0; from < 0.2 * length; from += slab / 2) {
      double low = INFINITY, high = -INFINITY;
      for (const Vector3d& p : mesh.vertices) {
        const double at = (p - *medial).dot(along);
        if (at < from || at > from + slab) continue;
        low = std::min(low, p.dot(front));
        high = std::max(high, p.dot(front));
      }
      breadth = std::max(breadth, high - low);
    }
    add("clavicle", "medial_breadth", breadth);
  }

  void scapula() {
    const TriMesh& mesh = s_.bone("left_scapula").mesh();
    // Height: between the superior and the inferior angle. Breadth: from the medial border to the
    // rim of the glenoid, across the height.
    const Vector3d *top = nullptr, *bottom = nullptr;
    const double medial = bounds(mesh).min().y() + 0.35 * bounds(mesh).sizes().y();
    for (const Vector3d& p : mesh.vertices) {
      if (p.y() > medial) continue;  // not the acromion and the coracoid process
      if (!top || p.z() > top->z()) top = &p;
      if (!bottom || p.z() < bottom->z()) bottom = &p;
    }
    if (top) add("scapula", "height", (*top - *bottom).norm());
    add("scapula", "volume", volume(mesh));
  }

  void longBones() {
    const auto whole = [&](const char* body, const char* bone) {
      if (!s_.has(body)) return;
      add(bone, "length", greatestLength(partsBySize(s_.bone(body).mesh()).front()));
    };
    whole("left_upper_arm", "humerus");
    whole("left_thigh", "femur");
    if (s_.has("left_lower_arm")) {
      std::vector<TriMesh> parts = partsBySize(s_.bone("left_lower_arm").mesh());
      if (parts.size() >= 2) {
        // The olecranon reaches above the radius' head.
        if (bounds(parts[0]).max().z() < bounds(parts[1]).max().z()) std::swap(parts[0], parts[1]);
        add("ulna", "length", greatestLength(parts[0]));
        add("radius", "length", greatestLength(parts[1]));
      }
    }
    if (s_.has("left_shin")) {
      const std::vector<TriMesh> parts = partsBySize(s_.bone("left_shin").mesh());
      add("tibia", "length", greatestLength(parts[0]));
      for (const TriMesh& part : parts) {  // the slender one at the side
        if (&part != &parts[0] && greatestLength(part) > 0.6 * greatestLength(parts[0])) {
          add("fibula", "length", greatestLength(part));
        }
      }
    }
  }

  const Anatomy& a_;
  const Skeleton& s_;
  std::vector<BoneMeasure> out_;
};

constexpr double kDeg = 3.14159265358979323846 / 180;

}  // namespace

std::vector<BoneMeasure> measureBones(const Anatomy& anatomy, const Skeleton& skeleton) {
  return Measurer(anatomy, skeleton).run();
}

std::string bodyOfBone(const std::string& bone) {
  static const std::map<std::string, std::string> kBodies = {{"S1", "pelvis"},
                                                             {"sacrum", "pelvis"},
                                                             {"pelvis", "pelvis"},
                                                             {"rib_cage", "ribcage"},
                                                             {"skull", "head"},
                                                             {"clavicle", "left_clavicle"},
                                                             {"scapula", "left_scapula"},
                                                             {"humerus", "left_upper_arm"},
                                                             {"radius", "left_lower_arm"},
                                                             {"ulna", "left_lower_arm"},
                                                             {"femur", "left_thigh"},
                                                             {"tibia", "left_shin"},
                                                             {"fibula", "left_shin"}};
  const auto it = kBodies.find(bone);
  return it == kBodies.end() ? bone : it->second;
}

double measureUnit(const std::string& unit) {
  if (unit == "mm") return 1e-3;
  if (unit == "mm2") return 1e-6;
  if (unit == "cm3") return 1e-6;
  if (unit == "deg") return kDeg;
  throw std::invalid_argument("bone measures: no unit is called '" + unit + "'");
}

std::vector<PublishedMeasure> loadPublishedMeasures(const std::string& folder) {
  const CsvTable table(folder + "/bone_measures.csv");
  std::vector<PublishedMeasure> rows;
  for (int i = 0; i < table.rows(); i++) {
    const std::vector<std::string> units = {"mm", "mm2", "cm3", "deg"};
    PublishedMeasure row;
    row.bone = table.text(i, "bone");
    row.quantity = table.text(i, "quantity");
    row.unit = units[table.word(i, "unit", units)];
    const double unit = measureUnit(row.unit);
    row.mean = table.number(i, "mean") * unit;
    row.sd = table.empty(i, "sd") ? -1 : table.number(i, "sd") * unit;
    if (!table.empty(i, "sd") && row.sd <= 0) {
      throw std::runtime_error(table.where(i) + ": sd must be positive, or empty if not known");
    }
    row.source = table.text(i, "source");
    row.provenance = table.text(i, "provenance");
    row.note = table.text(i, "note");
    rows.push_back(row);
  }
  return rows;
}

PublishedMeasure scaled(const PublishedMeasure& row, double length_scale) {
  const int power = row.unit == "mm" ? 1 : row.unit == "mm2" ? 2 : row.unit == "cm3" ? 3 : 0;
  PublishedMeasure out = row;
  out.mean *= std::pow(length_scale, power);
  if (out.sd > 0) out.sd *= std::pow(length_scale, power);
  return out;
}

double tolerance(const PublishedMeasure& row) {
  return row.sd > 0 ? row.sd : 0.05 * std::abs(row.mean);
}

}  // namespace torso
