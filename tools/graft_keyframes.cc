// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
// Keyframes in the new coordinates.

#include <algorithm>

#include "tools/graft_xml.h"
#include "tools/grafter.h"
#include "tools/mjcf.h"

namespace torso::tools {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

}  // namespace

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

}  // namespace torso::tools
