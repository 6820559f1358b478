// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <tuple>

#include "model/body.h"
#include "model/bone_mesh.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/graft_host.h"
#include "tools/graft_names.h"
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

constexpr const char* kAssets = "torso_assets";
constexpr const char* kSides[2] = {"left_", "right_"};
constexpr double kMassTolerance = 0.01, kLengthTolerance = 0.02;

std::string text(const XMLElement* e, const char* attribute) {
  const char* value = e->Attribute(attribute);
  return value ? value : "";
}

std::string nameOrTag(const XMLElement* e) {
  const std::string name = text(e, "name");
  return name.empty()
             ? std::string("<") + e->Value() + "> in line " + std::to_string(e->GetLineNum())
             : name;
}

// Numbers of an attribute, `missing` if it is not there.
std::vector<double> numbers(const XMLElement* e, const char* attribute,
                            const std::vector<double>& missing = {}) {
  if (!e->Attribute(attribute)) return missing;
  std::istringstream in(e->Attribute(attribute));
  std::vector<double> values;
  for (double x; in >> x;) values.push_back(x);
  return values;
}

Isometry3d isometry(const Quaterniond& rotation, const Vector3d& position) {
  Isometry3d X(rotation.normalized());
  X.translation() = position;
  return X;
}

// Sets pos and quat, whatever else gave the orientation before.
void setPose(XMLElement* e, const Isometry3d& X) {
  for (const char* other : {"axisangle", "xyaxes", "zaxis", "euler", "fromto"}) {
    e->DeleteAttribute(other);
  }
  e->SetAttribute("pos", mjcfText(Vector3d(X.translation())).c_str());
  const Quaterniond q(X.linear());
  if (q.vec().norm() > 1e-9) {
    e->SetAttribute("quat", mjcfText(q.w() < 0 ? Quaterniond(-q.coeffs()) : q).c_str());
  } else {
    e->DeleteAttribute("quat");
  }
}

void forEachSection(XMLElement* root, const char* name,
                    const std::function<void(XMLElement*)>& visit) {
  for (XMLElement* s = root->FirstChildElement(name); s;) {
    XMLElement* next = s->NextSiblingElement(name);
    visit(s);
    s = next;
  }
}

// The first section of that name, made if there is none.
XMLElement* section(XMLElement* root, const char* name) {
  XMLElement* s = root->FirstChildElement(name);
  return s ? s : static_cast<XMLElement*>(Element(root, name));
}

// The value of an attribute over all sections of that name: the last one counts.
std::string setting(XMLElement* root, const char* name, const char* attribute) {
  std::string value;
  forEachSection(root, name, [&](XMLElement* s) {
    if (s->Attribute(attribute)) value = s->Attribute(attribute);
  });
  return value;
}

void setSetting(XMLElement* root, const char* name, const char* attribute,
                const std::string& value) {
  section(root, name);
  forEachSection(root, name, [&](XMLElement* s) { s->DeleteAttribute(attribute); });
  section(root, name)->SetAttribute(attribute, value.c_str());
}

class Grafter {
 public:
  Grafter(const Anatomy& anatomy, const GraftOptions& options)
      : table_size_(anatomy), o_(options), host_(options.input) {}

  GraftReport run();

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(o_.input + ": " + what); }
  void note(const char* action, const std::string& kind, const std::string& name,
            const std::string& detail) {
    report_.changes.push_back({action, kind, name, detail});
  }

  void fit();
  void checkSettings();
  void isolateDefaults();
  std::string effectiveClass(const XMLElement* e) const;
  void takeLimbs();
  void takeCarried();
  void removeTrunk();
  void dropReferences();
  bool dropReferences(XMLElement* list, const std::string& kind_of_section);
  void takeKeyframes();
  void writeKeyframes(const mjModel* m);
  void writeTorso();
  void adaptTorso();
  void adaptContactBits();
  void renameClashes();
  void hangLimbs();
  XMLElement* firstStatefulActuator() const;
  void merge();
  void mergeSettings();
  void placeFiles(XMLElement* root, const fs::path& folder) const;
  void exclude(const std::string& one, const std::string& two, const char* why);
  void excludeOverlaps(const mjModel* m);
  std::vector<std::pair<std::string, std::string>> boneMeshes() const;
  void check(const mjModel* m);

  std::string ours(const std::string& name) const { return o_.prefix + name; }
  // Name that our body has in the result.
  std::string bodyName(const std::string& body) const;
  // Our body in the place of a removed one.
  std::string replacement(int body) const;
  std::string replacement(const std::string& body) const;
  Isometry3d ourPose(const std::string& body) const { return place_ * bodyFrame(a_, body); }
  XMLElement* ourBody(const std::string& body);

  const Anatomy& table_size_;
  const GraftOptions& o_;
  Host host_;
  HostParts parts_;
  Anatomy a_;          // scaled to the host
  Isometry3d place_;   // of our standing body in the host's world
  XMLDocument torso_;  // ours
  XMLElement* torso_root_ = nullptr;
  XMLElement* kept_ = nullptr;  // parts of the host that will hang on our bodies
  XMLNode* before_ = nullptr;   // element of the worldbody after which the trunk was; or null
  XMLElement* world_ = nullptr;
  std::array<XMLElement*, 4> limbs_{};                        // thighs, upper arms; left, right
  std::vector<std::pair<XMLElement*, std::string>> carried_;  // camera, light or site; our body
  XMLElement* keyframes_ = nullptr;
  std::set<MjcfName> removed_;
  std::set<std::pair<std::string, std::string>> excluded_;
  GraftReport report_{};
};

