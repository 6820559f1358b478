// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bone_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/plate.h"
#include "tools/renderer.h"

namespace torso::tools {
namespace {

using Names = std::vector<std::string>;

constexpr View kFront = {180, 0}, kLeft = {-90, 0}, kBack = {0, 0};

// What a row of a picture shows, all its views in one scale.
struct Row {
  Names meshes;  // those of bones and cartilage, {} for all
  Names levels;  // whose disc, ligaments and facets
};

struct Sheet {
  std::string name, model;
  int width, height;  // of one view [pixels]
  std::vector<Row> rows;
  std::vector<View> columns;
  bool hip_bones = true;  // they hide the sacrum and L5 from the side
};

// Vertebrae from above have their front at the top.
std::vector<Sheet> sheets() {
  const Names girdle = {"ribcage",
                        "ribcage_cartilage",
                        "left_clavicle",
                        "left_scapula",
                        "left_upper_arm",
                        "right_clavicle",
                        "right_scapula",
                        "right_upper_arm",
                        "C7",
                        "T1",
                        "T2",
                        "T3",
                        "T4",
                        "T5",
                        "T6",
                        "T7",
                        "T8",
                        "T9",
                        "T10",
                        "T11",
                        "T12"};
  const Row lumbar = {{"L1", "L2", "L3", "L4", "L5", "pelvis"},
                      {"L1/L2", "L2/L3", "L3/L4", "L4/L5", "L5/S1"}};
  return {
      {"skeleton", "human.xml", 330, 960, {{{}, {}}}, {kFront, kLeft, kBack}},
      {"vertebrae",
       "human.xml",
       400,
       330,
       {{{"C5"}, {}}, {{"T7"}, {}}, {{"L3"}, {}}},
       {{0, -90}, kLeft, kBack}},
      {"lumbar", "torso_held.xml", 430, 900, {lumbar}, {{-40, -10}, kLeft}, false},
      {"shoulder", "human.xml", 560, 450, {{girdle, {}}}, {kFront, kBack}},
      {"skull", "human.xml", 400, 480, {{{"head"}, {}}}, {kFront, kLeft, {-135, -5}}},
  };
}

constexpr int kShown = 1, kHidden = mjNGROUP - 1;

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Whether a name is that of one of the levels, or of a part of it: "L4/L5", "ALL_mid_L4/L5",
// "L4/L5_left_point0".
bool ofLevels(const std::string& name, const Names& levels) {
  return std::any_of(levels.begin(), levels.end(), [&](const std::string& level) {
    const std::size_t at = name.find(level);
    if (at == std::string::npos || (at > 0 && name[at - 1] != '_')) return false;
    return at + level.size() == name.size() || name[at + level.size()] == '_';
  });
}

// Of a mesh of several closed surfaces leaves those that the median plane cuts: of the pelvis the
// sacrum and coccyx.
void dropLateralParts(mjModel* m, const mjData* d, int geom) {
  const int mesh = m->geom_dataid[geom], n = m->mesh_vertnum[mesh];
  float* vertices = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
  const int* faces = m->mesh_face + 3 * m->mesh_faceadr[mesh];
  std::vector<int> part(n);  // any other vertex of the same part, or itself
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](int v) {
    while (part[v] != v) v = part[v] = part[part[v]];
    return v;
  };
  for (int f = 0; f < m->mesh_facenum[mesh]; f++) {
    for (int k = 1; k < 3; k++) part[root(faces[3 * f + k])] = root(faces[3 * f]);
  }
  std::vector<double> least(n, INFINITY), most(n, -INFINITY);
  for (int v = 0; v < n; v++) {
    const mjtNum x[3] = {vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]};
    const double y = mju_dot3(d->geom_xmat + 9 * geom + 3, x) + d->geom_xpos[3 * geom + 1];
    least[root(v)] = std::min(least[root(v)], y);
    most[root(v)] = std::max(most[root(v)], y);
  }
  const auto median = [&](int v) { return least[root(v)] < 0 && most[root(v)] > 0; };
  int kept = 0;
  while (kept < n && !median(kept)) kept++;
  if (kept == n) return;
  for (int v = 0; v < n; v++) {
    if (!median(v)) std::copy_n(vertices + 3 * kept, 3, vertices + 3 * v);
  }
}

class Plate {
 public:
  Plate(const std::string& models, const Sheet& sheet)
      : sheet_(sheet), path_(models + "/" + sheet.model), m_(loadModel(path_)) {
    preparePlate(m_.get());
    groups_.assign(m_->geom_group, m_->geom_group + m_->ngeom);
    d_ = makeData(m_.get());
    mj_fwdPosition(m_.get(), d_.get());
    for (int i = 0; i < m_->ngeom; i++) {
      if (!sheet.hip_bones && isBone(i) && meshOf(i) == "pelvis") {
        dropLateralParts(m_.get(), d_.get(), i);
      }
    }
  }

