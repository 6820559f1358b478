// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Options, defaults and assets.

#include "model/loft.h"
#include "tools/torso_mjcf_writer.h"

namespace torso::tools {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

// Bits of contype and conaffinity. Anything with MuJoCo's default bits (1, 1) meets every bone;
// limbs and head also meet each other, the rib cage, the lumbar slices and the pelvis.
constexpr int kWorldBit = 1, kLimbBit = 2;

// Rows exist from this distance before the limit, so that the plugin can stop a fast ligament at
// it. In falls from 2 m every ligament that took force began the step within 0.06 mm of its limit
// at 600 Hz, and all but 1 in 10^4 within 0.25 mm at 200 Hz.
constexpr double kLigamentMargin = 0.0005;

}  // namespace

void MjcfWriter::writeOptions() {
  Element(root_, "compiler").set("autolimits", "true");
  Element(root_, "option")
      .set("timestep", 1.0 / 600)
      .set("jacobian", "sparse")
      .set("solver", "Newton");
  // Table sizes cost memory and time: about twice what 2 m falls with random controls use.
  Element size(root_, "size");
  size.set("njmax", 1500).set("nconmax", 500).set("nstack", 2000000);
  if (detailed()) size.set("nuser_sensor", 1).set("nuserdata", 20000);
}

void MjcfWriter::writeDefaults() {
  Element defaults(root_, "default");
  const auto makeClass = [&](const char* name) {
    return Element(defaults, "default").set("class", named(name));
  };
  Element bone = makeClass("bone");
  Element(bone, "geom")
      .set("type", "mesh")
      .set("group", kBoneGroup)
      .set("contype", 0)
      .set("conaffinity", 0)
      .set("mass", 0)
      .set("material", named("bone"));
  const auto collision = [&](const char* name, int contype, int conaffinity) {
    Element c = makeClass(name);
    Element(c, "geom")
        .set("group", kCollisionGroup)
        .set("contype", contype)
        .set("conaffinity", conaffinity)
        .set("condim", 3)
        .set("friction", {kFriction[0], kFriction[1], kFriction[2]})
        .set("mass", 0)
        .set("solref", kContactSolref)
        .set("solimp", kContactSolimp)
        .set("rgba", {0.8, 0.5, 0.4, 0.35});
  };
  collision("spine", 0, kWorldBit);
  collision("trunk", 0, kWorldBit | kLimbBit);
  collision("limb", kLimbBit, kWorldBit | kLimbBit);
  if (!detailed()) return;
  Element ellipsoid = makeClass("facet_ellipsoid");
  Element(ellipsoid, "geom")
      .set("type", "ellipsoid")
      .set("group", kFacetGroup)
      .set("contype", 0)
      .set("conaffinity", 0)
      .set("mass", 0)
      .set("rgba", {0.25, 0.45, 0.9, 0.5});
  Element point = makeClass("facet_point");
  Element(point, "geom")
      .set("type", "sphere")
      .set("size", 0.001)
      .set("group", kFacetGroup)
      .set("contype", 0)
      .set("conaffinity", 0)
      .set("mass", 0)
      .set("rgba", {0.9, 0.15, 0.1, 1});
  Element ligament = makeClass("ligament");
  Element(ligament, "tendon")
      .set("group", kLigamentGroup)
      .set("width", 0.0009)
      .set("margin", kLigamentMargin)
      .set("rgba", {0.80, 0.72, 0.55, 1})
      .set("solreflimit", kLimitSolref)
      .set("solimplimit", kLimitSolimp);
  Element(ligament, "site")
      .set("group", kSiteGroup)
      .set("size", 0.0012)
      .set("rgba", {0.8, 0.6, 0.3, 1});
  if (!muscles_.empty()) {
    Element muscle = makeClass("muscle");
    Element(muscle, "tendon")
        .set("group", kMuscleGroup)
        .set("width", 0.0015)
        .set("rgba", {0.72, 0.22, 0.20, 1});
    Element(muscle, "site").set("group", kSiteGroup).set("size", 0.0015);
  }
  Element frames = makeClass("disc_frame");
  Element(frames, "site")
      .set("group", kSiteGroup)
      .set("size", 0.002)
      .set("rgba", {0.2, 0.8, 0.3, 1});
}