// Scale and place of our torso.
void Grafter::fit() {
  const mjModel* m = host_.model.get();
  const auto& [hip, shoulder] = std::tie(parts_.hip, parts_.shoulder);
  const auto pair = [](const Vector3d& left) {
    return std::array<Vector3d, 2>{left, torso::mirror(left)};
  };
  const auto our_hip = pair(table_size_.landmark("hip_joint_centre"));
  const auto our_shoulder = pair(table_size_.landmark("glenohumeral_centre_GH"));
  const auto distance = [](const auto& h, const auto& s) {
    return 0.5 * (s[0] + s[1] - h[0] - h[1]).norm();
  };
  report_.hip_to_shoulder_before = distance(hip, shoulder);
  report_.length_scale = report_.hip_to_shoulder_before / distance(our_hip, our_shoulder);

  double removed = 0, made = 0;
  for (const auto& [body, part] : parts_.trunk) removed += m->body_mass[body];
  for (const std::string& body : mjcfBodies(table_size_, MjcfOptions())) {
    made += bodyInertial(table_size_, body).mass;
  }
  if (removed <= 0) fail("the trunk has no mass");
  report_.mass_scale = removed / made;
  report_.mass_before = mj_getTotalmass(m);
  a_ = table_size_.scaled(report_.length_scale, report_.mass_scale);

  const Matrix3d R = trunkAxes(hip, shoulder) * trunkAxes(our_hip, our_shoulder).transpose();
  place_ = isometry(Quaterniond(R), Vector3d::Zero());
  place_.translation() =
      0.5 * (hip[0] + hip[1]) - R * (report_.length_scale * 0.5 * (our_hip[0] + our_hip[1]));
  report_.parts = parts_.notes;
}

void Grafter::checkSettings() {
  if (setting(host_.root, "compiler", "coordinate") == "global") {
    fail(
        "<compiler coordinate=\"global\"> is not supported; save the model with MuJoCo first, "
        "which writes local coordinates");
  }
  forEachSection(host_.root, "custom", [&](XMLElement* s) {
    for (XMLElement* e = s->FirstChildElement("numeric"); e; e = e->NextSiblingElement("numeric")) {
      if (text(e, "name") == ours("mujoco_torso")) {
        fail("it has a torso of ours already; give a second one a --prefix");
      }
    }
  });
}

std::string Grafter::bodyName(const std::string& body) const {
  std::string name = ours(body);
  while (mj_name2id(host_.model.get(), mjOBJ_BODY, name.c_str()) > 0 &&
         !removed_.count({"body", name})) {
    name = "torso_" + name;  // as renameClashes does
  }
  return name;
}

std::string Grafter::replacement(int body) const {
  const auto nearest = [&](Region region) {
    const Vector3d com(host_.data->xipos[3 * body], host_.data->xipos[3 * body + 1],
                       host_.data->xipos[3 * body + 2]);
    const Vector3d local = place_.inverse() * com;
    const Vertebra* best = nullptr;
    for (const Vertebra& v : a_.vertebrae) {
      if (v.region != region) continue;
      if (!best || std::abs(v.position.z() - local.z()) < std::abs(best->position.z() - local.z()))
        best = &v;
    }
    return best->name;
  };
  switch (parts_.trunk.at(body)) {
    case TrunkPart::kPelvis:
      return "pelvis";
    case TrunkPart::kWaist:
      return nearest(Region::kLumbar);
    case TrunkPart::kChest:
      return "ribcage";
    case TrunkPart::kNeck:
      return nearest(Region::kCervical);
    case TrunkPart::kHead:
      return "head";
    case TrunkPart::kLeftClavicle:
      return "left_clavicle";
    case TrunkPart::kRightClavicle:
      return "right_clavicle";
  }
  return "";
}

std::string Grafter::replacement(const std::string& body) const {
  for (const auto& [id, part] : parts_.trunk) {
    if (host_.bodyName(id) == body) return replacement(id);
  }
  return "";
}

// ---- defaults ----

// Kinds of objects that have a class attribute.
const std::set<std::string> kClassed = {"geom",     "site", "camera",   "light",  "mesh",
                                        "material", "pair", "equality", "tendon", "actuator"};

// Our elements would inherit what the host sets in its main default class. So that becomes a class
// of its own, named in every element of the host that used it, and the main class is MuJoCo's.
void Grafter::isolateDefaults() {
  bool used = false;
  std::set<std::string> main_names = {"main"};
  std::set<std::string> classes;
  forEachSection(host_.root, "default", [&](XMLElement* s) {
    if (s->Attribute("class")) main_names.insert(s->Attribute("class"));
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      used |= e->Value() != std::string("default");
    }
    visitNames(s, [&](XMLElement* e, const char* a, const std::string&, bool) {
      classes.insert(e->Attribute(a));
    });
  });
  if (!used) return;
  std::string name = "humanoid";
  while (classes.count(name)) name += "_main";
  XMLElement* top = host_.document.NewElement("default");
  XMLElement* host_main = Element(top, "default").set("class", name);
  XMLElement* first = host_.root->FirstChildElement("default");
  host_.root->InsertAfterChild(first, top);
  forEachSection(host_.root, "default", [&](XMLElement* s) {
    if (s == top) return;
    while (XMLNode* child = s->FirstChild()) host_main->InsertEndChild(child);
    host_.root->DeleteChild(s);
  });
  for (XMLElement* s = host_.root->FirstChildElement(); s; s = s->NextSiblingElement()) {
    if (s == top) continue;
    visitNames(s, [&](XMLElement* e, const char* a, const std::string& kind, bool) {
      if (kind == "class" && main_names.count(e->Attribute(a))) e->SetAttribute(a, name.c_str());
    });
    const std::string tag = s->Value();
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = definedKind(e, tag);
      const bool is_body = kind == "body";
      const char* attribute = is_body ? "childclass" : "class";
      if ((is_body || kClassed.count(kind)) && !e->Attribute(attribute)) {
        e->SetAttribute(attribute, name.c_str());
      }
    }
  }
  note("changed", "default", name,
       "the humanoid's main default class is now this class, named where it applied, so that it "
       "does not reach into the torso");
}

std::string Grafter::effectiveClass(const XMLElement* e) const {
  for (const XMLNode* n = e; n && n->ToElement(); n = n->Parent()) {
    const char* name = n->ToElement()->Attribute("childclass");
    if (name) return name;
  }
  return "";
}

// ---- what stays of the humanoid ----

