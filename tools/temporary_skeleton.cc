// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/temporary_skeleton.h"

#include <tinyxml2.h>

#include "model/body.h"
#include "tools/mjcf.h"
#include "tools/simple_trunk.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

class SkeletonWriter {
 public:
  SkeletonWriter(const Anatomy& anatomy, const std::string& meshes,
                 const std::map<std::string, double>& limb_scale)
      : a_(withSimpleTrunk(anatomy)), meshes_(meshes), limb_scale_(limb_scale) {}

  std::string write() {
    XMLElement* root = document_.NewElement("mujoco");
    document_.InsertEndChild(root);
    root->SetAttribute("model", "temporary skeleton");
    Element(root, "compiler").set("autolimits", "true");
    Element visual(root, "visual");
    Element(visual, "headlight").set("ambient", "0.4 0.4 0.4").set("diffuse", "0.5 0.5 0.5");
    asset_ = Element(root, "asset");
    Element world(root, "worldbody");
    XMLElement* pelvis = body(world, "", "pelvis", bodyFrame(a_, "pelvis"));
    XMLElement* abdomen = body(pelvis, "pelvis", "abdomen", bodyFrame(a_, "abdomen"));
    joint(abdomen, "abdomen");
    XMLElement* ribcage = body(abdomen, "abdomen", "ribcage", bodyFrame(a_, "ribcage"));
    stretch(ribcage, "back_length", "L5", "T1");
    joint(ribcage, "ribcage");
    XMLElement* neck = body(ribcage, "ribcage", "neck", bodyFrame(a_, "neck"));
    joint(neck, "neck");
    XMLElement* head = body(neck, "neck", "head", bodyFrame(a_, "head"));
    stretch(head, "neck_length", "T1", "C3");
    joint(head, "head");
    for (const std::string side : {"left_", "right_"}) {
      limb(ribcage, "ribcage", side, {"clavicle", "scapula", "upper_arm", "lower_arm", "hand"});
      limb(pelvis, "pelvis", side, {"thigh", "shin", "foot"});
    }
    for (const Vertebra& v : a_.vertebrae) {  // for the eye only
      const std::string on = simpleTrunkBody(a_, v.name);
      bones(bodies_.at(on), frames_.at(on), v.name);
    }
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  XMLElement* body(XMLElement* parent, const std::string& parent_name, const std::string& name,
                   const Isometry3d& frame) {
    Element element(parent, "body");
    element.set("name", name);
    const Isometry3d X = parent_name.empty() ? frame : frames_.at(parent_name).inverse() * frame;
    element.set("pos", Vector3d(X.translation())).set("quat", Quaterniond(X.linear()));
    if (parent_name.empty()) Element(element, "freejoint").set("name", name);
    // Any will do: only kinematics is used.
    Element(element, "inertial").set("pos", {0, 0, 0}).set("mass", 1).set("diaginertia", {1, 1, 1});
    frames_[name] = frame;
    bodies_[name] = element;
    if (name != "abdomen" && name != "neck") bones(element, frame, name);
    return element;
  }

  // The ball joint that hangs the body of that name on its parent.
  void joint(XMLElement* element, const std::string& body) {
    const auto [side, name] = splitSide(body);
    for (const BallJoint& joint : a_.joints) {
      if (joint.child != name) continue;
      const Vector3d centre = side == Side::kRight ? mirror(joint.position) : joint.position;
      Element(element, "joint")
          .set("name", body.substr(0, body.size() - name.size()) + joint.name)
          .set("type", "ball")
          .set("pos", Vector3d(frames_.at(body).inverse() * centre));
    }
  }

  // How much longer the spine gets as its curves flatten: at most by what its way from vertebra to
  // vertebra is longer than straight.
  void stretch(XMLElement* body, const std::string& name, const std::string& from,
               const std::string& to) {
    double arc = 0;
    const Vector3d first = a_.vertebra(from).position, last = a_.vertebra(to).position;
    Vector3d before = first;
    bool between = false;
    for (const Vertebra& v : a_.vertebrae) {
      if (between) arc += (v.position - before).norm();
      before = v.position;
      between = (between || v.name == from) && v.name != to;
    }
    const double most = arc - (last - first).norm();
    Element(body, "joint")
        .set("name", name)
        .set("type", "slide")
        .set("axis", Vector3d((last - first).normalized()))
        .set("range", {-most, most});
  }

  void limb(XMLElement* parent, std::string parent_name, const std::string& side,
            std::initializer_list<const char*> segments) {
    for (const char* segment : segments) {
      const std::string name = side + segment;
      parent = body(parent, parent_name, name, bodyFrame(a_, name));
      joint(parent, name);
      parent_name = name;
    }
  }

  void bones(XMLElement* element, const Isometry3d& frame, const std::string& body) {
    if (meshes_.empty()) return;
    for (const Tissue tissue : boneTissues(a_, body)) {
      const std::string name = boneMeshName(body, tissue);
      const auto limb = limb_scale_.find(splitSide(body).second);
      const double scale = a_.length_scale * (limb == limb_scale_.end() ? 1 : limb->second);
      Element(asset_, "mesh")
          .set("name", name)
          .set("file", meshes_ + "/" + name + ".stl")
          .set("scale", {scale, scale, scale});
      const Isometry3d X = frame.inverse() * bodyFrame(a_, body);
      Element(element, "geom")
          .set("type", "mesh")
          .set("mesh", name)
          .set("contype", 0)
          .set("conaffinity", 0)
          .set("rgba", {0.89, 0.85, 0.74, 1})
          .set("pos", Vector3d(X.translation()))
          .set("quat", Quaterniond(X.linear()));
    }
  }

  const Anatomy a_;
  const std::string& meshes_;
  const std::map<std::string, double>& limb_scale_;
  tinyxml2::XMLDocument document_;
  XMLElement* asset_ = nullptr;
  std::map<std::string, Isometry3d> frames_;
  std::map<std::string, XMLElement*> bodies_;
};

}  // namespace

std::string temporarySkeletonMjcf(const Anatomy& anatomy, const std::string& meshes,
                                  const std::map<std::string, double>& limb_scale) {
  return SkeletonWriter(anatomy, meshes, limb_scale).write();
}

}  // namespace torso::tools
