// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/motion_glb.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/error.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

// Codes of glTF 2.0 (Khronos Group, section 5).
constexpr int kFloat = 5126, kUnsigned = 5125, kVertices = 34962, kIndices = 34963;
constexpr int kBoneGroup = 1;  // of geoms

// The JSON and the buffer of a glTF file as they grow.
class Document {
 public:
  Document() {
    json = {{"asset", {{"version", "2.0"}, {"generator", "mujoco-torso"}}},
            {"scene", 0},
            {"scenes", Json::array()},
            {"nodes", Json::array()},
            {"meshes", Json::array()},
            {"materials", Json::array()},
            {"accessors", Json::array()},
            {"bufferViews", Json::array()},
            {"animations", Json::array()}};
  }

  // Numbers as an accessor of `type`; target 0: none. Returns its index.
  template <typename T>
  int add(const std::vector<T>& numbers, const char* type, int width, int target) {
    Json view = {
        {"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", numbers.size() * sizeof(T)}};
    if (target) view["target"] = target;
    json["bufferViews"].push_back(view);
    buffer.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
    Json accessor = {{"bufferView", json["bufferViews"].size() - 1},
                     {"componentType", std::is_same_v<T, float> ? kFloat : kUnsigned},
                     {"count", numbers.size() / width},
                     {"type", type}};
    if (width == 3 || width == 1) {
      std::vector<T> low(width, std::numeric_limits<T>::max());
      std::vector<T> high(width, std::numeric_limits<T>::lowest());
      for (std::size_t i = 0; i < numbers.size(); i++) {
        low[i % width] = std::min(low[i % width], numbers[i]);
        high[i % width] = std::max(high[i % width], numbers[i]);
      }
      accessor["min"] = low;
      accessor["max"] = high;
    }
    json["accessors"].push_back(accessor);
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  std::string file() {
    buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
    json["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t size = 12 + 8 + text.size() + 8 + buffer.size();
    if (size > std::numeric_limits<std::uint32_t>::max()) {
      throw Error("the motion is too long for one GLB file (4 GB)");
    }
    std::string result;
    const auto word = [&result](std::size_t value) {
      const auto bits = static_cast<std::uint32_t>(value);
      result.append(reinterpret_cast<const char*>(&bits), sizeof(bits));
    };
    word(0x46546C67);  // "glTF"
    word(2);
    word(size);
    word(text.size());
    word(0x4E4F534A);  // "JSON"
    result += text;
    word(buffer.size());
    word(0x004E4942);  // "BIN"
    return result + buffer;
  }

  Json json;
  std::string buffer;
};

int addMaterial(const mjModel* m, int geom, std::map<int, int>* known, Document* document) {
  const int id = m->geom_matid[geom];
  if (known->count(id)) return known->at(id);
  const float* rgba = id >= 0 ? m->mat_rgba + 4 * id : m->geom_rgba + 4 * geom;
  document->json["materials"].push_back(
      {{"name", id >= 0 ? nameOf(m, mjOBJ_MATERIAL, id) : "bone"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {rgba[0], rgba[1], rgba[2], rgba[3]}},
         {"metallicFactor", 0},
         {"roughnessFactor", 0.7}}}});
  return (*known)[id] = static_cast<int>(document->json["materials"].size()) - 1;
}