void Grafter::takeLimbs() {
  world_ = nullptr;
  XMLElement* trunk = host_.bodies[parts_.root];
  world_ = trunk->Parent()->ToElement();
  before_ = trunk->PreviousSibling();
  kept_ = Element(host_.root, "worldbody");
  const std::array<int, 4> ids = {parts_.thigh[0], parts_.thigh[1], parts_.upper_arm[0],
                                  parts_.upper_arm[1]};
  // In the order of the file.
  std::array<int, 4> order = {0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return ids[a] < ids[b]; });
  for (int k : order) {
    XMLElement* limb = host_.bodies[ids[k]];
    const std::string c = effectiveClass(limb);
    if (!c.empty()) limb->SetAttribute("childclass", c.c_str());
    if (text(limb, "name").empty()) fail("an upper arm or thigh has no name");
    kept_->InsertEndChild(limb);
    limbs_[k] = limb;
  }
}

// Cameras, lights and sites of the trunk, to be carried by ours at the same place.
void Grafter::takeCarried() {
  const mjModel* m = host_.model.get();
  for (const auto& [body, part] : parts_.trunk) {
    XMLElement* element = host_.bodies[body];
    const std::string c = effectiveClass(element);
    const std::string onto = replacement(body);
    const Isometry3d shift = ourPose(onto).inverse() * host_.pose(body);
    const auto take = [&](const char* tag, int count, const int* owner, const auto& place) {
      int id = 0;
      for (XMLElement* e = element->FirstChildElement(tag); e;) {
        XMLElement* next = e->NextSiblingElement(tag);
        while (id < count && owner[id] != body) id++;
        place(e, id++);
        if (!c.empty() && !e->Attribute("class")) e->SetAttribute("class", c.c_str());
        kept_->InsertEndChild(e);
        carried_.emplace_back(e, onto);
        note("moved", tag, nameOrTag(e),
             fmt::format("from body '{}' to '{}'", host_.bodyName(body), ours(onto)));
        e = next;
      }
    };
    const auto pose = [&](const mjtNum* pos, const mjtNum* quat, int id) {
      return Isometry3d(
          shift * isometry({quat[4 * id], quat[4 * id + 1], quat[4 * id + 2], quat[4 * id + 3]},
                           {pos[3 * id], pos[3 * id + 1], pos[3 * id + 2]}));
    };
    take("camera", m->ncam, m->cam_bodyid,
         [&](XMLElement* e, int id) { setPose(e, pose(m->cam_pos, m->cam_quat, id)); });
    take("light", m->nlight, m->light_bodyid, [&](XMLElement* e, int id) {
      const mjtNum *p = m->light_pos + 3 * id, *d = m->light_dir + 3 * id;
      e->SetAttribute("pos", mjcfText(shift * Vector3d(p[0], p[1], p[2])).c_str());
      e->SetAttribute("dir",
                      mjcfText(Vector3d(shift.linear() * Vector3d(d[0], d[1], d[2]))).c_str());
    });
    take("site", m->nsite, m->site_bodyid, [&](XMLElement* e, int id) {
      if (e->Attribute("fromto")) {
        const mjtNum* size = m->site_size + 3 * id;
        e->SetAttribute("size", mjcfText({size[0], size[1], size[2]}).c_str());
      }
      setPose(e, pose(m->site_pos, m->site_quat, id));
    });
  }
}

void Grafter::removeTrunk() {
  const mjModel* m = host_.model.get();
  const Matrix3d axes = place_.linear();
  for (const auto& [body, part] : parts_.trunk) {
    note("replaced", "body", host_.bodyName(body),
         fmt::format("{:.3f} kg, by '{}'", m->body_mass[body], ours(replacement(body))));
    if (body == parts_.root && m->body_jntnum[body] == 0) {
      note("changed", "body", host_.bodyName(body),
           "was fixed to the world; '" + ours("pelvis") + "' is free");
    }
    for (int j = m->body_jntadr[body]; j >= 0 && j < m->body_jntadr[body] + m->body_jntnum[body];
         j++) {
      std::string by = "by the joints of the spine";
      if (body == parts_.root) {
        by = "by the free joint '" + ours("pelvis") + "'";
      } else if (m->jnt_type[j] == mjJNT_HINGE) {
        const mjtNum* a = host_.data->xaxis + 3 * j;
        const Vector3d local = (axes.transpose() * Vector3d(a[0], a[1], a[2])).cwiseAbs();
        const char* motion = local.y() > std::max(local.x(), local.z()) ? "flexion"
                             : local.x() > local.z()                    ? "lateral_bending"
                                                                        : "axial_rotation";
        const TrunkPart p = parts_.trunk.at(body);
        const bool high = p == TrunkPart::kNeck || p == TrunkPart::kHead;
        by = p == TrunkPart::kLeftClavicle || p == TrunkPart::kRightClavicle
                 ? "by the servos of the sternoclavicular and acromioclavicular joints"
                 : fmt::format("by the servos '{}_{}' ... '{}_{}'", ours(high ? "C6/C7" : "L5/S1"),
                               motion, ours(high ? "C3/C4" : "T12/L1"), motion);
      }
      note("replaced", "joint", nameOf(m, mjOBJ_JOINT, j), by);
    }
    for (int g = m->body_geomadr[body]; g >= 0 && g < m->body_geomadr[body] + m->body_geomnum[body];
         g++) {
      note("removed", "geom", nameOf(m, mjOBJ_GEOM, g), "on body '" + host_.bodyName(body) + "'");
    }
  }
  XMLElement* trunk = host_.bodies[parts_.root];
  XMLElement* aside = Element(host_.root, "worldbody");
  aside->InsertEndChild(trunk);
  visitNames(aside, [&](XMLElement* e, const char* a, const std::string& kind, bool d) {
    if (d) removed_.emplace(kind, e->Attribute(a));
  });
  host_.root->DeleteChild(aside);
}

