// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/torso_mjcf.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "model/body.h"
#include "model/disc_fit.h"
#include "model/facet.h"
#include "model/ligament.h"
#include "model/loft.h"
#include "model/muscle.h"
#include "tools/collision_shapes.h"
#include "tools/mjcf.h"
#include "tools/simple_trunk.h"
#include "tools/whole_shoulder.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

// Viewer groups, one per layer; 0-2 are shown at first, 3-5 hidden.
constexpr int kBoneGroup = 1, kDiscGroup = 1, kLigamentGroup = 1;
constexpr int kMuscleGroup = 2;
constexpr int kCollisionGroup = 3, kFacetGroup = 4, kSiteGroup = 4;

// Bits of contype and conaffinity. Anything with MuJoCo's default bits (1, 1) meets every bone;
// limbs and head also meet each other, the rib cage, the lumbar slices and the pelvis.
constexpr int kWorldBit = 1, kLimbBit = 2;

// Of bones with the world and each other.
constexpr double kFriction[3] = {0.8, 0.005, 0.0001};  // MuJoCo's sliding, torsional, rolling
constexpr const char* kContactSolref = "0.01 1";
constexpr const char* kContactSolimp = "0.9 0.95 0.005";

// Facet pairs: the margin passes them through the bounding-sphere filter at any excursion. The gap
// is so much larger that stock MuJoCo, to which a point on an ellipsoid is a penetration in any
// direction, never acts on them; the plugin reports distances below it (facet_collider.h).
constexpr double kFacetMargin = 0.1, kFacetGap = 0.3;

// The ribs that reach the sternum, T1 - T10, bend: each pair holds its vertebra to the cage as a
// linear bushing. Translation: a rib bends by a millimetre under some newtons (Schultz et al. 1974,
// J Biomech 7:303-309), a pair near its vertebra is taken as stiffer. Rotation: so that the cage's
// share of the thorax' stiffness is as measured in vitro (region_motion.csv; torso rom --whole).
constexpr double kBushing[4] = {1e4, 200, 5, 1};  // [N/m, Ns/m, Nm/rad, Nms/rad]

// Rows exist from this distance before the limit, so that the plugin can stop a fast ligament at
// it. In falls from 2 m every ligament that took force began the step within 0.06 mm of its limit
// at 600 Hz, and all but 1 in 10^4 within 0.25 mm at 200 Hz.
constexpr double kLigamentMargin = 0.0005;

// Stiff enough to hold the band within a millimetre in a 2 m fall, soft enough for 200 Hz.
constexpr const char* kLimitSolref = "0.004 1";
constexpr const char* kLimitSolimp = "0.9 0.99 0.001";

// The capsule of a joint with slack, as a limit with impedance d, which resists by d^2 / (1 - d) /
// 0.034^2 / 0.98^2 times the angle beyond the slack and the joint's mean inertia: 5 Nm/rad for the
// arm of the tables while d is 0.5, and as a stop where it nears 0.98.
constexpr const char* kCapsuleSolref = "0.034 1";
std::string capsuleSolimp(const BallJoint& joint) {
  return mjcfText({0.5, 0.98, joint.limit - joint.slack, 0.9, 10});
}

class Writer {
 public:
  Writer(const Anatomy& anatomy, const MjcfOptions& options, XMLElement* root)
      : a_(anatomy), o_(options), root_(root) {}

  void write();

 private:
  // Is the body, of either side, among those that are written?
  bool has(const std::string& body) const {
    return o_.only.empty() || std::find(o_.only.begin(), o_.only.end(), body) != o_.only.end();
  }
  bool detailed() const { return o_.kind == TorsoKind::kDetailed; }
  std::string named(const std::string& name) const { return o_.prefix + name; }
  // Body in which a body of the anatomy is moulded: itself, or a rigid part of the torso.
  std::string host(const std::string& body) const;
  std::vector<std::string> hosts() const;  // all of them, in the order of the MJCF
  Isometry3d frame(const std::string& body) const { return bodyFrame(a_, host(body)); }
  Vector3d local(const std::string& body, const Vector3d& standing) const {
    return frame(body).inverse() * standing;
  }
  Quaterniond localRotation(const std::string& body, const Matrix3d& standing) const {
    return Quaterniond(frame(body).linear().transpose() * standing);
  }