void MjcfWriter::writeAssets() {
  Element asset(root_, "asset");
  Element(asset, "material")
      .set("name", named("bone"))
      .set("rgba", {0.89, 0.85, 0.74, 1})
      .set("specular", 0.25)
      .set("shininess", 0.3);
  Element(asset, "material")
      .set("name", named("cartilage"))
      .set("rgba", {0.73, 0.80, 0.83, 1})
      .set("specular", 0.3)
      .set("shininess", 0.4);
  for (const std::string& body : o_.bones ? mjcfBodies(a_, o_) : std::vector<std::string>()) {
    for (const Tissue tissue : tissues(body)) {
      const std::string name = boneMeshName(body, tissue);
      Element mesh(asset, "mesh");
      mesh.set("name", named(name)).set("file", o_.mesh_dir + "/" + name + ".stl");
      const auto limb = o_.limb_scale.find(splitSide(body).second);
      const double scale = o_.mesh_scale * (limb == o_.limb_scale.end() ? 1 : limb->second);
      if (scale != 1) mesh.set("scale", {scale, scale, scale});
    }
  }
  if (detailed()) {
    Element(asset, "material")
        .set("name", named("disc"))
        .set("rgba", {0.42, 0.62, 0.80, 1})
        .set("specular", 0.4)
        .set("shininess", 0.5);
    writeSkins(asset);
  }
}

// The outside of each disc, bound half to half to its two bones.
void MjcfWriter::writeSkins(XMLElement* asset) {
  for (const Disc& disc : levels_) {
    // Rings of the outline at the lower endplate, half way and at the upper one, and the middles of
    // the two endplates.
    constexpr int kPoints = 36;
    const auto outline = endplateOutline(disc.shape.width, disc.shape.depth, kPoints);
    std::string vertices, faces, ids, lower_weights, upper_weights;
    int count = 0;
    const auto addVertex = [&](const Eigen::Vector2d& p, int level) {  // -1 lower, 1 upper
      const double front = p.x() / disc.shape.depth + 0.5;
      const double height = disc.shape.height_posterior +
                            front * (disc.shape.height_anterior - disc.shape.height_posterior);
      vertices += mjcfText(disc.frame * Vector3d(p.x(), p.y(), level * height / 2)) + " ";
      ids += std::to_string(count++) + " ";
      upper_weights += mjcfNumber((level + 1) / 2.0 + 1e-4) + " ";
      lower_weights += mjcfNumber((1 - level) / 2.0 + 1e-4) + " ";
    };
    const auto addFace = [&](int a, int b, int c) { faces += fmt::format("{} {} {} ", a, b, c); };
    for (int level : {-1, 0, 1}) {
      for (const auto& p : outline) addVertex(p, level);
    }
    addVertex(Eigen::Vector2d::Zero(), -1);
    addVertex(Eigen::Vector2d::Zero(), 1);
    for (int k = 0; k < kPoints; k++) {
      const int next = (k + 1) % kPoints;
      for (int ring : {0, kPoints}) {
        addFace(ring + k, ring + next, ring + kPoints + next);
        addFace(ring + k, ring + kPoints + next, ring + kPoints + k);
      }
      addFace(3 * kPoints, next, k);
      addFace(3 * kPoints + 1, 2 * kPoints + k, 2 * kPoints + next);
    }
    Element skin(asset, "skin");
    skin.set("name", named(disc.name))
        .set("material", named("disc"))
        .set("group", kDiscGroup)
        .set("vertex", vertices)
        .set("face", faces);
    for (const auto& [level, weights] :
         {std::pair{disc.lower, lower_weights}, {disc.upper, upper_weights}}) {
      const std::string body = bodyOfLevel(a_, level);
      Element(skin, "bone")
          .set("body", named(body))
          .set("bindpos", Vector3d(frame(body).translation()))
          .set("bindquat", Quaterniond(frame(body).linear()))
          .set("vertid", ids)
          .set("vertweight", weights);
    }
  }
}

}  // namespace torso::tools