// True if it removed something that has a name.
bool Grafter::dropReferences(XMLElement* list, const std::string& tag) {
  bool named = false;
  for (XMLElement* e = list->FirstChildElement(); e;) {
    XMLElement* next = e->NextSiblingElement();
    std::string missing;
    XMLElement* holder = Element(host_.root, tag.c_str());
    XMLNode* previous = e->PreviousSibling();
    holder->InsertEndChild(e);
    visitNames(holder, [&](XMLElement* r, const char* a, const std::string& kind, bool defines) {
      const std::string name = r->Attribute(a);
      if (defines || !removed_.count({kind, name})) return;
      const std::string attribute = a;
      if (kind == "body" && (attribute == "target" || tag == "sensor" || tag == "custom")) {
        const std::string by = bodyName(replacement(name));
        r->SetAttribute(a, by.c_str());
        const bool subtree = std::string(e->Value()).rfind("subtree", 0) == 0;
        note("changed", tag == "worldbody" ? e->Value() : tag, nameOrTag(e),
             fmt::format("{} '{}' is now '{}'{}", attribute, name, by,
                         subtree ? ", and so no longer all the body" : ""));
        return;
      }
      missing += fmt::format("{}{} '{}'", missing.empty() ? "" : ", ", kind, name);
    });
    if (previous) {
      list->InsertAfterChild(previous, e);
    } else {
      list->InsertFirstChild(e);
    }
    host_.root->DeleteChild(holder);
    if (!missing.empty()) {
      const std::string kind = definedKind(e, tag);
      std::string detail = "refers to the removed " + missing;
      for (GraftChange& c : report_.changes) {
        if (tag == "actuator" && c.kind == "joint" && c.action == "replaced" &&
            c.name == text(e, "joint")) {
          detail += ", replaced " + c.detail;
        }
      }
      note("removed", kind.empty() ? tag : kind, nameOrTag(e), detail);
      if (e->Attribute("name")) named |= removed_.emplace(kind, e->Attribute("name")).second;
      list->DeleteChild(e);
    }
    e = next;
  }
  return named;
}

void Grafter::dropReferences() {
  for (bool again = true; again;) {
    again = false;
    for (const char* tag :
         {"worldbody", "asset", "contact", "equality", "tendon", "actuator", "sensor", "custom"}) {
      forEachSection(host_.root, tag, [&](XMLElement* s) { again |= dropReferences(s, tag); });
    }
  }
}

// Their numbers wait until MuJoCo has laid out the new coordinates.
void Grafter::takeKeyframes() {
  keyframes_ = Element(host_.root, "keyframe");
  forEachSection(host_.root, "keyframe", [&](XMLElement* s) {
    while (s != keyframes_ && s->FirstChild()) keyframes_->InsertEndChild(s->FirstChild());
    if (s != keyframes_) host_.root->DeleteChild(s);
  });
  for (XMLElement* e = keyframes_->FirstChildElement(); e; e = e->NextSiblingElement()) {
    for (const char* attribute : {"qpos", "qvel", "act", "ctrl"}) e->DeleteAttribute(attribute);
    note("changed", "key", nameOrTag(e),
         "limbs as they were; the torso in its shape at rest, moving with the pelvis; controls of "
         "actuators without a name are 0");
  }
  if (keyframes_->NoChildren()) {
    host_.root->DeleteChild(keyframes_);
    keyframes_ = nullptr;
  }
}

void Grafter::writeKeyframes(const mjModel* m) {
  if (!keyframes_) return;
  const mjModel* h = host_.model.get();
  const DataPtr d = makeData(h);
  const auto pelvis = std::find_if(parts_.trunk.begin(), parts_.trunk.end(), [&](const auto& p) {
    return p.second == TrunkPart::kPelvis && host_.isBelow(parts_.thigh[0], p.first);
  });
  // A single rigid trunk is pelvis and chest.
  const int root = pelvis == parts_.trunk.end() ? parts_.root : pelvis->first;
  const auto theirs = [&](mjtObj type, const char* kind, int id) {
    const char* name = mj_id2name(m, type, id);
    return !name || removed_.count({kind, name}) ? -1 : mj_name2id(h, type, name);
  };
  const auto join = [](const std::vector<double>& values) {
    std::string joined;
    for (double x : values) joined += (joined.empty() ? "" : " ") + mjcfNumber(x);
    return joined;
  };
  const int coordinates[] = {7, 4, 1, 1}, speeds[] = {6, 3, 1, 1};  // by joint type
  XMLElement* e = keyframes_->FirstChildElement("key");
  for (int k = 0; k < h->nkey && e; k++, e = e->NextSiblingElement("key")) {
    mju_copy(d->qpos, h->key_qpos + k * h->nq, h->nq);
    mju_copy(d->qvel, h->key_qvel + k * h->nv, h->nv);
    mj_fwdPosition(h, d.get());
    mj_fwdVelocity(h, d.get());
    const mjtNum *p = d->xpos + 3 * root, *q = d->xquat + 4 * root;
    const Isometry3d move =
        isometry({q[0], q[1], q[2], q[3]}, {p[0], p[1], p[2]}) * host_.pose(root).inverse();
    mjtNum velocity[6];  // of the pelvis, at its origin, axes of the world
    mj_objectVelocity(h, d.get(), mjOBJ_XBODY, root, velocity, 0);
    const Vector3d angular(velocity[0], velocity[1], velocity[2]);
    const Vector3d linear(velocity[3], velocity[4], velocity[5]);

    std::vector<double> qpos(m->qpos0, m->qpos0 + m->nq), qvel(m->nv, 0), ctrl(m->nu, 0),
        act(m->na, 0);
    for (int j = 0; j < m->njnt; j++) {
      const int type = m->jnt_type[j], to = m->jnt_qposadr[j], dof = m->jnt_dofadr[j];
      int from = theirs(mjOBJ_JOINT, "joint", j);
      const int body = m->jnt_bodyid[j], body_from = theirs(mjOBJ_BODY, "body", body);
      if (from < 0 && body_from > 0) {  // a joint without a name
        from = h->body_jntadr[body_from] + j - m->body_jntadr[body];
      }
      if (from >= 0) {
        std::copy_n(h->key_qpos + k * h->nq + h->jnt_qposadr[from], coordinates[type], &qpos[to]);
        std::copy_n(h->key_qvel + k * h->nv + h->jnt_dofadr[from], speeds[type], &qvel[dof]);
      } else if (type == mjJNT_FREE) {
        const Isometry3d X =
            move * isometry({qpos[to + 3], qpos[to + 4], qpos[to + 5], qpos[to + 6]},
                            {qpos[to], qpos[to + 1], qpos[to + 2]});
        const Quaterniond rotation(X.linear());
        const Vector3d v = linear + angular.cross(X.translation() - Vector3d(p[0], p[1], p[2]));
        const Vector3d w = X.linear().transpose() * angular;
        const double pose[7] = {X.translation().x(), X.translation().y(), X.translation().z(),
                                rotation.w(),        rotation.x(),        rotation.y(),
                                rotation.z()};
        std::copy_n(pose, 7, &qpos[to]);
        std::copy_n(v.data(), 3, &qvel[dof]);
        std::copy_n(w.data(), 3, &qvel[dof + 3]);
      }
    }
    for (int u = 0; u < m->nu; u++) {
      const int from = theirs(mjOBJ_ACTUATOR, "actuator", u);
      if (from < 0) continue;  // ours, or without a name
      ctrl[u] = h->key_ctrl[k * h->nu + from];
      // Activations are those of the last na actuators.
      const int a = u - (m->nu - m->na), a_from = from - (h->nu - h->na);
      if (a >= 0 && a_from >= 0) act[a] = h->key_act[k * h->na + a_from];
    }
    e->SetAttribute("qpos", join(qpos).c_str());
    e->SetAttribute("qvel", join(qvel).c_str());
    e->SetAttribute("ctrl", join(ctrl).c_str());
    if (m->na) e->SetAttribute("act", join(act).c_str());
  }
}

