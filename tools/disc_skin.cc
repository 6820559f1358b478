// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/disc_skin.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "model/disc_field.h"
#include "plugin/mujoco_torso.h"
#include "tools/disc_data.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;

// The colour map viridis (S. van der Walt, N. Smith and E. Firing, CC0) at equal distances: dark
// and light in the order of the values, to the colour-blind too.
constexpr std::array<std::array<int, 3>, 9> kMap = {{{68, 1, 84},
                                                     {71, 44, 122},
                                                     {59, 81, 139},
                                                     {44, 113, 142},
                                                     {33, 144, 141},
                                                     {39, 173, 129},
                                                     {92, 200, 99},
                                                     {170, 220, 50},
                                                     {253, 231, 37}}};

std::array<double, 3> colourAt(double share) {  // 0 to 1
  const double position = std::clamp(share, 0., 1.) * (kMap.size() - 1);
  const std::size_t k = std::min<std::size_t>(position, kMap.size() - 2);
  std::array<double, 3> colour;
  for (int c = 0; c < 3; c++) {
    colour[c] = (kMap[k][c] + (position - k) * (kMap[k + 1][c] - kMap[k][c])) / 255;
  }
  return colour;
}

// Triangle of a disc's surface, seen from outside counter-clockwise.
struct Face {
  std::array<Vector3d, 3> x;
  std::array<double, 3> value;  // [Pa]
};

// The surface of what is drawn of a disc. A value is the mean over the tets around its node, by
// volume, in the nucleus and in the annulus apart.
std::vector<Face> discSurface(const DiscData& disc, DiscQuantity quantity, bool cut) {
  std::vector<std::array<double, 2>> sum(2 * disc.nodes.size(), {0, 0});  // value x volume, volume
  struct Side {
    int count = 0;
    std::array<int, 3> nodes;
    bool nucleus;
  };
  std::map<std::array<int, 3>, Side> sides;  // by their sorted nodes
  for (std::size_t e = 0; e < disc.tets.size(); e++) {
    const auto& t = disc.tets[e];
    const bool nucleus = disc.cells[e] < 0;
    const double value =
        quantity == DiscQuantity::kPressure ? pressure(disc.stress[e]) : vonMises(disc.stress[e]);
    const auto& X = disc.rest;
    const double volume = (X[t[1]] - X[t[0]]).cross(X[t[2]] - X[t[0]]).dot(X[t[3]] - X[t[0]]) / 6;
    double y = 0;
    for (int node : t) {
      sum[2 * node + nucleus][0] += value * volume;
      sum[2 * node + nucleus][1] += volume;
      y += X[node].y() / 4;
    }
    if (cut && y > 0) continue;
    constexpr int kSides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (const auto& s : kSides) {
      const std::array<int, 3> nodes = {t[s[0]], t[s[1]], t[s[2]]};
      std::array<int, 3> key = nodes;
      std::sort(key.begin(), key.end());
      Side& side = sides[key];
      side.count++;
      side.nodes = nodes;
      side.nucleus = nucleus;
    }
  }
  std::vector<Face> faces;
  for (const auto& [key, side] : sides) {
    if (side.count != 1) continue;
    Face face;
    for (int k = 0; k < 3; k++) {
      const auto& [value, volume] = sum[2 * side.nodes[k] + side.nucleus];
      face.x[k] = disc.nodes[side.nodes[k]];
      face.value[k] = value / volume;
    }
    faces.push_back(face);
  }
  return faces;
}

// (face, corner) unit normals: the mean of the faces around a corner that do not make an edge.
std::vector<std::array<Vector3d, 3>> smoothNormals(const std::vector<Face>& faces) {
  constexpr double kEdge = 0.7;  // cosine of the least angle between two faces at an edge
  std::vector<Vector3d> area;
  std::map<std::array<double, 3>, std::vector<std::size_t>> around;  // by the corner's place
  const auto key = [](const Vector3d& x) { return std::array<double, 3>{x.x(), x.y(), x.z()}; };
  for (const Face& face : faces) {
    for (const Vector3d& x : face.x) around[key(x)].push_back(area.size());
    area.push_back((face.x[1] - face.x[0]).cross(face.x[2] - face.x[0]));
  }
  std::vector<std::array<Vector3d, 3>> normals(faces.size());
  for (std::size_t f = 0; f < faces.size(); f++) {
    for (int k = 0; k < 3; k++) {
      Vector3d& n = normals[f][k] = Vector3d::Zero();
      for (std::size_t g : around[key(faces[f].x[k])]) {
        if (area[f].dot(area[g]) >= kEdge * area[f].norm() * area[g].norm()) n += area[g];
      }
      n.normalize();
    }
  }
  return normals;
}