  std::vector<Tissue> tissues(const std::string& body) const {
    if (o_.own && o_.own->meshes.count(body)) return {Tissue::kBone};
    return boneTissues(a_, body);
  }

  void writeOptions();
  void writeDefaults();
  void writeAssets();
  void writeBodies();
  XMLElement* writeBody(XMLElement* parent, const std::string& parent_name,
                        const std::string& body);
  void writeBones(XMLElement* element, const std::string& body);
  void writeInertial(XMLElement* element, const std::string& body);
  XMLElement* facetBody(const std::string& body);
  std::string axesSite(const std::string& body);
  void writeSites();
  void writeContacts();
  void writeTrunkPairs(XMLElement* contact, const std::string& limb,
                       const std::set<std::string>& excluded) const;
  bool neighbours(const std::string& limb, const std::string& part) const;
  void writeTendons();
  void writeEqualities();
  void writeActuators();
  void writeMuscleActuators();
  void writeSensors();
  void writeCustom();
  void writeSkins(XMLElement* asset);

  const Anatomy& a_;
  const MjcfOptions& o_;
  XMLElement* root_;
  std::map<std::string, XMLElement*> bodies_, facet_bodies_;
  std::set<std::string> axes_;  // bodies that have an axesSite
  std::vector<Facet> facets_;
  std::vector<LigamentSegment> ligaments_;
  std::vector<MuscleLine> muscles_;
  std::vector<Disc> levels_;
  std::vector<DiscMesh> discs_;  // of levels_
};

bool isRigidPart(const std::string& body) {
  const auto [side, name] = splitSide(body);
  return side == Side::kMiddle || name == "clavicle" || name == "scapula";
}

std::string Writer::host(const std::string& body) const {
  if (detailed() || !isRigidPart(body) || body == "head") return body;
  return o_.kind == TorsoKind::kSimple ? simpleTrunkBody(a_, body) : "pelvis";
}

std::vector<std::string> Writer::hosts() const {
  std::vector<std::string> all;
  for (const std::string& body : mjcfBodies(a_, o_)) {
    const std::string name = host(body);
    if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
  }
  return all;
}

void Writer::write() {
  root_->SetAttribute("model", named(o_.limbs ? "human" : "torso").c_str());
  if (detailed()) {
    const Skeleton* bones = o_.skeleton;
    for (const Facet& facet : o_.own  ? o_.own->facets
                              : bones ? makeFacets(a_, *bones)
                                      : makeFacets(a_)) {
      if (has(facet.points_body) && has(facet.ellipsoid_body)) facets_.push_back(facet);
    }
    for (const LigamentSegment& s : o_.own  ? o_.own->ligaments
                                    : bones ? makeLigaments(a_, *bones)
                                            : makeLigaments(a_)) {
      if (has(bodyOfLevel(a_, s.lower)) && has(bodyOfLevel(a_, s.upper))) ligaments_.push_back(s);
    }
    const std::vector<std::string> bodies = mjcfBodies(a_, o_);
    for (const MuscleLine& line : !o_.muscles ? std::vector<MuscleLine>()
                                  : bones     ? makeMuscles(a_, *bones)
                                              : makeMuscles(a_)) {
      const auto missing = [&](const MusclePoint& p) {
        return std::find(bodies.begin(), bodies.end(), p.body) == bodies.end();
      };
      if (std::none_of(line.points.begin(), line.points.end(), missing)) muscles_.push_back(line);
    }
    for (const Disc& disc : a_.discs) {
      if (!has(bodyOfLevel(a_, disc.lower)) || !has(bodyOfLevel(a_, disc.upper))) continue;
      levels_.push_back(disc);
      const bool fitted = bones && !o_.own;
      discs_.push_back(fitted ? fittedDiscMesh(a_, *bones, disc) : makeDiscMesh(disc.shape));
    }
  }
  if (o_.scene) Element(root_, "include").set("file", "scene.xml");
  writeOptions();
  writeDefaults();
  writeAssets();
  writeBodies();
  if (detailed()) writeSites();
  writeContacts();
  if (detailed()) writeTendons();
  if (detailed()) writeEqualities();
  writeActuators();
  writeMuscleActuators();
  if (detailed()) writeSensors();
  if (detailed()) writeCustom();
}