// ---- our torso ----

void Grafter::writeTorso() {
  MjcfOptions mjcf;
  mjcf.prefix = o_.prefix;
  mjcf.mesh_scale = report_.length_scale;
  mjcf.mesh_dir = kAssets;
  mjcf.height = 1;  // any but 0, for the standing height; taken off again in adaptTorso
  writeMjcf(a_, mjcf, torso_);
  torso_root_ = torso_.RootElement();
  adaptTorso();
  adaptContactBits();
}

XMLElement* Grafter::ourBody(const std::string& name) {
  std::function<XMLElement*(XMLElement*)> find = [&](XMLElement* parent) -> XMLElement* {
    for (XMLElement* e = parent->FirstChildElement("body"); e; e = e->NextSiblingElement("body")) {
      if (text(e, "name") == ours(name)) return e;
      if (XMLElement* below = find(e)) return below;
    }
    return nullptr;
  };
  return find(torso_root_->FirstChildElement("worldbody"));
}

// Where it stands, and what its own file's compiler settings meant.
void Grafter::adaptTorso() {
  XMLElement* world = torso_root_->FirstChildElement("worldbody");
  for (XMLElement* body = world->FirstChildElement("body"); body;
       body = body->NextSiblingElement("body")) {
    const std::string name = text(body, "name").substr(o_.prefix.size());
    setPose(body, ourPose(name));
  }
  const bool radian = setting(host_.root, "compiler", "angle") == "radian";
  std::function<void(XMLElement*)> joints = [&](XMLElement* parent) {
    for (XMLElement* e = parent->FirstChildElement(); e; e = e->NextSiblingElement()) {
      joints(e);
      if (e->Value() != std::string("joint") || !e->Attribute("range")) continue;
      e->SetAttribute("limited", "true");
      if (!radian) continue;
      const std::vector<double> range = numbers(e, "range");
      e->SetAttribute("range", mjcfText({range[0], range[1] * M_PI / 180}).c_str());
    }
  };
  joints(world);
  for (XMLElement* c = torso_root_->FirstChildElement("default")->FirstChildElement("default"); c;
       c = c->NextSiblingElement("default")) {
    for (XMLElement* e = c->FirstChildElement("tendon"); e; e = e->NextSiblingElement("tendon")) {
      e->SetAttribute("limited", "true");
    }
  }
  XMLElement* actuators = torso_root_->FirstChildElement("actuator");
  for (XMLElement* e = actuators->FirstChildElement(); e; e = e->NextSiblingElement()) {
    e->SetAttribute("ctrllimited", "true");
    e->SetAttribute("forcelimited", "true");
  }
  // Arms in the humanoid's order.
  if (parts_.upper_arm[1] < parts_.upper_arm[0]) {
    XMLElement* left = ourBody("left_clavicle");
    XMLElement* right = ourBody("right_clavicle");
    XMLNode* cage = left->Parent();
    XMLNode* previous = left->PreviousSibling();
    if (previous) {
      cage->InsertAfterChild(previous, right);
    } else {
      cage->InsertFirstChild(right);
    }
  }
}

// Ours meets what the humanoid's trunk met. As in the torso's own file, spine and trunk have no
// contype; trunk and head also have one bit for the head to meet the trunk.
void Grafter::adaptContactBits() {
  const mjModel* m = host_.model.get();
  int world_bits = 0, used = 0;
  std::set<int> unmet;
  for (int g = 0; g < m->ngeom; g++) {
    used |= m->geom_contype[g] | m->geom_conaffinity[g];
    if (parts_.trunk.count(m->geom_bodyid[g])) continue;
    for (const auto& [body, part] : parts_.trunk) {
      for (int t = m->body_geomadr[body];
           t >= 0 && t < m->body_geomadr[body] + m->body_geomnum[body]; t++) {
        if (m->geom_contype[g] & m->geom_conaffinity[t]) {
          world_bits |= m->geom_contype[g];
        } else if (m->geom_contype[t] & m->geom_conaffinity[g]) {
          unmet.insert(g);
        }
      }
    }
  }
  int own_bit = 2;
  while (own_bit & used) own_bit *= 2;
  for (int g : unmet) {
    if (m->geom_contype[g] & world_bits) continue;
    note("changed", "geom", nameOf(m, mjOBJ_GEOM, g),
         "no longer meets the torso: its contype is not among those that the torso answers to");
  }
  for (XMLElement* c = torso_root_->FirstChildElement("default")->FirstChildElement("default"); c;
       c = c->NextSiblingElement("default")) {
    const std::string name = text(c, "class").substr(o_.prefix.size());
    XMLElement* geom = c->FirstChildElement("geom");
    if (name == "spine" || name == "trunk" || name == "limb") {
      geom->SetAttribute("contype", name == "limb" ? own_bit : 0);
      geom->SetAttribute("conaffinity", name == "spine" ? world_bits : world_bits | own_bit);
    }
  }
}

