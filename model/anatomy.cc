// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/anatomy.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "model/csv.h"
#include "model/pitch.h"
#include "model/range_of_motion.h"
#include "model/rotation.h"

namespace torso {
namespace {

const std::vector<std::string> kRegionNames = {"lumbar", "thoracic", "cervical"};
const std::vector<std::string> kDiscQuantityNames = {
    "compression",   "tension",  "anterior_shear", "posterior_shear",
    "lateral_shear", "flexion",  "extension",      "lateral_bending",
    "axial_torsion", "pressure", "loss_factor",    "preload_ratio"};

constexpr double kMm = 1e-3;
constexpr double kDeg = 3.14159265358979323846 / 180;

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

Vertebra readVertebra(const CsvTable& t, int i) {
  const auto mm = [&](const char* column) {
    return t.number(i, std::string(column) + "_mm") * kMm;
  };
  const auto deg = [&](const char* column) {
    return t.number(i, std::string(column) + "_deg") * kDeg;
  };
  Vertebra v;
  v.name = t.text(i, "level");
  const std::string& region = t.text(i, "region");
  v.region = region == "lumbar"     ? Region::kLumbar
             : region == "thoracic" ? Region::kThoracic
                                    : Region::kCervical;
  v.position = {mm("x"), 0, mm("z")};
  v.pitch = deg("pitch");
  v.lower_endplate_pitch = deg("lower_endplate_pitch");
  v.upper_endplate_pitch = deg("upper_endplate_pitch");
  v.upper_endplate_width = mm("upper_endplate_width");
  v.upper_endplate_depth = mm("upper_endplate_depth");
  v.lower_endplate_width = mm("lower_endplate_width");
  v.lower_endplate_depth = mm("lower_endplate_depth");
  v.body_height_anterior = mm("body_height_anterior");
  v.body_height_posterior = mm("body_height_posterior");
  v.canal_width = mm("canal_width");
  v.canal_depth = mm("canal_depth");
  v.pedicle_width = mm("pedicle_width");
  v.pedicle_height = mm("pedicle_height");
  v.pedicle_length = mm("pedicle_length");
  v.pedicle_inclination = deg("pedicle_inclination");
  v.transverse_process_span = mm("transverse_process_span");
  v.spinous_tip_distance = mm("spinous_tip_distance");
  v.spinous_declination = deg("spinous_declination");
  v.slice_mass = t.number(i, "slice_mass_kg");
  v.slice_com = {mm("slice_com_x"), 0, mm("slice_com_z")};
  v.slice_half_width = mm("slice_half_width");
  v.slice_half_depth = mm("slice_half_depth");
  v.mass_fraction = t.number(i, "vertebra_mass_fraction");
  return v;
}

void readMaterial(const CsvTable& t, Disc* disc) {
  const int i = t.find("disc", disc->name);
  DiscMaterial& m = disc->material;
  m.annulus_modulus = t.number(i, "annulus_modulus_mpa") * 1e6;
  m.annulus_poisson = t.number(i, "annulus_poissons_ratio");
  m.fibre_modulus = t.number(i, "fibre_modulus_mpa") * 1e6;
  m.fibre_stiffening = t.number(i, "fibre_stiffening");
  m.fibre_angle = t.number(i, "fibre_angle_deg") * kDeg;
  m.nucleus_modulus = t.number(i, "nucleus_modulus_mpa") * 1e6;
  m.nucleus_bulk_modulus = t.number(i, "nucleus_bulk_modulus_mpa") * 1e6;
  disc->retardation_time = t.number(i, "retardation_time_s");
}

// Outward normal of a left superior facet. It starts as z (a horizontal face looks up), leans back
// by the angle to the transverse plane, and then turns about the vertical: positive towards the
// mid-line, away from the frontal plane.
Vector3d facetNormal(double to_transverse, double from_frontal) {
  const Vector3d back(-std::sin(to_transverse), 0, std::cos(to_transverse));
  return AngleAxisd(from_frontal, Vector3d::UnitZ()) * back;
}

DiscTest readDiscTest(const CsvTable& t, int i) {
  using Quantity = DiscTest::Quantity;
  DiscTest d;
  d.region = static_cast<Region>(t.word(i, "region", kRegionNames));
  d.quantity = static_cast<Quantity>(t.word(i, "quantity", kDiscQuantityNames));
  d.whole_segment = t.word(i, "specimen", {"disc", "fsu"}) == 1;
  d.fit = t.word(i, "fit", {"0", "1"}) == 1;

  double unit;
  if (d.quantity <= Quantity::kLateralShear) {
    t.word(i, "unit", {"N/mm"});
    unit = 1 / kMm;
  } else if (d.quantity <= Quantity::kAxialTorsion) {
    t.word(i, "unit", {"Nm/deg"});
    unit = 1 / kDeg;
  } else if (d.quantity == Quantity::kPressure) {
    t.word(i, "unit", {"MPa"});
    unit = 1e6;
  } else {
    t.word(i, "unit", {"-"});
    unit = 1;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  d.load = t.number(i, "load");
  d.preload = t.number(i, "preload_n");
  d.value = t.number(i, "value") * unit;
  d.low = t.empty(i, "low") ? -kInfinity : t.number(i, "low") * unit;
  d.high = t.empty(i, "high") ? kInfinity : t.number(i, "high") * unit;
  if (d.load < 0 || d.preload < 0) {
    throw std::runtime_error(t.where(i) + ": load and preload_n must not be negative");
  }
  if (!(d.value > 0 && d.low <= d.value && d.value <= d.high)) {
    throw std::runtime_error(t.where(i) + ": value must be positive and from low to high");
  }
  if (d.fit && !(std::isfinite(d.low) && std::isfinite(d.high))) {
    throw std::runtime_error(t.where(i) + ": a row to fit needs low and high");
  }
  d.source = t.text(i, "source");
  d.provenance = t.text(i, "provenance");
  d.note = t.text(i, "note");
  return d;
}

void readMuscles(const std::string& folder, Anatomy* a) {
  const CsvTable sites(folder + "/muscle_sites.csv");
  for (int i = 0; i < sites.rows(); i++) {
    const std::string& name = sites.text(i, "site");
    a->landmarks[name] =
        Vector3d(sites.number(i, "x_mm"), sites.number(i, "y_mm"), sites.number(i, "z_mm")) * kMm;
    a->landmark_carriers[name] = sites.text(i, "body");
    if (sites.word(i, "end", {"0", "1"}) == 1) a->muscle_ends.insert(name);
  }
  const CsvTable muscles(folder + "/muscles.csv");
  for (int i = 0; i < muscles.rows(); i++) {
    Muscle muscle;
    muscle.name = muscles.text(i, "fascicle");
    muscle.group = muscles.text(i, "muscle");
    muscle.section = muscles.number(i, "pcsa_mm2") * kMm * kMm;
    std::istringstream path(muscles.text(i, "path"));
    for (std::string site; path >> site;) muscle.sites.push_back(site);
    if (muscle.section <= 0 || muscle.sites.size() < 2) {
      throw std::runtime_error(muscles.where(i) + ": a section > 0 and two sites are needed");
    }
    a->muscles.push_back(muscle);
  }
}

}  // namespace

const std::string& motionName(Motion motion) {
  static const std::string names[] = {"flexion", "extension", "flexion_extension",
                                      "lateral_bending", "axial_rotation"};
  return names[motion];
}

std::string ligamentPair(const Ligament& ligament) {
  const std::size_t side =
      ligament.side == Side::kMiddle ? std::string::npos : ligament.name.rfind('_');
  return ligament.name.substr(0, side);
}

const std::string& regionName(Region region) { return kRegionNames[static_cast<int>(region)]; }

bool insideRange(const DiscTest& test, double value) {
  constexpr double kMargin = 1e-3;
  return value >= test.low * (1 - kMargin) && value <= test.high * (1 + kMargin);
}

const std::string& discQuantityName(DiscTest::Quantity quantity) {
  return kDiscQuantityNames[static_cast<int>(quantity)];
}

Vector3d mirror(const Vector3d& point) { return {point.x(), -point.y(), point.z()}; }
Vector3d mirrorAxis(const Vector3d& axis) { return {-axis.x(), axis.y(), -axis.z()}; }

Isometry3d Vertebra::frame() const { return pitched(position, pitch); }

Anatomy Anatomy::load(const std::string& folder) {
  Anatomy a;

  const CsvTable vertebrae(folder + "/vertebrae.csv");
  for (int i = 0; i < vertebrae.rows(); i++) a.vertebrae.push_back(readVertebra(vertebrae, i));
  if (a.vertebrae.empty() || a.vertebrae.back().name != "C2") {
    throw std::runtime_error(folder + "/vertebrae.csv: the last row must be C2");
  }
  a.c2 = a.vertebrae.back();
  a.vertebrae.pop_back();

  const CsvTable discs(folder + "/discs.csv"), disc_materials(folder + "/disc_materials.csv");
  for (int i = 0; i < discs.rows(); i++) {
    Disc d;
    d.name = discs.text(i, "disc");
    d.lower = discs.text(i, "lower");
    d.upper = discs.text(i, "upper");
    d.shape = {discs.number(i, "width_mm") * kMm, discs.number(i, "depth_mm") * kMm,
               discs.number(i, "height_anterior_mm") * kMm,
               discs.number(i, "height_posterior_mm") * kMm};
    d.region = a.vertebra(d.upper).region;
    readMaterial(disc_materials, &d);
    d.frame = pitched({discs.number(i, "x_mm") * kMm, 0, discs.number(i, "z_mm") * kMm},
                      discs.number(i, "pitch_deg") * kDeg);
    a.discs.push_back(d);
  }
  if (a.discs.size() != a.vertebrae.size() + 1) {
    throw std::runtime_error(folder + "/discs.csv: " + std::to_string(a.discs.size()) +
                             " discs for " + std::to_string(a.vertebrae.size()) +
                             " free vertebrae; there must be one more");
  }

  const CsvTable landmarks(folder + "/landmarks.csv");
  for (int i = 0; i < landmarks.rows(); i++) {
    a.landmarks[landmarks.text(i, "landmark")] =
        Vector3d(landmarks.number(i, "x_mm"), landmarks.number(i, "y_mm"),
                 landmarks.number(i, "z_mm")) *
        kMm;
    a.landmark_carriers[landmarks.text(i, "landmark")] = landmarks.text(i, "moves_with");
  }
  readMuscles(folder, &a);

  // The S1 endplate is the lower face of disc L5/S1: half the wedge away from its mid-plane.
  const Disc& l5s1 = a.discs.front();
  a.sacral_slope =
      Eigen::AngleAxisd(l5s1.frame.linear()).angle() +
      0.5 * std::atan2(l5s1.shape.height_anterior - l5s1.shape.height_posterior, l5s1.shape.depth);

  const CsvTable facets(folder + "/facets.csv");
  for (int i = 0; i < facets.rows(); i++) {
    ArticularFacet f;
    f.level = facets.text(i, "level");
    f.width = facets.number(i, "width_mm") * kMm;
    f.height = facets.number(i, "height_mm") * kMm;
    f.position = Vector3d(facets.number(i, "x_mm"), facets.number(i, "interfacet_distance_mm") / 2,
                          facets.number(i, "z_mm")) *
                 kMm;
    f.normal = facetNormal(facets.number(i, "angle_to_transverse_deg") * kDeg,
                           facets.number(i, "angle_from_frontal_deg") * kDeg);
    a.facets.push_back(f);
  }

  const CsvTable costal(folder + "/costal_joints.csv");
  for (int i = 0; i < costal.rows(); i++) {
    a.costal_joints.push_back(
        {costal.text(i, "level"), costal.text(i, "joint") == "costotransverse",
         Vector3d(costal.number(i, "x_mm"), costal.number(i, "y_mm"), costal.number(i, "z_mm")) *
             kMm});
  }

  const CsvTable ligaments(folder + "/ligaments.csv");
  for (int i = 0; i < ligaments.rows(); i++) {
    const std::string& side = ligaments.text(i, "side");
    a.ligaments.push_back({ligaments.text(i, "ligament"),
                           ligaments.text(i, "group"),
                           side == "left"    ? Side::kLeft
                           : side == "right" ? Side::kRight
                                             : Side::kMiddle,
                           {}});
  }
  const CsvTable lengths(folder + "/ligament_lengths.csv");
  for (Ligament& ligament : a.ligaments) {
    for (int i = 0; i < lengths.rows(); i++) {
      ligament.max_length_ratio[lengths.text(i, "disc")] =
          lengths.number(i, ligamentPair(ligament));
    }
  }

  const CsvTable segments(folder + "/segments.csv");
  for (int i = 0; i < segments.rows(); i++) {
    Segment s;
    s.name = segments.text(i, "body");
    s.mass = segments.number(i, "mass_kg");
    s.proximal = segments.text(i, "proximal");
    s.distal = segments.text(i, "distal");
    const Vector3d proximal = a.landmark(s.proximal), distal = a.landmark(s.distal);
    s.com = proximal + segments.number(i, "com_fraction") * (distal - proximal) +
            Vector3d(segments.number(i, "offset_x_mm"), segments.number(i, "offset_y_mm"),
                     segments.number(i, "offset_z_mm")) *
                kMm;
    s.gyration = Vector3d(segments.number(i, "gyration_x_mm"), segments.number(i, "gyration_y_mm"),
                          segments.number(i, "gyration_z_mm")) *
                 kMm;
    const Vector3d along = distal - proximal;
    s.axes = along.norm() > 0 ? leastRotation(-Vector3d::UnitZ(), along).toRotationMatrix()
                              : Eigen::Matrix3d::Identity();
    a.segments.push_back(s);
  }

  const CsvTable joints(folder + "/joints.csv");
  for (int i = 0; i < joints.rows(); i++) {
    a.joints.push_back({joints.text(i, "joint"), joints.text(i, "parent"), joints.text(i, "child"),
                        joints.text(i, "landmark"), a.landmark(joints.text(i, "landmark")),
                        joints.number(i, "limit_deg") * kDeg, joints.number(i, "slack_deg") * kDeg,
                        joints.number(i, "stiffness_nm_per_rad"),
                        joints.number(i, "damping_nms_per_rad"),
                        joints.number(i, "armature_kgm2")});
  }

  const CsvTable servos(folder + "/servos.csv");
  for (int i = 0; i < servos.rows(); i++) {
    const bool region = servos.empty(i, "min_deg");
    a.servos.push_back({servos.text(i, "joint"), servos.text(i, "motion"),
                        Vector3d(servos.number(i, "axis_x"), servos.number(i, "axis_y"),
                                 servos.number(i, "axis_z")),
                        region ? 0 : servos.number(i, "min_deg") * kDeg,
                        region ? 0 : servos.number(i, "max_deg") * kDeg,
                        servos.number(i, "kp_nm_per_rad"), servos.number(i, "kv_nms_per_rad"),
                        servos.number(i, "force_limit_nm")});
  }

  a.range_of_motion = readRangeOfMotion(folder + "/range_of_motion.csv");

  const CsvTable disc_tests(folder + "/disc_tests.csv");
  for (int i = 0; i < disc_tests.rows(); i++) {
    a.disc_tests.push_back(readDiscTest(disc_tests, i));
  }

  const CsvTable sex(folder + "/sex.csv");
  for (int i = 0; i < sex.rows(); i++) {
    const SexDifference d{sex.number(i, "male"), sex.number(i, "female")};
    if (!(d.male > 0 && d.female > 0)) {
      throw std::runtime_error(sex.where(i) + ": male and female must be positive");
    }
    a.sex_differences[sex.text(i, "quantity")] = d;
  }
  return a;
}

const Vertebra& Anatomy::vertebra(const std::string& level) const {
  if (level == c2.name) return c2;
  for (const Vertebra& v : vertebrae) {
    if (v.name == level) return v;
  }
  throw std::runtime_error("anatomy: no vertebra is called '" + level + "'");
}

Isometry3d Anatomy::boneFrame(const std::string& level) const {
  return level == "S1" ? pitched(Vector3d::Zero(), sacral_slope) : vertebra(level).frame();
}

const Disc& Anatomy::disc(const std::string& name) const {
  std::string known;
  for (const Disc& disc : discs) {
    if (disc.name == name) return disc;
    known += (known.empty() ? "" : ", ") + disc.name;
  }
  throw std::runtime_error("no disc is called '" + name + "'; there are " + known);
}

const Vector3d& Anatomy::landmark(const std::string& name) const {
  const auto it = landmarks.find(name);
  if (it == landmarks.end()) {
    throw std::runtime_error("anatomy: no landmark is called '" + name + "'");
  }
  return it->second;
}

const Segment& Anatomy::segment(const std::string& name) const {
  for (const Segment& s : segments) {
    if (s.name == name) return s;
  }
  throw std::runtime_error("anatomy: no segment is called '" + name + "'");
}

double Anatomy::stature() const { return landmark("head_vertex").z() - landmark("sole").z(); }

double Anatomy::mass() const {
  double sum = 0;
  for (const Vertebra& v : vertebrae) sum += v.slice_mass;
  for (const Segment& s : segments) {
    sum += s.mass * (s.name == "pelvis" || s.name == "head" ? 1 : 2);
  }
  return sum;
}

Anatomy Anatomy::scaled(double length, double mass) const {
  if (!(length > 0 && mass > 0)) throw std::invalid_argument("anatomy: a scale must be positive");
  Anatomy a = *this;
  a.length_scale *= length;
  a.mass_scale *= mass;
  a.girth_scale *= length;
  const double torque = mass * length * length;
  const auto scaleVertebra = [&](Vertebra& v) {
    for (double* x : {&v.upper_endplate_width, &v.upper_endplate_depth, &v.lower_endplate_width,
                      &v.lower_endplate_depth, &v.body_height_anterior, &v.body_height_posterior,
                      &v.canal_width, &v.canal_depth, &v.pedicle_width, &v.pedicle_height,
                      &v.pedicle_length, &v.transverse_process_span, &v.spinous_tip_distance,
                      &v.slice_half_width, &v.slice_half_depth}) {
      *x *= length;
    }
    v.position *= length;
    v.slice_com *= length;
    v.slice_mass *= mass;
  };
  for (Vertebra& v : a.vertebrae) scaleVertebra(v);
  scaleVertebra(a.c2);
  for (Disc& d : a.discs) {
    for (double* x :
         {&d.shape.width, &d.shape.depth, &d.shape.height_anterior, &d.shape.height_posterior}) {
      *x *= length;
    }
    for (double* modulus : {&d.material.annulus_modulus, &d.material.fibre_modulus,
                            &d.material.nucleus_modulus, &d.material.nucleus_bulk_modulus}) {
      *modulus *= mass / length;
    }
    d.frame.translation() *= length;
  }
  for (ArticularFacet& f : a.facets) {
    f.width *= length;
    f.height *= length;
    f.position *= length;
  }
  for (CostalJoint& j : a.costal_joints) j.position *= length;
  for (auto& [name, position] : a.landmarks) position *= length;
  for (Muscle& muscle : a.muscles) muscle.section *= mass / length;
  for (Segment& s : a.segments) {
    s.mass *= mass;
    s.com *= length;
    s.gyration *= length;
  }
  for (BallJoint& j : a.joints) {
    j.position *= length;
    j.stiffness *= torque;
    j.damping *= torque;
    j.armature *= torque;
  }
  for (Servo& s : a.servos) {
    s.kp *= torque;
    s.kv *= torque;
    s.force_limit *= torque;
  }
  return a;
}

}  // namespace torso
