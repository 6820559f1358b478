// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/graft_host.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/error.h"
#include "tools/mujoco_eigen.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

void parse(tinyxml2::XMLDocument& document, const std::string& path) {
  if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS || !document.RootElement()) {
    throw Error(fmt::format("{}: not an XML file: {}", path, document.ErrorStr()));
  }
}

// Puts the content of included files in the place of <include>. MuJoCo has loaded the model before,
// so that the files exist and include each other at most once.
void expandIncludes(XMLElement* parent, const std::string& folder,
                    std::vector<std::string>& paths) {
  for (XMLElement* e = parent->FirstChildElement(); e;) {
    XMLElement* next = e->NextSiblingElement();
    const char* file = e->Attribute("file");
    if (e->Value() != std::string("include") || !file) {
      expandIncludes(e, folder, paths);
      e = next;
      continue;
    }
    tinyxml2::XMLDocument included;
    paths.push_back((fs::path(folder) / file).string());
    parse(included, paths.back());
    tinyxml2::XMLNode* last = e;
    for (XMLElement* c = included.RootElement()->FirstChildElement(); c;
         c = c->NextSiblingElement()) {
      last = parent->InsertAfterChild(last, c->DeepClone(parent->GetDocument()));
    }
    next = e->NextSiblingElement();  // what was included may include more
    parent->DeleteChild(e);
    e = next;
  }
}

}  // namespace

void listBodies(XMLElement* parent, std::vector<XMLElement*>& bodies) {
  for (XMLElement* e = parent->FirstChildElement("body"); e; e = e->NextSiblingElement("body")) {
    bodies.push_back(e);
    listBodies(e, bodies);
  }
}

Host::Host(const std::string& path)
    : path(path), folder(fs::absolute(path).parent_path().string()), model(loadModel(path)) {
  parse(document, path);
  root = document.RootElement();
  if (root->Value() != std::string("mujoco")) {
    throw Error(fmt::format("{}: not MJCF, its root element is <{}>; save it as MJCF first", path,
                            root->Value()));
  }
  expandIncludes(root, folder, included);
  bodies = {nullptr};
  for (XMLElement* w = root->FirstChildElement("worldbody"); w;
       w = w->NextSiblingElement("worldbody")) {
    listBodies(w, bodies);
  }
  if (static_cast<int>(bodies.size()) != model->nbody) {
    throw Error(
        fmt::format("{}: MuJoCo makes {} bodies of the file's {}; composite objects and "
                    "fused bodies cannot be grafted",
                    path, model->nbody - 1, bodies.size() - 1));
  }
  data = makeData(model.get());
  mj_fwdPosition(model.get(), data.get());
}

Isometry3d Host::pose(int body) const {
  const mjtNum* q = data->xquat + 4 * body;
  Isometry3d X(Quaterniond(q[0], q[1], q[2], q[3]));
  X.translation() = vector3(data->xpos + 3 * body);
  return X;
}

Vector3d Host::jointCentre(int body) const {
  const int n = model->body_jntnum[body];
  if (n == 0) return pose(body).translation();
  Vector3d sum = Vector3d::Zero();
  for (int j = 0; j < n; j++) sum += vector3(data->xanchor + 3 * (model->body_jntadr[body] + j));
  return sum / n;
}

bool Host::isBelow(int body, int ancestor) const {
  while (body > ancestor) body = model->body_parentid[body];
  return body == ancestor;
}

Matrix3d trunkAxes(const std::array<Vector3d, 2>& hip, const std::array<Vector3d, 2>& shoulder) {
  const Vector3d up = (shoulder[0] + shoulder[1] - hip[0] - hip[1]).normalized();
  Vector3d left = hip[0] - hip[1] + shoulder[0] - shoulder[1];
  left = (left - left.dot(up) * up).normalized();
  Matrix3d axes;
  axes << left.cross(up), left, up;
  return axes;
}

}  // namespace torso::tools