// Ours gives way where both have an object of one kind and name.
void Grafter::renameClashes() {
  const std::set<MjcfName> theirs = definedNames(host_.root), own = definedNames(torso_root_);
  std::map<MjcfName, std::string> renamed;
  for (const MjcfName& n : own) {
    if (!theirs.count(n) && !(n.first == "class" && n.second == "main")) continue;
    std::string name = "torso_" + n.second;
    while (theirs.count({n.first, name}) || own.count({n.first, name})) name = "torso_" + name;
    renamed[n] = name;
    note("renamed", n.first, n.second, "the torso's own is now '" + name + "'");
  }
  if (renamed.empty()) return;
  for (XMLElement* s = torso_root_->FirstChildElement(); s; s = s->NextSiblingElement()) {
    visitNames(s, [&](XMLElement* e, const char* a, const std::string& kind, bool) {
      const auto found = renamed.find({kind, e->Attribute(a)});
      if (found != renamed.end()) e->SetAttribute(a, found->second.c_str());
    });
  }
}

void Grafter::hangLimbs() {
  // Elements of our bodies, before renaming: by name.
  std::array<XMLElement*, 4> onto{};
  for (int k = 0; k < 2; k++) {
    onto[k] = ourBody("pelvis");
    onto[2 + k] = ourBody(std::string(kSides[k]) + "scapula");
  }
  std::vector<XMLElement*> carriers;
  for (const auto& [element, body] : carried_) carriers.push_back(ourBody(body));
  renameClashes();

  std::vector<std::pair<int, int>> order;  // by place in the file
  for (int k = 0; k < 2; k++) {
    order.emplace_back(parts_.thigh[k], k);
    order.emplace_back(parts_.upper_arm[k], 2 + k);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [id, k] : order) {
    Isometry3d world = host_.pose(id);
    std::string parent = "pelvis";
    if (k >= 2) {
      parent = std::string(kSides[k - 2]) + "scapula";
      const Vector3d left = a_.landmark("glenohumeral_centre_GH");
      const Vector3d socket = place_ * (k == 2 ? left : torso::mirror(left));
      world.translation() += socket - parts_.shoulder[k - 2];
    }
    XMLElement* limb = onto[k]->InsertEndChild(limbs_[k]->DeepClone(&torso_))->ToElement();
    setPose(limb, ourPose(parent).inverse() * world);
    note("moved", "body", text(limb, "name"),
         fmt::format(
             "with all that hangs on it, now on '{}'{}", text(onto[k], "name"),
             k < 2
                 ? ", its place unchanged"
                 : fmt::format(", {:.0f} mm from where it was",
                               1e3 * (world.translation() - host_.pose(id).translation()).norm())));
  }
  for (std::size_t i = 0; i < carried_.size(); i++) {
    carriers[i]->InsertEndChild(carried_[i].first->DeepClone(&torso_));
  }
  host_.root->DeleteChild(kept_);
  kept_ = nullptr;
}

// ---- one document ----

void Grafter::mergeSettings() {
  XMLElement* root = host_.root;
  const auto change = [&](const char* tag, const char* attribute, const std::string& value) {
    const std::string before = setting(root, tag, attribute);
    if (before == value) return;
    setSetting(root, tag, attribute, value);
    note("changed", tag, attribute,
         fmt::format("{} -> {}", before.empty() ? "default" : before, value));
  };
  XMLElement* option = torso_root_->FirstChildElement("option");
  const double step = numbers(option, "timestep").at(0);
  if (host_.model->opt.timestep > step) change("option", "timestep", text(option, "timestep"));
  change("option", "solver", text(option, "solver"));
  change("option", "jacobian", text(option, "jacobian"));
  // The plugin's rows are unknown to noslip; facets are contact pairs.
  if (host_.model->opt.noslip_iterations > 0) change("option", "noslip_iterations", "0");
  if (host_.model->opt.collision == mjCOL_DYNAMIC) change("option", "collision", "all");

  XMLElement* size = torso_root_->FirstChildElement("size");
  for (const auto* a = size->FirstAttribute(); a; a = a->Next()) {
    const std::string name = a->Name();
    const int own = a->IntValue();
    const std::string before = setting(root, "size", a->Name());
    const int theirs = before.empty() ? 0 : std::max(0, std::atoi(before.c_str()));
    if (name == "nuserdata") {
      XMLElement* custom = torso_root_->FirstChildElement("custom");
      for (XMLElement* e = custom->FirstChildElement("numeric"); e;
           e = e->NextSiblingElement("numeric")) {
        if (text(e, "name") != ours("mujoco_torso")) continue;
        const double format = std::atof(e->Attribute("data"));
        e->SetAttribute("data", mjcfText({format, 0, static_cast<double>(theirs)}).c_str());
      }
    }
    const bool sum = name == "njmax" || name == "nconmax" || name == "nuserdata";
    change("size", a->Name(), std::to_string(sum ? own + theirs : std::max(own, theirs)));
  }
  if (setting(root, "compiler", "inertiafromgeom") == "true") {
    change("compiler", "inertiafromgeom", "auto");
    std::function<void(XMLElement*)> clean = [&](XMLElement* parent) {
      for (XMLElement* e = parent->FirstChildElement("body"); e;
           e = e->NextSiblingElement("body")) {
        clean(e);
        // Ours have no geom with a mass, theirs never used it.
        XMLElement* inertial = e->FirstChildElement("inertial");
        if (!inertial) continue;
        e->DeleteChild(inertial);
        note("removed", "inertial", text(e, "name"), "inertiafromgeom had overridden it");
      }
    };
    forEachSection(root, "worldbody", clean);
    for (int k = 0; k < 4; k++) clean(limbs_[k]);
  }
}

// MuJoCo wants actuators without activation, as ours, before those with.
XMLElement* Grafter::firstStatefulActuator() const {
  const mjModel* m = host_.model.get();
  XMLElement* first = nullptr;
  forEachSection(host_.root, "actuator", [&](XMLElement* s) {
    for (XMLElement* e = s->FirstChildElement(); e && !first; e = e->NextSiblingElement()) {
      const int id = mj_name2id(m, mjOBJ_ACTUATOR, text(e, "name").c_str());
      if (id >= 0 && m->actuator_dyntype[id] != mjDYN_NONE) first = e;
    }
  });
  return first;
}

