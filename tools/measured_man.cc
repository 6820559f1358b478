// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/measured_man.h"

#include <cmath>

#include "model/loft.h"
#include "model/person.h"

namespace torso::tools {
namespace {

constexpr int kLumbarDiscs = 6;  // L5/S1 .. T12/L1

}  // namespace

double outlineArea(const DiscShape& disc) {
  constexpr int kPoints = 72;
  const auto outline = endplateOutline(disc.width, disc.depth, kPoints);
  double area = 0;
  for (int i = 0; i < kPoints; i++) {
    const Eigen::Vector2d &p = outline[i], &q = outline[(i + 1) % kPoints];
    area += (p.x() * q.y() - p.y() * q.x()) / 2;
  }
  return area;
}

Anatomy measuredMan(const Anatomy& tables) {
  Person person;
  person.mass = kSubjectsMass;
  Anatomy anatomy = personalAnatomy(tables, person);
  const double wider = std::sqrt(kSubjectsArea / outlineArea(anatomy.disc("L4/L5").shape));
  for (int i = 0; i < kLumbarDiscs; i++) {
    anatomy.discs[i].shape.width *= wider;
    anatomy.discs[i].shape.depth *= wider;
  }
  return anatomy;
}

}  // namespace torso::tools
