// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <vector>

namespace torso::tools {

// Muscles that span a region of the spine turn its levels together, each in proportion to its range
// of motion: living lumbar (Aiyangar et al. 2015, J Biomech 48:3709-3715) and cervical levels
// (Anderst et al. 2015, Spine J 15:2538-2546) have steady shares of a bend, and models of whole
// spines are posed so (Alemi et al. 2021, Front Bioeng Biotechnol 9:688041). For the thorax it is
// assumed. A passive column bends where it is softest instead. Servos of the levels towards their
// shares of what the region as a whole is turned by at present, which leave that whole alone.
class SpineRhythm {
 public:
  // torso: of BodyMjcf::torsoOnHolds, whose servos are those of the levels. Shares are those of the
  // servos' ranges, which are of living people (model/anatomy/range_of_motion.csv); flexion and
  // extension have shares of their own.
  explicit SpineRhythm(const mjModel* torso);

  // Sets ctrl for the turns that d->actuator_length tells.
  void apply(mjData* d) const;

 private:
  struct Servo {
    int id;
    double up, down;  // share of positive and of negative turns
  };
  std::vector<std::vector<Servo>> groups_;  // of a region and an axis
};

}  // namespace torso::tools