void Grafter::merge() {
  XMLElement* root = host_.root;
  for (XMLElement* s = torso_root_->FirstChildElement(); s; s = s->NextSiblingElement()) {
    const std::string tag = s->Value();
    if (tag == "compiler" || tag == "option" || tag == "size") continue;
    if (tag == "worldbody") {
      XMLNode* last = before_;
      for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
        XMLNode* clone = e->DeepClone(&host_.document);
        last = last ? world_->InsertAfterChild(last, clone) : world_->InsertFirstChild(clone);
      }
      continue;
    }
    XMLElement* into = section(root, tag.c_str());
    XMLNode* last = into->LastChild();
    if (XMLElement* stateful = tag == "actuator" ? firstStatefulActuator() : nullptr) {
      into = stateful->Parent()->ToElement();
      last = stateful->PreviousSibling();
    }
    for (XMLElement* e = s->FirstChildElement(); e; e = e->NextSiblingElement()) {
      XMLNode* clone = e->DeepClone(&host_.document);
      last = last ? into->InsertAfterChild(last, clone) : into->InsertFirstChild(clone);
    }
  }
  XMLNode* comment = host_.document.NewComment(
      fmt::format(" Made by `torso graft` from {}: the torso of mujoco-torso in the place of its "
                  "trunk. ",
                  fs::path(o_.input).filename().string())
          .c_str());
  XMLNode* first = host_.document.FirstChild();
  if (first->ToDeclaration()) {
    host_.document.InsertAfterChild(first, comment);
  } else {
    host_.document.InsertFirstChild(comment);
  }
}

// File names relative to the folder that the MJCF will be in.
void Grafter::placeFiles(XMLElement* root, const fs::path& folder) const {
  const fs::path target = fs::absolute(folder).lexically_normal();
  const bool strip = setting(root, "compiler", "strippath") == "true";
  const auto directory = [&](const char* attribute) {
    const fs::path there = fs::path(host_.folder) / setting(root, "compiler", attribute);
    return fs::path(there).lexically_normal();
  };
  const fs::path meshes = directory("meshdir"), textures = directory("texturedir");
  bool mesh_files = false, texture_files = false;
  forEachSection(root, "asset", [&](XMLElement* asset) {
    for (XMLElement* e = asset->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string tag = e->Value();
      for (const char* attribute :
           {"file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback"}) {
        const std::string file = text(e, attribute);
        if (file.empty() || file.rfind(std::string(kAssets) + "/", 0) == 0) continue;
        if (strip) e->SetAttribute(attribute, fs::path(file).filename().c_str());
        (tag == "texture" ? texture_files : mesh_files) = true;
      }
    }
  });
  fs::path mesh_folder = target;
  if (strip) setSetting(root, "compiler", "strippath", "false");
  if (mesh_files || !setting(root, "compiler", "meshdir").empty()) {
    mesh_folder = meshes;
    const std::string relative = meshes.lexically_relative(target).string();
    if (relative != ".") setSetting(root, "compiler", "meshdir", relative);
  }
  if (texture_files) {
    const std::string relative = textures.lexically_relative(target).string();
    if (relative != ".") setSetting(root, "compiler", "texturedir", relative);
  }
  const std::string assets = (target / kAssets).lexically_relative(mesh_folder).string();
  forEachSection(root, "asset", [&](XMLElement* asset) {
    for (XMLElement* e = asset->FirstChildElement("mesh"); e; e = e->NextSiblingElement("mesh")) {
      const std::string file = text(e, "file");
      if (file.rfind(std::string(kAssets) + "/", 0) != 0) continue;
      e->SetAttribute("file", (fs::path(assets) / fs::path(file).filename()).c_str());
    }
  });
}

// ---- contacts at rest ----

void Grafter::exclude(const std::string& one, const std::string& two, const char* why) {
  if (!excluded_.insert(std::minmax(one, two)).second) return;
  XMLElement* contact = section(host_.root, "contact");
  Element(contact, "exclude").set("body1", one).set("body2", two);
  note("added", "exclude", one + ", " + two, why);
}

void Grafter::excludeOverlaps(const mjModel* m) {
  const DataPtr d = makeData(m);
  mj_fwdPosition(m, d.get());
  for (int i = 0; i < d->ncon; i++) {
    const int g1 = d->contact[i].geom1, g2 = d->contact[i].geom2;
    const int b1 = m->geom_bodyid[g1], b2 = m->geom_bodyid[g2];
    const bool by_bits = (m->geom_contype[g1] & m->geom_conaffinity[g2]) ||
                         (m->geom_contype[g2] & m->geom_conaffinity[g1]);
    if (!by_bits || b1 == 0 || b2 == 0) continue;  // a contact pair, or with the surroundings
    const std::string one = nameOf(m, mjOBJ_BODY, b1), two = nameOf(m, mjOBJ_BODY, b2);
    const auto theirs = [&](const std::string& name) {
      return mj_name2id(host_.model.get(), mjOBJ_BODY, name.c_str()) > 0 &&
             !removed_.count({"body", name});
    };
    if (theirs(one) && theirs(two)) continue;
    exclude(one, two, "they touch in the pose qpos0");
  }
}

// ---- result ----

struct TemporaryFolder {
  std::string path = (fs::temp_directory_path() / "torso_graft_XXXXXX").string();
  TemporaryFolder() {
    if (!mkdtemp(path.data())) throw Error(path + ": cannot make a temporary folder");
  }
  ~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
};

void writeResult(const XMLDocument& document, const std::string& path,
                 const std::function<void(XMLElement*, const fs::path&)>& place,
                 const std::vector<std::pair<std::string, std::string>>& meshes) {
  XMLDocument placed;
  document.DeepCopy(&placed);
  fs::path folder = fs::absolute(path).parent_path();
  place(placed.RootElement(), folder);
  if (!fs::is_directory(folder)) throw Error(path + ": cannot write: no such folder");
  if (fs::is_directory(path)) throw Error(path + ": cannot write: this is a folder");
  makeFolder((folder / kAssets).string());
  for (const auto& [name, content] : meshes) writeFile((folder / kAssets / name).string(), content);
  tinyxml2::XMLPrinter printer;
  placed.Print(&printer);
  writeFile(path, printer.CStr());
}