  std::string png() {
    Renderer renderer(m_.get(), kFiner * sheet_.width, kFiner * sheet_.height);
    const int columns = static_cast<int>(sheet_.columns.size());
    const int rows = static_cast<int>(sheet_.rows.size());
    const int width = sheet_.width * columns;
    std::vector<unsigned char> rgb(std::size_t{3} * width * sheet_.height * rows);
    for (int row = 0; row < rows; row++) {
      const std::vector<mjvCamera> cameras = frame(sheet_.rows[row]);
      for (int column = 0; column < columns; column++) {
        placeLight(m_.get(), d_.get(), sheet_.columns[column]);
        const auto cell = shrink(renderer.pixels(d_.get(), option(), cameras[column]), sheet_.width,
                                 sheet_.height);
        // Rows of pixels go from below, rows of views from the top.
        const std::size_t below = std::size_t(rows - 1 - row) * sheet_.height;
        for (int y = 0; y < sheet_.height; y++) {
          std::copy_n(&cell[3 * static_cast<std::size_t>(y) * sheet_.width], 3 * sheet_.width,
                      &rgb[3 * ((below + y) * width + column * sheet_.width)]);
        }
      }
    }
    return encodePng(rgb, width, sheet_.height * rows);
  }

 private:
  static mjvOption option() {
    mjvOption result;
    mjv_defaultOption(&result);
    std::fill_n(result.sitegroup, mjNGROUP, mjtByte{0});
    return result;
  }

  std::string meshOf(int geom) const { return nameOf(m_.get(), mjOBJ_MESH, m_->geom_dataid[geom]); }
  bool isBone(int geom) const {
    return m_->geom_type[geom] == mjGEOM_MESH && groups_[geom] == kShown;
  }

  void show(const Row& row) {
    for (const std::string& mesh : row.meshes) {
      if (mj_name2id(m_.get(), mjOBJ_MESH, mesh.c_str()) < 0) {
        throw Error(fmt::format("{}: no mesh '{}' to draw", path_, mesh));
      }
    }
    const auto of = [&](mjtObj type, int i) {
      return ofLevels(nameOf(m_.get(), type, i), row.levels);
    };
    for (int i = 0; i < m_->ngeom; i++) {
      const bool shown =
          isBone(i) ? row.meshes.empty() || contains(row.meshes, meshOf(i)) : of(mjOBJ_GEOM, i);
      m_->geom_group[i] = shown ? kShown : kHidden;
      if (shown && m_->geom_type[i] == mjGEOM_ELLIPSOID) {
        const float translucent[4] = {0.35f, 0.6f, 1.0f, 0.3f};
        std::copy_n(translucent, 4, m_->geom_rgba + 4 * i);
      }
    }
    for (int i = 0; i < m_->nskin; i++) m_->skin_group[i] = of(mjOBJ_SKIN, i) ? kShown : kHidden;
    for (int i = 0; i < m_->ntendon; i++) {
      m_->tendon_group[i] = of(mjOBJ_TENDON, i) ? kShown : kHidden;
    }
  }

  // Shows the row and has cameras for its views. A vertebra alone stands upright, not inclined as
  // it is in the spine.
  std::vector<mjvCamera> frame(const Row& row) {
    show(row);
    if (row.meshes.size() == 1) {
      const int joint = mj_name2id(m_.get(), mjOBJ_JOINT, row.meshes[0].c_str());
      if (joint >= 0 && m_->jnt_type[joint] == mjJNT_FREE) {
        const mjtNum upright[4] = {1, 0, 0, 0};
        mju_copy4(d_->qpos + m_->jnt_qposadr[joint] + 3, upright);
        mj_fwdPosition(m_.get(), d_.get());
      }
    }
    std::vector<mjvCamera> cameras;
    double distance = 0;
    for (const View& view : sheet_.columns) {
      cameras.push_back(frameBodies(m_.get(), {d_.get()}, option(), view.azimuth, view.elevation,
                                    static_cast<double>(sheet_.width) / sheet_.height));
      distance = std::max(distance, cameras.back().distance);
    }
    for (mjvCamera& camera : cameras) camera.distance = distance;
    m_->vis.map.znear = static_cast<float>(distance / 2 / m_->stat.extent);  // for a fine depth
    return cameras;
  }

  const Sheet& sheet_;
  std::string path_;
  ModelPtr m_;
  DataPtr d_;
  std::vector<int> groups_;  // of the geoms, as in the model
};

}  // namespace

std::map<std::string, std::string> drawBones(const std::string& models) {
  std::map<std::string, std::string> pictures;
  for (const Sheet& sheet : sheets()) pictures[sheet.name + ".png"] = Plate(models, sheet).png();
  return pictures;
}

}  // namespace torso::tools
