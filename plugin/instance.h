// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the plugin knows about one mjModel: the torso data found in its custom fields, checked, and
// the disc solvers built from them. Immutable after construction.
//
// Custom fields (README, "The model's data"), each name with the torso's prefix, if any, in front:
//   numeric mujoco_torso     format, the plugin's note (0 in files), first entry of userdata
//   tuple   disc:NAME        site lower, site upper, equality weld, numeric material, text
//   positions,
//                            text topology [, skin]
//   numeric disc:NAME        DiscMaterial in its order, SI units; retardation time [s]
//   text    disc:NAME        positions_mm x y z ...
//   text    disc_topology    tets a b c d ... lower i ... upper i ... cells c ... hoops a b ...
//   tuple   bushing:NAME     equality weld, numeric
//   numeric bushing:NAME     k [N/m], c [Ns/m], k [Nm/rad], c [Nms/rad]
//   tuple   facet:NAME       geom ellipsoid (prm: band), geom point x 4
//   tuple   ligament:NAME    tendon ...

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/disc_batch.h"

namespace torso::plugin {

// Index of userdata entries of one model, from the first of the torso's.
struct StateLayout {
  int adr = 0;        // first entry of userdata
  int time = 0;       // mjData.time of the last evaluation
  int valid = 1;      // 1 after the first evaluation, 0 in fresh or reset data
  int poses = 2;      // fingerprint of the discs' poses at the last evaluation
  int committed = 3;  // (disc state) shape at the last evaluation before that time
  int pending = 0;    // (disc state) shape at that evaluation
  int result = 0;     // (ndisc x kResult) force, moment, point, two pressures
  int size = 0;       // entries in all
  static constexpr int kResult = 11;
};

struct DiscEntry {
  std::string name;
  int lower_body, upper_body;
  DiscPose lower_frame, upper_frame;  // of the disc in the two bodies (position [m], rotation)
  double retardation_time;            // [s]
  int tuple;                          // id
};

// Weld whose constraint rows the plugin rewrites into a linear spring and damper, implicit in the
// end-of-step velocity.
struct WeldEntry {
  int equality;
  int disc;                 // the disc it stabilises, or -1
  double stiffness[2];      // translation [N/m], rotation [Nm/rad]: spring the row itself carries
  double bound[2];          // stiffness of what acts beside the row (the disc's finite elements)
  double damping[2];        // [Ns/m], [Nms/rad]
  std::vector<int> servos;  // actuators on the relative rotation of the two bodies
};

struct FacetEntry {
  std::string name;
  int ellipsoid_geom;
  int point_geoms[4];
  Eigen::Vector3d rest[4];  // places of the points at qpos0, in the frame of the ellipsoid [m]
  double band;
};

struct Ligament {
  std::string name;
  std::vector<int> tendons;
};

// Level read-out: tendons and facets between the two bodies of a disc.
struct Level {
  std::vector<int> tendons;  // in the order of the ligaments
  std::vector<int> facets;   // in the order of the facets
};

struct Sensor {
  int id;  // sensor id
  int disc;
  int what;  // mujoco_torso.h: 0 force, 1 moment, see findSensors
};

struct TendonSensor {
  int sensor = -1, entry = 0;  // sensor id and place in its data
};

class Instance {
 public:
  // Throws std::runtime_error with a message that names the element at fault and the mend.
  explicit Instance(const mjModel* m);

  int torsos = 0;
  std::vector<DiscEntry> discs;
  std::unique_ptr<DiscBatch> batch;
  std::vector<WeldEntry> welds;
  std::vector<int> weld_of_equality;  // (neq) index into welds, or -1
  std::vector<FacetEntry> facets;
  std::vector<int> facet_of_geom;  // (ngeom) index into facets, for points and ellipsoids; or -1
  std::vector<Ligament> ligaments;
  std::vector<char> is_ligament;  // (ntendon)
  std::vector<Level> levels;      // (ndisc)
  std::vector<Sensor> sensors;
  std::vector<TendonSensor> sensor_of_tendon;             // (ntendon)
  std::vector<std::vector<std::pair<int, int>>> columns;  // (ndisc) opposite nodes: lower, upper
  StateLayout state;
  int scratch_entries = 0;  // mjtNum on mjData's stack that one evaluation needs

 private:
  void readHeaders(const mjModel* m);
  // id: of the tuple, name: of the entry. meshes: gets the disc's mesh and material.
  void addDisc(const mjModel* m, int id, const std::string& name,
               std::vector<DiscBatch::Disc>& meshes);
  void addBushing(const mjModel* m, int id);
  void addFacet(const mjModel* m, int id, const std::string& name);
  void addLigament(const mjModel* m, int id, const std::string& name);
  void boundWelds(const mjModel* m);
  void findLevels(const mjModel* m);
  void findSensors(const mjModel* m);
  void findColumns();
  void layOutState(const mjModel* m);
};

// True if the model has a numeric called (prefix)mujoco_torso.
bool hasTorso(const mjModel* m);

}  // namespace torso::plugin
