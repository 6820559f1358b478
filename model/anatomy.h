// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The one source of truth about the body: the tables of model/anatomy/, read into SI units.
//
// Axes, here and everywhere in the project: x forward, y left, z up. (ISB's thorax axes X forward,
// Y up, Z right, turned by +90 degrees about X.) Positions are in the standing body, with the
// origin at the centre of the S1 upper endplate, unless a comment names another frame. Angles in
// radians; a pitch is a rotation about y, positive leaning forward.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "model/disc.h"

namespace torso {

// Left, middle or right of the body; the value is the sign of y.
enum class Side { kRight = -1, kMiddle = 0, kLeft = 1 };

enum class Region { kLumbar, kThoracic, kCervical };
constexpr Region kRegions[] = {Region::kLumbar, Region::kThoracic, Region::kCervical};
const std::string& regionName(Region region);  // "lumbar" ...

struct Vertebra {
  std::string name;  // "L5" .. "C3"
  Region region;
  Eigen::Vector3d position;                           // body centre [m]
  double pitch;                                       // of the vertebra frame [rad]
  double lower_endplate_pitch, upper_endplate_pitch;  // [rad], of the standing body, not relative
  // Morphometry [m], [rad].
  double upper_endplate_width, upper_endplate_depth, lower_endplate_width, lower_endplate_depth;
  double body_height_anterior, body_height_posterior;
  double canal_width, canal_depth;
  double pedicle_width, pedicle_height, pedicle_length, pedicle_inclination;
  double transverse_process_span;  // tip to tip
  double spinous_tip_distance;     // body centre to tip
  double spinous_declination;      // below the vertebra's horizontal plane
  // Trunk slice (tissue and bone) at this level.
  double slice_mass;          // [kg]
  Eigen::Vector3d slice_com;  // [m], vertebra frame
  double slice_half_width, slice_half_depth;
  double mass_fraction;  // share of the slice that moves with the vertebra, not with the rib cage

  // Vertebra frame in the standing body: origin at the body centre, z along the body's axis.
  Eigen::Isometry3d frame() const;
};

struct Disc {
  std::string name;          // "L5/S1" .. "C2/C3"
  std::string lower, upper;  // names of the bones' levels: "S1", "L5" .. "C2"
  DiscShape shape;
  Region region;  // of the upper bone
  DiscMaterial material;
  double retardation_time;  // viscous over elastic stiffness [s]
  Eigen::Isometry3d frame;  // of the disc at rest, in the standing body
};

// Superior articular facet of a bone (left side).
struct ArticularFacet {
  std::string level;         // bone that carries it: "S1" .. "C4"
  double width, height;      // [m]
  Eigen::Vector3d position;  // centre, in the frame of the bone [m], y > 0
  Eigen::Vector3d normal;    // out of the face, in the frame of the bone, unit
};

struct CostalJoint {
  std::string level;         // "T1" .. "T12"
  bool costotransverse;      // else costovertebral
  Eigen::Vector3d position;  // left side, vertebra frame [m]
};

struct Ligament {
  std::string name, group;
  Side side;
  std::map<std::string, double> max_length_ratio;  // by disc: l_max over the length at rest
};

struct Segment {  // a body that is not a vertebra; left side of a pair
  std::string name;
  std::string proximal, distal;  // landmarks
  double mass;
  Eigen::Vector3d com;       // standing body [m]
  Eigen::Vector3d gyration;  // radii of gyration [m] along the axes of `axes`
  Eigen::Matrix3d axes;      // columns: principal axes in the standing body, z along the segment
};

struct BallJoint {  // left side of a pair
  std::string name, parent, child, landmark;
  Eigen::Vector3d position;  // [m], of the landmark
  // Half angle of the cone about the rest orientation [rad], 0: none. slack: the capsule is loose
  // so far and resists more and more up to the limit; equal to the limit where that is a stop.
  double limit, slack;
  double stiffness, damping, armature;
};

struct Servo {        // left side of a pair
  std::string joint;  // ball joint, or "lumbar", "thoracic", "cervical" for discs of that region
  std::string motion;
  Eigen::Vector3d axis;
  double min, max;  // [rad]; 0 for the rows of a region
  double kp, kv, force_limit;
};

struct Muscle {                    // a line of action, left one of a pair
  std::string name, group;         // "MF_m1s", "multifidus"
  double section;                  // physiological cross-section [m^2]
  std::vector<std::string> sites;  // along the line, see model/muscle.h
};

// Name without the side: "ALL_lat" of "ALL_lat_left"; column of ligament_lengths.csv.
std::string ligamentPair(const Ligament& ligament);

// Motions of a level; lateral bending and axial rotation to one side.
enum Motion {
  kFlexion,
  kExtension,
  kFlexionExtension,
  kLateralBending,
  kAxialRotation,
  kNumMotions
};
const std::string& motionName(Motion motion);  // "flexion" ... as in range_of_motion.csv

struct MotionRange {  // published [rad], 0 <= low <= mean <= high
  double mean, low, high;
  std::string sources;
};
using RangeOfMotion = std::array<MotionRange, kNumMotions>;

// A published in-vitro test of discs, or of whole motion segments, of one region; what the columns
// mean is told at the top of disc_tests.csv.
struct DiscTest {
  enum class Quantity {
    kCompression,  // stiffness [N/m], as are the next four
    kTension,
    kAnteriorShear,
    kPosteriorShear,
    kLateralShear,
    kFlexion,  // stiffness [Nm/rad], as are the next three
    kExtension,
    kLateralBending,
    kAxialTorsion,
    kPressure,      // in the nucleus [Pa]
    kLossFactor,    // tan of the phase angle
    kPreloadRatio,  // stiffness under the preload over stiffness without
  };
  Region region;
  Quantity quantity;
  bool whole_segment;      // else the disc alone, without posterior elements
  double load;             // where the value holds [N], [Nm]; 0: small displacements
  double preload;          // axial compression held during the test [N]
  double value;            // > 0
  double low, high;        // low <= value <= high; -infinity, infinity where nothing is published
  bool fit;                // a calibration aims at it; its bounds are finite
  std::string source;      // key of the list at the top of the table
  std::string provenance;  // one of the words explained there
  std::string note;
};

// A measure of the average man and the average woman; unit and source stand in sex.csv.
struct SexDifference {
  double male, female;  // > 0
  double ratio() const { return female / male; }
};

class BodyWarp;  // model/body_warp.h

// True if a value is in the test's range, or out of it by no more than the thousandth that the fit
// leaves.
bool insideRange(const DiscTest& test, double value);
const std::string& discQuantityName(DiscTest::Quantity quantity);  // "compression" ...

struct Anatomy {
  std::vector<Vertebra> vertebrae;  // L5 .. C3, from below
  Vertebra c2;                      // part of the head body
  std::vector<Disc> discs;          // L5/S1 .. C2/C3, from below
  std::vector<ArticularFacet> facets;
  std::vector<CostalJoint> costal_joints;
  std::vector<Ligament> ligaments;
  // Left side of a pair; sites of muscles among them.
  std::map<std::string, Eigen::Vector3d> landmarks;
  // Body, vertebra or disc that each landmark keeps its place on.
  std::map<std::string, std::string> landmark_carriers;
  std::vector<Segment> segments;
  std::vector<BallJoint> joints;
  std::vector<Servo> servos;
  std::vector<Muscle> muscles;
  std::set<std::string> muscle_ends;                     // landmarks that lie on the bone's surface
  std::map<std::string, RangeOfMotion> range_of_motion;  // by disc
  std::vector<DiscTest> disc_tests;                      // not used by the model
  std::map<std::string, SexDifference> sex_differences;  // used by personalAnatomy only