// The mesh of a geom, in the frame of its body.
Json addPrimitive(const mjModel* m, int geom, int material, Document* document) {
  const int mesh = m->geom_dataid[geom];
  const int first = m->mesh_vertadr[mesh], count = m->mesh_vertnum[mesh];
  std::vector<float> positions, normals;
  for (int v = first; v < first + count; v++) {
    mjtNum x[3], normal[3];
    for (int k = 0; k < 3; k++) {
      x[k] = m->mesh_vert[3 * v + k];
      normal[k] = m->mesh_normal[3 * v + k];
    }
    mju_rotVecQuat(x, x, m->geom_quat + 4 * geom);
    mju_addTo3(x, m->geom_pos + 3 * geom);
    mju_rotVecQuat(normal, normal, m->geom_quat + 4 * geom);
    mju_normalize3(normal);
    positions.insert(positions.end(), x, x + 3);
    normals.insert(normals.end(), normal, normal + 3);
  }
  const int* faces = m->mesh_face + 3 * m->mesh_faceadr[mesh];
  const std::vector<std::uint32_t> indices(faces, faces + 3 * m->mesh_facenum[mesh]);
  const int position = document->add(positions, "VEC3", 3, kVertices);
  const int normal = document->add(normals, "VEC3", 3, kVertices);
  return {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
          {"indices", document->add(indices, "SCALAR", 1, kIndices)},
          {"material", material}};
}

}  // namespace

std::string motionGlb(const mjModel* m, const Motion& motion) {
  Document document;
  Json& json = document.json;
  // From z up to y up.
  json["nodes"].push_back({{"name", "human"},
                           {"rotation", {-0.70710678, 0, 0, 0.70710678}},
                           {"children", Json::array()}});
  json["scenes"].push_back({{"nodes", {0}}});
  std::map<int, int> materials;
  std::vector<int> bodies;
  for (int b = 1; b < m->nbody; b++) {
    Json primitives = Json::array();
    for (int g = m->body_geomadr[b]; g < m->body_geomadr[b] + m->body_geomnum[b]; g++) {
      if (m->geom_type[g] != mjGEOM_MESH || m->geom_group[g] != kBoneGroup) continue;
      const int material = addMaterial(m, g, &materials, &document);
      primitives.push_back(addPrimitive(m, g, material, &document));
    }
    if (primitives.empty()) continue;
    const std::string name = nameOf(m, mjOBJ_BODY, b);
    json["meshes"].push_back({{"name", name}, {"primitives", primitives}});
    json["nodes"].push_back({{"name", name}, {"mesh", json["meshes"].size() - 1}});
    json["nodes"][0]["children"].push_back(json["nodes"].size() - 1);
    bodies.push_back(b);
  }
  if (bodies.empty()) throw Error("the model has no bone meshes for a GLB file");

  const DataPtr d = makeData(m);
  std::vector<float> times;
  std::vector<std::vector<float>> places(bodies.size()), turns(bodies.size());
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    times.push_back(static_cast<float>(frame / motion.rate));
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    for (std::size_t i = 0; i < bodies.size(); i++) {
      const mjtNum *p = d->xpos + 3 * bodies[i], *q = d->xquat + 4 * bodies[i];
      places[i].insert(places[i].end(), p, p + 3);
      // The same turn as the last one, not its opposite, so that players take the short way.
      float quaternion[4] = {static_cast<float>(q[1]), static_cast<float>(q[2]),
                             static_cast<float>(q[3]), static_cast<float>(q[0])};
      if (frame > 0) {
        float product = 0;
        for (int k = 0; k < 4; k++) product += quaternion[k] * turns[i][turns[i].size() - 4 + k];
        if (product < 0) std::for_each(quaternion, quaternion + 4, [](float& x) { x = -x; });
      }
      turns[i].insert(turns[i].end(), quaternion, quaternion + 4);
    }
  }
  const int input = document.add(times, "SCALAR", 1, 0);
  Json animation = {{"name", "motion"}, {"channels", Json::array()}, {"samplers", Json::array()}};
  for (std::size_t i = 0; i < bodies.size(); i++) {
    for (const bool turn : {false, true}) {
      const int output =
          turn ? document.add(turns[i], "VEC4", 4, 0) : document.add(places[i], "VEC3", 3, 0);
      animation["channels"].push_back(
          {{"sampler", animation["samplers"].size()},
           {"target", {{"node", i + 1}, {"path", turn ? "rotation" : "translation"}}}});
      animation["samplers"].push_back(
          {{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    }
  }
  json["animations"].push_back(animation);
  return document.file();
}

}  // namespace torso::tools