void Writer::writeOptions() {
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

void Writer::writeDefaults() {
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

void Writer::writeAssets() {
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
void Writer::writeSkins(XMLElement* asset) {
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

void Writer::writeInertial(XMLElement* element, const std::string& body) {
  // Everything that is moulded into this body.
  Inertial sum;
  std::vector<Inertial> parts;
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (host(part) != body) continue;
    parts.push_back(bodyInertial(a_, part));
    const Inertial& p = parts.back();
    sum.com = (sum.mass * sum.com + p.mass * p.com) / (sum.mass + p.mass);
    sum.mass += p.mass;
  }
  for (const Inertial& p : parts) {
    const Vector3d r = p.com - sum.com;
    sum.inertia +=
        p.inertia + p.mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  const Matrix3d R = frame(body).linear();
  const Matrix3d I = R.transpose() * sum.inertia * R;
  Element(element, "inertial")
      .set("pos", local(body, sum.com))
      .set("mass", sum.mass)
      .set("fullinertia", {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
}

void Writer::writeBones(XMLElement* element, const std::string& body) {
  for (const Tissue tissue : o_.bones ? tissues(body) : std::vector<Tissue>()) {
    const std::string name = boneMeshName(body, tissue);
    Element geom(element, "geom");
    geom.set("name", named(name)).set("class", named("bone")).set("mesh", named(name));
    if (tissue == Tissue::kCartilage) geom.set("material", named("cartilage"));
    const Isometry3d offset = frame(body).inverse() * bodyFrame(a_, body);
    if (!offset.isApprox(Isometry3d::Identity())) {
      geom.set("pos", Vector3d(offset.translation())).set("quat", Quaterniond(offset.linear()));
    }
  }
  int count = 0;
  for (const CollisionShape& shape : collisionShapes(a_, body)) {
    const std::string name = body + "_collision" + std::to_string(count++);
    Element geom(element, "geom");
    geom.set("name", named(name)).set("class", named(shape.kind));
    geom.set("type", "capsule").set("size", shape.radius);
    geom.set("fromto", mjcfText(local(body, shape.from)) + " " + mjcfText(local(body, shape.to)));
  }
}

XMLElement* Writer::writeBody(XMLElement* parent, const std::string& parent_name,
                              const std::string& body) {
  Element element(parent, "body");
  element.set("name", named(body));
  bodies_[body] = element;
  const Isometry3d X = frame(body);
  if (parent_name.empty()) {
    element.set("pos", Vector3d(X.translation() + Vector3d(0, 0, o_.height)));
    element.set("quat", Quaterniond(X.linear()));
    if (body != o_.anchored) Element(element, "freejoint").set("name", named(body));
  } else {
    const Isometry3d P = frame(parent_name).inverse() * X;
    element.set("pos", Vector3d(P.translation())).set("quat", Quaterniond(P.linear()));
    const auto [side, name] = splitSide(body);
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      const std::string prefix = body.substr(0, body.size() - name.size());
      Element ball(element, "joint");
      ball.set("name", named(prefix + joint.name))
          .set("type", "ball")
          .set("stiffness", joint.stiffness)
          .set("damping", joint.damping)
          .set("armature", joint.armature);
      const Vector3d centre =
          local(body, side == Side::kRight ? mirror(joint.position) : joint.position);
      if (!centre.isZero(1e-9)) ball.set("pos", centre);
      // In degrees, MJCF's default, so that the file can be included in others.
      if (joint.limit > 0) {
        const bool capsule = joint.slack < joint.limit;
        ball.set("range", {0, joint.slack * 180 / M_PI})
            .set("solreflimit", capsule ? kCapsuleSolref : kLimitSolref)
            .set("solimplimit", capsule ? capsuleSolimp(joint) : kLimitSolimp);
      }
    }
  }
  writeInertial(element, body);
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (host(part) == body) writeBones(element, part);
  }
  for (const std::string& child : hosts()) {
    const auto [side, name] = splitSide(child);
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      if (host(pairedName(a_, side, joint.parent)) == body) writeBody(element, body, child);
    }
  }
  return element;
}

void Writer::writeBodies() {
  Element world(root_, "worldbody");
  for (const std::string& body : hosts()) {
    const bool hangs = std::any_of(a_.joints.begin(), a_.joints.end(), [&](const BallJoint& joint) {
      return joint.child == splitSide(body).second;
    });
    if (!hangs) writeBody(world, "", body);
  }
  if (!has("pelvis")) return;
  Element(bodies_["pelvis"], "camera")
      .set("name", named("front"))
      .set("mode", "trackcom")
      .set("pos", {2.6, 0, 0.35})
      .set("xyaxes", {0, 1, 0, -0.1, 0, 1});
  Element(bodies_["pelvis"], "camera")
      .set("name", named("side"))
      .set("mode", "trackcom")
      .set("pos", {0, -2.6, 0.35})
      .set("xyaxes", {1, 0, 0, 0, 0.1, 1});
  Element(bodies_["pelvis"], "camera")
      .set("name", named("back"))
      .set("mode", "trackcom")
      .set("pos", {-2.2, 0.9, 0.6})
      .set("xyaxes", {-0.38, -0.93, 0, 0.15, -0.06, 1});
}

// A massless body, fixed to its bone, for the geoms of facets: they meet nothing but each other,
// and here the broad phase of collision detection never looks at them.
XMLElement* Writer::facetBody(const std::string& body) {
  XMLElement*& element = facet_bodies_[body];
  if (!element) {
    element = Element(bodies_[body], "body").set("name", named(body + "_facets"));
    Element(element, "inertial").set("pos", {0, 0, 0}).set("mass", 0).set("diaginertia", {0, 0, 0});
  }
  return element;
}

// A site with the axes of the standing body, for servos between bones. It is on a body of its own:
// where a refsite is given MuJoCo 2.2.2 multiplies the quaternions of a site and its body in the
// wrong order, so that a site that is turned in its body would read another angle as the whole
// turns.
std::string Writer::axesSite(const std::string& body) {
  const std::string name = named(body + "_axes");
  if (!axes_.insert(body).second) return name;
  Element element(bodies_[body], "body");
  element.set("name", name).set("quat", localRotation(body, Matrix3d::Identity()));
  Element(element, "inertial").set("pos", {0, 0, 0}).set("mass", 0).set("diaginertia", {0, 0, 0});
  Element(element, "site").set("name", name).set("class", named("disc_frame"));
  return name;
}

void Writer::writeSites() {
  for (const Disc& disc : levels_) {
    for (const auto& [level, suffix] : {std::pair{disc.lower, "_lower"}, {disc.upper, "_upper"}}) {
      const std::string body = bodyOfLevel(a_, level);
      Element(bodies_[body], "site")
          .set("name", named(disc.name + suffix))
          .set("class", named("disc_frame"))
          .set("pos", local(body, disc.frame.translation()))
          .set("quat", localRotation(body, disc.frame.linear()));
    }
  }
  for (const Facet& facet : facets_) {
    const Isometry3d X = frame(facet.ellipsoid_body).inverse() * facet.ellipsoid;
    Element(facetBody(facet.ellipsoid_body), "geom")
        .set("name", named(facet.name + "_ellipsoid"))
        .set("class", named("facet_ellipsoid"))
        .set("size", facet.radii)
        .set("pos", Vector3d(X.translation()))
        .set("quat", Quaterniond(X.linear()));
    for (int i = 0; i < 4; i++) {
      Element(facetBody(facet.points_body), "geom")
          .set("name", named(facet.name + "_point" + std::to_string(i)))
          .set("class", named("facet_point"))
          .set("pos", local(facet.points_body, facet.points[i]));
    }
  }
  for (const LigamentSegment& s : ligaments_) {
    for (const auto& [level, point, suffix] :
         {std::tuple{s.lower, s.lower_point, "_lower"}, {s.upper, s.upper_point, "_upper"}}) {
      const std::string body = bodyOfLevel(a_, level);
      Element(bodies_[body], "site")
          .set("name", named(s.name + suffix))
          .set("class", named("ligament"))
          .set("pos", local(body, point));
    }
  }
  for (const MuscleLine& line : muscles_) {
    for (std::size_t k = 0; k < line.points.size(); k++) {
      const MusclePoint& p = line.points[k];
      Element(bodies_[p.body], "site")
          .set("name", named(line.name + "_" + std::to_string(k)))
          .set("class", named("muscle"))
          .set("pos", local(p.body, p.position));
    }
  }
}

// A body that is excluded as the neighbour of a limb may be moulded of other parts too. Those meet
// the limb, as in the detailed torso, by pairs of geoms.
void Writer::writeTrunkPairs(XMLElement* contact, const std::string& limb,
                             const std::set<std::string>& excluded) const {
  for (const std::string& part : mjcfBodies(a_, o_)) {
    if (!excluded.count(host(part)) || neighbours(limb, part)) continue;
    int count = 0;
    for (const CollisionShape& shape : collisionShapes(a_, part)) {
      const std::string name = fmt::format("{}_collision{}", part, count++);
      if (shape.kind != "trunk") continue;
      Element(contact, "pair")
          .set("geom1", named(limb + "_collision0"))
          .set("geom2", named(name))
          .set("condim", 3)
          .set("friction", {kFriction[0], kFriction[0], kFriction[1], kFriction[2], kFriction[2]})
          .set("solref", kContactSolref)
          .set("solimp", kContactSolimp);
    }
  }
}

// The torso's parts beside a limb's own joint, which it overlaps.
bool Writer::neighbours(const std::string& limb, const std::string& part) const {
  const auto [side, name] = splitSide(limb);
  static const std::map<std::string, std::set<std::string>> kNeighbours = {
      {"upper_arm", {"scapula", "clavicle", "ribcage"}}, {"thigh", {"pelvis", "L5", "L4"}}};
  const auto found = kNeighbours.find(name);
  const auto [part_side, part_name] = splitSide(part);
  return found != kNeighbours.end() && found->second.count(part_name) > 0 &&
         (part_side == side || part_side == Side::kMiddle);
}

void Writer::writeContacts() {
  Element contact(root_, "contact");
  // Neighbours that are not parent and child in the tree.
  const auto exclude = [&](const std::string& one, const std::string& two) {
    if (!bodies_.count(one) || !bodies_.count(two)) return;
    Element(contact, "exclude").set("body1", named(one)).set("body2", named(two));
  };
  for (const char* side : {"left_", "right_"}) {
    for (const char* limb : {"upper_arm", "thigh"}) {
      const std::string body = std::string(side) + limb;
      std::set<std::string> met;
      for (const std::string& part : mjcfBodies(a_, o_)) {
        const bool parent = part == "pelvis" || splitSide(part).second == "scapula";
        if (!parent && neighbours(body, part)) met.insert(host(part));
      }
      for (const std::string& part : met) exclude(body, part);
      if (!detailed() && bodies_.count(body)) writeTrunkPairs(contact, body, met);
    }
  }
  exclude("head", "ribcage");
  // The bits keep trunk and spine from meeting themselves, and the geoms of facets from meeting
  // anything. To say so body by body spares MuJoCo the look at each pair of their geoms, a fiftieth
  // of a step.
  std::set<std::string> limbs;
  for (const std::string& part : mjcfBodies(a_, o_)) {
    for (const CollisionShape& shape : collisionShapes(a_, part)) {
      if (shape.kind == "limb") limbs.insert(host(part));
    }
  }
  std::vector<std::string> trunk;
  for (const auto& [body, element] : bodies_) {
    if (limbs.count(body)) continue;
    for (const std::string& other : trunk) exclude(other, body);
    trunk.push_back(body);
  }
  for (const auto& [body, element] : facet_bodies_) {
    Element(contact, "exclude").set("body1", "world").set("body2", named(body + "_facets"));
  }
  for (const Facet& facet : facets_) {
    for (int i = 0; i < 4; i++) {
      Element(contact, "pair")
          .set("geom1", named(facet.name + "_point" + std::to_string(i)))
          .set("geom2", named(facet.name + "_ellipsoid"))
          .set("condim", 1)
          .set("margin", kFacetMargin)
          .set("gap", kFacetGap)
          .set("solref", kLimitSolref)
          .set("solimp", kLimitSolimp);
    }
  }
}

void Writer::writeTendons() {
  Element tendons(root_, "tendon");
  for (const LigamentSegment& s : ligaments_) {
    Element spatial(tendons, "spatial");
    spatial.set("name", named(s.name))
        .set("class", named("ligament"))
        // A lower limit that is never met: with 0 MuJoCo would draw slack ligaments as hanging
        // strings of so many pieces that the viewer has no room for the body.
        .set("range", {-s.max_length, s.max_length});
    Element(spatial, "site").set("site", named(s.name + "_lower"));
    Element(spatial, "site").set("site", named(s.name + "_upper"));
  }
  for (const MuscleLine& line : muscles_) {
    Element spatial(tendons, "spatial");
    spatial.set("name", named(line.name)).set("class", named("muscle"));
    for (std::size_t k = 0; k < line.points.size(); k++) {
      Element(spatial, "site").set("site", named(line.name + "_" + std::to_string(k)));
    }
  }
}

void Writer::writeEqualities() {
  Element equality(root_, "equality");
  const auto weld = [&](const std::string& name, const std::string& upper, const std::string& lower,
                        const Vector3d& anchor) {
    // The anchor is a point of body2. torquescale turns the rotational rows' metres into radians at
    // about the distance of a disc's rim, so that stock MuJoCo bends as readily as it shears.
    Element(equality, "weld")
        .set("name", named(name))
        .set("body1", named(upper))
        .set("body2", named(lower))
        .set("anchor", local(lower, anchor))
        .set("torquescale", 0.3)
        .set("solref", "0.004 1")
        .set("solimp", "0.95 0.95 0.001");
  };
  for (const Disc& disc : levels_) {
    weld(disc.name, bodyOfLevel(a_, disc.upper), bodyOfLevel(a_, disc.lower),
         disc.frame.translation());
  }
  for (const std::string level : kSternalLevels) {
    if (!has("ribcage") || !has(level)) continue;
    weld("ribcage_" + level, "ribcage", level, a_.vertebra(level).position);
  }
}

// The velocity gain of a spinal servo stands in bias parameter 3, which MuJoCo does not use: the
// plugin adds it to the implicit rows of the disc's weld. As an explicit force, or as the
// derivative that the implicit integrator would take of it beside the constraints, it would upset
// the light vertebrae.
void Writer::writeActuators() {
  Element actuators(root_, "actuator");
  const auto common = [&](Element& e, const std::string& name, const Servo& s, double lo,
                          double hi) {
    e.set("name", named(name))
        .set("ctrlrange", {lo, hi})
        .set("forcerange", {-s.force_limit, s.force_limit})
        .set("gaintype", "fixed")
        .set("gainprm", s.kp)
        .set("biastype", "affine")
        .set("biasprm", {0, -s.kp, 0, -s.kv});
  };
  if (detailed()) {
    for (const Disc& disc : levels_) {
      if (disc.upper == a_.c2.name) continue;  // the head's ball joint has servos of its own
      const RangeOfMotion& rom = a_.range_of_motion.at(disc.name);
      const Region region = a_.vertebra(disc.upper).region;
      const char* row = region == Region::kLumbar     ? "lumbar"
                        : region == Region::kThoracic ? "thoracic"
                                                      : "cervical";
      for (const Servo& s : a_.servos) {
        if (s.joint != row) continue;
        const bool flexion = s.motion == "flexion";
        const double hi = rom[flexion                         ? kFlexion
                              : s.motion == "lateral_bending" ? kLateralBending
                                                              : kAxialRotation]
                              .mean;
        Element e(actuators, "general");
        common(e, disc.name + "_" + s.motion, s, flexion ? -rom[kExtension].mean : -hi, hi);
        const Vector3d axis = disc.frame.linear() * s.axis;
        e.set("site", axesSite(bodyOfLevel(a_, disc.upper)))
            .set("refsite", axesSite(bodyOfLevel(a_, disc.lower)))
            .set("gear", {0, 0, 0, axis.x(), axis.y(), axis.z()});
      }
    }
  }
  for (const auto& [body, element] : bodies_) {
    const auto [side, name] = splitSide(body);
    const std::string prefix = body.substr(0, body.size() - name.size());
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      for (const Servo& s : a_.servos) {
        if (s.joint != joint.name) continue;
        const Vector3d axis = side == Side::kRight ? mirrorAxis(s.axis) : s.axis;
        Element e(actuators, "general");
        common(e, prefix + joint.name + "_" + s.motion, s, s.min, s.max);
        e.set("joint", named(prefix + joint.name)).set("gear", axis);
      }
    }
  }
}

// Control 1 is the largest stress of the muscle; a positive force of MuJoCo's would lengthen it.
void Writer::writeMuscleActuators() {
  XMLElement* actuators = root_->FirstChildElement("actuator");
  for (const MuscleLine& line : muscles_) {
    Element(actuators, "general")
        .set("name", named(line.name))
        .set("group", kMuscleGroup)
        .set("tendon", named(line.name))
        .set("ctrlrange", {0, 1})
        .set("gainprm", -line.section * kLargestMuscleStress);
  }
}

void Writer::writeSensors() {
  Element sensors(root_, "sensor");
  // user[0] says what the plugin writes: 0 force, 1 moment, 2 pressure of a disc; 3 ligament
  // tensions, 4 facet forces of a level (mujoco_torso.h).
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

void Writer::writeCustom() {
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

}  // namespace

std::string boneMeshName(const std::string& body, Tissue tissue) {
  return tissue == Tissue::kCartilage ? body + "_cartilage" : body;
}

std::vector<std::string> mjcfBodies(const Anatomy& anatomy, const MjcfOptions& options) {
  std::vector<std::string> bodies = {"pelvis"};
  for (const Vertebra& v : anatomy.vertebrae) bodies.push_back(v.name);
  bodies.push_back("ribcage");
  bodies.push_back("head");
  for (const char* side : {"left_", "right_"}) {
    for (const char* part : {"clavicle", "scapula"}) bodies.push_back(std::string(side) + part);
    if (!options.limbs) continue;
    for (const char* part : {"upper_arm", "lower_arm", "hand", "thigh", "shin", "foot"}) {
      bodies.push_back(std::string(side) + part);
    }
  }
  const auto left_out = [&](const std::string& body) {
    return !options.only.empty() &&
           std::find(options.only.begin(), options.only.end(), body) == options.only.end();
  };
  bodies.erase(std::remove_if(bodies.begin(), bodies.end(), left_out), bodies.end());
  return bodies;
}

void writeMjcf(const Anatomy& anatomy, const MjcfOptions& options,
               tinyxml2::XMLDocument& document) {
  MjcfOptions o = options;
  Anatomy a = anatomy;
  if (o.kind != TorsoKind::kDetailed) a = withWholeShoulder(a);
  if (o.kind == TorsoKind::kSimple) a = withSimpleTrunk(a);
  if (o.height == 0) o.height = -anatomy.landmark("sole").z();
  document.InsertEndChild(document.NewComment(
      " Written by `torso build` from the anatomy tables; edit those, not this file. "));
  tinyxml2::XMLElement* root = document.NewElement("mujoco");
  document.InsertEndChild(root);
  Writer(a, o, root).write();
}

std::string mjcfText(const Anatomy& anatomy, const MjcfOptions& options) {
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace torso::tools