constexpr int kGroup = 1;       // of skins: that of the layer discs
constexpr int kMapWidth = 256;  // [texels]
// Half of what is seen of a colour is light of its own, which leaves it legible in the shade, and
// in full light it is not brighter than in the legend.
constexpr float kGrey = 0.7f, kEmission = 0.6f;

// The least of 1, 2 or 5 times a power of ten that is not less than x > 0.
double niceStep(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (double step : {power, 2 * power, 5 * power}) {
    if (step >= x) return step;
  }
  return 10 * power;
}

}  // namespace

std::array<double, 2> discRange(const mjModel* m, const std::vector<const mjData*>& states,
                                DiscQuantity quantity, bool cut) {
  std::vector<double> values;
  for (const mjData* d : states) {
    for (const DiscData& disc : discData(m, d)) {
      for (const Face& face : discSurface(disc, quantity, cut)) {
        values.insert(values.end(), face.value.begin(), face.value.end());
      }
    }
  }
  if (values.empty()) return {0, 1};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    return values[static_cast<std::size_t>(share * (values.size() - 1))];
  };
  const double low = quantity == DiscQuantity::kMises ? 0 : quantile(0.01);
  // Discs at rest have all one value; so small a stress is of no account.
  const double high = std::max(quantile(0.99), low + 1e3);
  const double step = niceStep((high - low) / 20);
  return {std::floor(low / step) * step, std::ceil(high / step) * step};
}

DiscSkin::DiscSkin(const mjModel* m, const mjData* d, const DiscColours& colours) : model_(*m) {
  const auto [low, high] = colours.range;
  std::vector<float> texcoords;
  for (const DiscData& disc : discData(m, d)) {
    const std::vector<Face> faces = discSurface(disc, colours.quantity, colours.cut);
    const auto normals = smoothNormals(faces);
    for (std::size_t f = 0; f < faces.size(); f++) {
      for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++) {
          positions_.push_back(static_cast<float>(faces[f].x[k][c]));
          normals_.push_back(static_cast<float>(normals[f][k][c]));
        }
        // From the middle of the first texel to that of the last one of the map, see addMaterial.
        const double share = std::clamp((faces[f].value[k] - low) / (high - low), 0., 1.);
        texcoords.push_back(static_cast<float>((0.5 + share * (kMapWidth - 1)) / (2 * kMapWidth)));
        texcoords.push_back(0.5f);
      }
    }
  }
  if (positions_.empty()) return;
  // The discs' own skins are left without faces.
  append(model_.skin_facenum, m->nskin, {});
  for (int i = 0; torso_discName(m, i); i++) {
    const int skin = torso_discSkin(m, i);
    if (skin >= 0) model_.skin_facenum[skin] = 0;
  }
  addMaterial();
  addSkin(texcoords);
}

template <typename T>
void DiscSkin::append(T*& array, int size, const std::vector<T>& more) {
  const auto copy = std::make_shared<std::vector<T>>(array, array + size);
  copy->insert(copy->end(), more.begin(), more.end());
  array = copy->data();
  owned_.push_back(copy);
}

// The right half of the texture is the map backwards: textures repeat, and where a disc is so small
// that texels are averaged, the two ends of the map must not meet.
void DiscSkin::addMaterial() {
  std::vector<mjtByte> texture;
  for (int i = 0; i < 2 * kMapWidth; i++) {
    const int k = i < kMapWidth ? i : 2 * kMapWidth - 1 - i;
    for (double c : colourAt(k / (kMapWidth - 1.))) {
      texture.push_back(static_cast<mjtByte>(std::lround(255 * c)));
    }
  }
  mjModel& m = model_;
  append<int>(m.tex_type, m.ntex, {mjTEXTURE_2D});
  append<int>(m.tex_height, m.ntex, {1});
  append<int>(m.tex_width, m.ntex, {2 * kMapWidth});
  append<int>(m.tex_adr, m.ntex, {m.ntexdata});
  append(m.tex_rgb, m.ntexdata, texture);

  append<int>(m.mat_texid, m.nmat, {m.ntex});
  append<mjtByte>(m.mat_texuniform, m.nmat, {0});
  append<float>(m.mat_texrepeat, 2 * m.nmat, {1, 1});
  append<float>(m.mat_emission, m.nmat, {kEmission});
  append<float>(m.mat_specular, m.nmat, {0});
  append<float>(m.mat_shininess, m.nmat, {0});
  append<float>(m.mat_reflectance, m.nmat, {0});
  append<float>(m.mat_rgba, 4 * m.nmat, {kGrey, kGrey, kGrey, 1});
  m.ntex++;
  m.ntexdata += static_cast<int>(texture.size());
  m.nmat++;
}