  // Throws std::runtime_error that names the file, line and column at fault.
  static Anatomy load(const std::string& folder);

  // By name; "S1" has a frame too: the S1 upper endplate's, pitched by the sacral slope.
  Eigen::Isometry3d boneFrame(const std::string& level) const;
  const Vertebra& vertebra(const std::string& level) const;  // includes C2; throws if unknown
  const Disc& disc(const std::string& name) const;  // throws std::runtime_error that lists them
  const Eigen::Vector3d& landmark(const std::string& name) const;
  const Segment& segment(const std::string& name) const;
  double sacral_slope = 0;  // pitch of the S1 endplate [rad]
  double stature() const;   // head vertex to sole [m]
  double mass() const;      // [kg]

  // Size and weight relative to the tables'. What the code adds to the tables (offsets, radii,
  // stiffnesses that no table holds) is multiplied accordingly.
  double length_scale = 1, mass_scale = 1;
  // Of the flesh's thickness: greater than length_scale in a body that is heavier than another of
  // its stature.
  double girth_scale = 1;
  // How a person's bones that are no vertebrae differ in shape and place from the tables' body, at
  // the size of the tables; null: not at all. Set by personalAnatomy.
  std::shared_ptr<const BodyWarp> warp;

  // A body of the same shape with all lengths times `length` and all masses times `mass`, both > 0,
  // that moves in the same time: inertias, and stiffness, damping, gain and force limit of joints
  // and servos, go with mass * length^2, moduli of discs with mass / length (their linear stiffness
  // with mass), sections of muscles with mass / length. Angles, times and Poisson's ratio stay, and
  // so do disc_tests, which are the figures of publications.
  Anatomy scaled(double length, double mass) const;
};

// y -> -y, for points; and for rotation axes, which turn the other way in a mirror.
Eigen::Vector3d mirror(const Eigen::Vector3d& point);
Eigen::Vector3d mirrorAxis(const Eigen::Vector3d& axis);

}  // namespace torso