void Grafter::check(const mjModel* m) {
  report_.mass_after = mj_getTotalmass(m);
  if (std::abs(report_.mass_after - report_.mass_before) > kMassTolerance * report_.mass_before) {
    fail(fmt::format("the grafted model would weigh {:.3f} kg instead of {:.3f} kg",
                     report_.mass_after, report_.mass_before));
  }
  const torsoInfo info = torsoOf(m, o_.output);
  if (info.ndisc == 0) fail("the grafted model has no discs");
  const DataPtr d = makeData(m);
  mj_fwdPosition(m, d.get());

  // Limb joints: as many, of the same names and types, in the same order.
  const mjModel* h = host_.model.get();
  std::array<Vector3d, 4> centre;
  report_.limb_joints = 0;
  for (const auto& [limbs, first] : {std::pair{parts_.thigh, 0}, {parts_.upper_arm, 2}}) {
    std::vector<int> before, after;
    for (int k = 0; k < 2; k++) {
      const int limb = mj_name2id(m, mjOBJ_BODY, host_.bodyName(limbs[k]).c_str());
      centre[first + k] = Vector3d::Zero();
      for (int j = 0; j < m->body_jntnum[limb]; j++) {
        const mjtNum* x = d->xanchor + 3 * (m->body_jntadr[limb] + j);
        centre[first + k] += Vector3d(x[0], x[1], x[2]) / m->body_jntnum[limb];
      }
      const auto below = [](const mjModel* model, int joint, int ancestor) {
        int b = model->jnt_bodyid[joint];
        while (b > ancestor) b = model->body_parentid[b];
        return b == ancestor;
      };
      for (int j = 0; j < h->njnt; j++) {
        if (below(h, j, limbs[k])) before.push_back(j);
      }
      for (int j = 0; j < m->njnt; j++) {
        if (below(m, j, limb)) after.push_back(j);
      }
    }
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    bool same = before.size() == after.size();
    for (std::size_t i = 0; same && i < before.size(); i++) {
      const char *x = mj_id2name(h, mjOBJ_JOINT, before[i]),
                 *y = mj_id2name(m, mjOBJ_JOINT, after[i]);
      same = h->jnt_type[before[i]] == m->jnt_type[after[i]] &&
             std::string(x ? x : "") == (y ? y : "");
    }
    if (!same) fail("the joints of the limbs would not be those of the humanoid");
    report_.limb_joints += static_cast<int>(after.size());
  }
  report_.hip_to_shoulder_after = 0.5 * (centre[2] + centre[3] - centre[0] - centre[1]).norm();
  if (std::abs(report_.hip_to_shoulder_after / report_.hip_to_shoulder_before - 1) >
      kLengthTolerance) {
    fail(fmt::format("hip to shoulder would be {:.3f} m instead of {:.3f} m",
                     report_.hip_to_shoulder_after, report_.hip_to_shoulder_before));
  }
}

// Names and contents of the STL files, at the size of the tables.
std::vector<std::pair<std::string, std::string>> Grafter::boneMeshes() const {
  std::vector<std::pair<std::string, std::string>> meshes;
  for (const std::string& body : mjcfBodies(table_size_, MjcfOptions())) {
    if (o_.meshes.empty()) {
      for (const BonePart& part : boneMesh(table_size_, body)) {
        const TriMesh local = transformed(part.mesh, bodyFrame(table_size_, body).inverse());
        meshes.emplace_back(boneMeshName(body, part.tissue) + ".stl", toStl(local));
      }
      continue;
    }
    for (const Tissue tissue : boneTissues(table_size_, body)) {
      const std::string name = boneMeshName(body, tissue) + ".stl";
      const std::string path = (fs::path(o_.meshes) / name).string();
      std::ifstream file(path, std::ios::binary);
      std::ostringstream content;
      content << file.rdbuf();
      if (!file) throw Error(path + ": cannot read this bone mesh; run `torso build`");
      meshes.emplace_back(name, content.str());
    }
  }
  return meshes;
}

GraftReport Grafter::run() {
  std::error_code error;
  if (fs::equivalent(o_.input, o_.output, error)) {
    throw Error(o_.output + ": is the humanoid itself; name another file");
  }
  checkSettings();
  try {
    parts_ = recognise(host_);
  } catch (const Error&) {
    if (torsoOf(host_.model.get(), o_.input).ntorso == 0) throw;
    fail("it has a torso of ours already, and no other humanoid");
  }
  fit();
  isolateDefaults();
  takeLimbs();
  takeCarried();
  removeTrunk();
  dropReferences();
  takeKeyframes();
  writeTorso();
  mergeSettings();
  hangLimbs();
  merge();
  for (int k = 0; k < 2; k++) {
    const std::string arm = host_.bodyName(parts_.upper_arm[k]);
    const std::string thigh = host_.bodyName(parts_.thigh[k]);
    const char* why = "neighbours at a joint";
    exclude(arm, bodyName("ribcage"), why);
    exclude(arm, bodyName(std::string(kSides[k]) + "clavicle"), why);
    exclude(thigh, bodyName("L5"), why);
    exclude(thigh, bodyName("L4"), why);
  }

  const std::vector<std::pair<std::string, std::string>> meshes = boneMeshes();
  const auto place = [this](XMLElement* root, const fs::path& folder) { placeFiles(root, folder); };
  const TemporaryFolder stage;
  const std::string staged = stage.path + "/" + fs::path(o_.output).filename().string();
  ModelPtr m;
  for (std::size_t excluded = 0; excluded != excluded_.size();) {
    excluded = excluded_.size();
    writeResult(host_.document, staged, place, meshes);
    try {
      m = loadModel(staged);
    } catch (const Error& e) {
      fail(std::string("the grafted model does not load: ") + e.what());
    }
    excludeOverlaps(m.get());
    writeKeyframes(m.get());
  }
  if (keyframes_) {
    writeResult(host_.document, staged, place, meshes);
    m = loadModel(staged);
  }
  check(m.get());
  if (!o_.dry_run) writeResult(host_.document, o_.output, place, meshes);
  return report_;
}

}  // namespace

GraftReport graft(const Anatomy& anatomy, const GraftOptions& options) {
  return Grafter(anatomy, options).run();
}

}  // namespace torso::tools