// A skin without bones, at which MuJoCo leaves the vertices to us. Its first bone is still asked
// for a body.
void DiscSkin::addSkin(const std::vector<float>& texcoords) {
  mjModel& m = model_;
  const int vertices = static_cast<int>(positions_.size()) / 3;
  std::vector<int> face(vertices);
  std::iota(face.begin(), face.end(), 0);
  append<int>(m.skin_matid, m.nskin, {m.nmat - 1});
  append<int>(m.skin_group, m.nskin, {kGroup});
  append<float>(m.skin_rgba, 4 * m.nskin, {0.5f, 0.5f, 0.5f, 1});  // the default: material's
  append<float>(m.skin_inflate, m.nskin, {0});
  append<int>(m.skin_vertadr, m.nskin, {m.nskinvert});
  append<int>(m.skin_vertnum, m.nskin, {vertices});
  append<int>(m.skin_texcoordadr, m.nskin, {m.nskintexvert});
  append<int>(m.skin_faceadr, m.nskin, {m.nskinface});
  append<int>(m.skin_facenum, m.nskin, {vertices / 3});
  append<int>(m.skin_boneadr, m.nskin, {m.nskinbone});
  append<int>(m.skin_bonenum, m.nskin, {0});
  append<int>(m.skin_bonebodyid, m.nskinbone, {0});
  append<int>(m.name_skinadr, m.nskin, {0});
  append(m.skin_texcoord, 2 * m.nskintexvert, texcoords);
  append(m.skin_face, 3 * m.nskinface, face);
  m.nskin++;
  m.nskinvert += vertices;
  m.nskintexvert += vertices;
  m.nskinface += vertices / 3;
}

void DiscSkin::place(const mjvOption& option, mjvScene* scene) const {
  // Of a hidden skin MuJoCo leaves all vertices in one point.
  if (positions_.empty() || !option.skingroup[kGroup]) return;
  const int adr = 3 * scene->skinvertadr[scene->nskin - 1];
  std::copy(positions_.begin(), positions_.end(), scene->skinvert + adr);
  std::copy(normals_.begin(), normals_.end(), scene->skinnormal + adr);
}

void drawLegend(const DiscColours& colours, mjrRect viewport, const mjrContext& context) {
  const int line = 3 * context.charHeight / 2, column = 9 * line / 2;
  const mjrRect panel = {viewport.left + viewport.width - column - line, viewport.bottom + line,
                         column, std::min(viewport.height - 2 * line, 14 * line)};
  if (panel.left < viewport.left || panel.height < 8 * line) return;  // no room
  mjr_rectangle(panel, 1, 1, 1, 0.85f);
  const auto write = [&](int left, int centre, int width, const std::string& text) {
    mjr_label({left, centre - line / 2, width, line}, mjFONT_NORMAL, text.c_str(), 1, 1, 1, 0, 0, 0,
              0, &context);
  };
  const int top = panel.bottom + panel.height;
  const bool pressure = colours.quantity == DiscQuantity::kPressure;
  write(panel.left, top - line, column, pressure ? "pressure" : "von Mises");
  write(panel.left, top - 2 * line, column, "[MPa]");

  const mjrRect bar = {panel.left + line / 2, panel.bottom + line, line, panel.height - 4 * line};
  for (int row = 0; row < bar.height; row++) {
    const auto c = colourAt(row / (bar.height - 1.));
    mjr_rectangle({bar.left, bar.bottom + row, bar.width, 1}, static_cast<float>(c[0]),
                  static_cast<float>(c[1]), static_cast<float>(c[2]), 1);
  }
  const auto [low, high] = colours.range;
  const auto tick = [&](double value) {
    const int row = bar.bottom + static_cast<int>((value - low) / (high - low) * (bar.height - 1));
    mjr_rectangle({bar.left + bar.width, row, line / 3, 1}, 0, 0, 0, 1);
    write(bar.left + bar.width + line / 3, row, column - 2 * line,
          fmt::format("{:.3g}", 1e-6 * value));
  };
  tick(low);
  tick(high);
  // Round values between, clear of the ends.
  const double step = niceStep((high - low) / 5);
  for (double k = std::ceil(low / step); k * step < high; k++) {
    if (std::min(k * step - low, high - k * step) > 0.6 * step) tick(k * step);
  }
}

}  // namespace torso::tools
