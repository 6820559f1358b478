// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The discs of a picture drawn as the solid bodies they are, coloured by the stress in them.

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <vector>

namespace torso::tools {

enum class DiscQuantity { kPressure, kMises };

struct DiscColours {
  DiscQuantity quantity = DiscQuantity::kPressure;
  bool cut = false;                      // draw only the right half of each disc
  std::array<double, 2> range = {0, 0};  // values of the first and the last colour [Pa]
};

// Range that holds all but 2 % of what is drawn of the discs in all the states, rounded outwards.
std::array<double, 2> discRange(const mjModel* m, const std::vector<const mjData*>& states,
                                DiscQuantity quantity, bool cut);

// The surface of all discs in one state as one skin. MuJoCo's skins have no colours by vertex, but
// they have texture coordinates: the colour map is a texture.
class DiscSkin {
 public:
  // d: after mj_forward. The model must live as long as the skin.
  DiscSkin(const mjModel* m, const mjData* d, const DiscColours& colours);
  DiscSkin(const DiscSkin&) = delete;
  DiscSkin& operator=(const DiscSkin&) = delete;

  // The model with this skin, in skin group 1, instead of the discs' own. For MuJoCo's visualiser
  // and renderer only.
  const mjModel* model() const { return &model_; }
  // Put the skin where the discs are, after mjv_updateScene with model() and the same option.
  void place(const mjvOption& option, mjvScene* scene) const;

 private:
  // Replace an array of model_, of so many numbers, by a copy with more at its end.
  template <typename T>
  void append(T*& array, int size, const std::vector<T>& more);
  void addMaterial();
  void addSkin(const std::vector<float>& texcoords);

  mjModel model_;                             // its arrays are the original's or in owned_
  std::vector<std::shared_ptr<void>> owned_;  // arrays
  std::vector<float> positions_, normals_;    // (vertex x 3), three vertices to a face
};

// Draw the colour map with its quantity and range at the right of the picture.
void drawLegend(const DiscColours& colours, mjrRect viewport, const mjrContext& context);

}  // namespace torso::tools
