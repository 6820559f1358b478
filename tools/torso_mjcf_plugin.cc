// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What the plugin reads: sensors, and the data of discs, ligaments, facets and ribs.

#include "tools/simple_trunk.h"
#include "tools/torso_mjcf_writer.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

// The ribs that reach the sternum, T1 - T10, bend: each pair holds its vertebra to the cage as a
// linear bushing. Translation: a rib bends by a millimetre under some newtons (Schultz et al. 1974,
// J Biomech 7:303-309), a pair near its vertebra is taken as stiffer. Rotation: so that the cage's
// share of the thorax' stiffness is as measured in vitro (region_motion.csv; torso rom --whole).
constexpr double kBushing[4] = {1e4, 200, 5, 1};  // [N/m, Ns/m, Nm/rad, Nms/rad]

}  // namespace

void MjcfWriter::writeSensors() {
  Element sensors(root_, "sensor");
  // user[0] says what the plugin writes: 0 force, 1 moment, 2 pressure of a disc, 5 that in its
  // nucleus; 3 ligament tensions, 4 facet forces of a level (mujoco_torso.h).
  const auto user = [&](const std::string& name, const std::string& disc, int what, int dim) {
    Element(sensors, "user")
        .set("name", named(name))
        .set("objtype", "tuple")
        .set("objname", named("disc:" + disc))
        .set("datatype", "real")
        .set("needstage", "acc")
        .set("dim", dim)
        .set("user", what);
  };
  for (const Disc& disc : levels_) {
    user(disc.name + "_force", disc.name, 0, 3);
    user(disc.name + "_moment", disc.name, 1, 3);
    user(disc.name + "_pressure", disc.name, 2, 1);
    user(disc.name + "_nucleus_pressure", disc.name, 5, 1);
    if (disc.upper == a_.c2.name) continue;
    user(disc.name + "_ligament_tension", disc.name, 3, static_cast<int>(a_.ligaments.size()));
    user(disc.name + "_facet_force", disc.name, 4, 2);
  }
}

void MjcfWriter::writeCustom() {
  Element custom(root_, "custom");
  const auto numeric = [&](const std::string& name, std::initializer_list<double> values) {
    Element(custom, "numeric").set("name", named(name)).set("data", values);
  };
  const auto element = [](XMLElement* tuple, const char* type, const std::string& name,
                          double prm = 0) {
    Element(tuple, "element").set("objtype", type).set("objname", name).set("prm", prm);
  };
  // Format, the plugin's own note, first entry of userdata.
  numeric("mujoco_torso", {2, 0, 0});

  // All discs of makeDiscMesh share one topology.
  std::string topology = "tets";
  for (const auto& t : discs_.front().tets) {
    for (int node : t) topology += " " + std::to_string(node);
  }
  topology += " lower";
  for (int node : discs_.front().lower_nodes) topology += " " + std::to_string(node);
  topology += " upper";
  for (int node : discs_.front().upper_nodes) topology += " " + std::to_string(node);
  topology += " cells";
  for (int cell : discs_.front().cells) topology += " " + std::to_string(cell);
  topology += " hoops";
  for (const auto& [a, b] : discs_.front().hoops) {
    topology += " " + std::to_string(a) + " " + std::to_string(b);
  }
  Element(custom, "text").set("name", named("disc_topology")).set("data", topology);

  for (std::size_t i = 0; i < levels_.size(); i++) {
    const Disc& disc = levels_[i];
    std::string positions = "positions_mm";
    for (const Vector3d& X : discs_[i].rest_positions) {
      for (int k = 0; k < 3; k++) positions += fmt::format(" {:.4f}", X[k] * 1e3 + 0.0);
    }
    Element(custom, "text").set("name", named("disc:" + disc.name)).set("data", positions);
    const DiscMaterial& material = disc.material;
    numeric("disc:" + disc.name,
            {material.annulus_modulus, material.annulus_poisson, material.fibre_modulus,
             material.fibre_stiffening, material.fibre_angle, material.nucleus_modulus,
             material.nucleus_bulk_modulus, disc.retardation_time});
    Element tuple(custom, "tuple");
    tuple.set("name", named("disc:" + disc.name));
    element(tuple, "site", named(disc.name + "_lower"));
    element(tuple, "site", named(disc.name + "_upper"));
    element(tuple, "equality", named(disc.name));
    element(tuple, "numeric", named("disc:" + disc.name));
    element(tuple, "text", named("disc:" + disc.name));
    element(tuple, "text", named("disc_topology"));
    element(tuple, "skin", named(disc.name));
  }
  const double force = a_.mass_scale, torque = force * a_.length_scale * a_.length_scale;
  numeric("bushing:ribcage",
          {force * kBushing[0], force * kBushing[1], torque * kBushing[2], torque * kBushing[3]});
  for (const std::string level : kSternalLevels) {
    if (!has("ribcage") || !has(level)) continue;
    const std::string name = "ribcage_" + level;
    Element bushing(custom, "tuple");
    bushing.set("name", named("bushing:" + name));
    element(bushing, "equality", named(name));
    element(bushing, "numeric", named("bushing:ribcage"));
  }

  for (const Facet& facet : facets_) {
    Element tuple(custom, "tuple");
    tuple.set("name", named("facet:" + facet.name));
    element(tuple, "geom", named(facet.name + "_ellipsoid"), facet.band);
    for (int i = 0; i < 4; i++) {
      element(tuple, "geom", named(facet.name + "_point" + std::to_string(i)));
    }
  }
  for (const Ligament& ligament : a_.ligaments) {
    if (ligaments_.empty()) break;
    Element tuple(custom, "tuple");
    tuple.set("name", named("ligament:" + ligament.name));
    for (const LigamentSegment& s : ligaments_) {
      if (s.ligament == ligament.name) element(tuple, "tendon", named(s.name));
    }
  }
}

}  // namespace torso::tools
