// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Fit of the discs' material to in-vitro tests.

#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/disc.h"

namespace torso {

// A fitted constant with what is published about it: `typical` is where it stays unless tests say
// otherwise, `low` and `high` are never passed. SI.
struct FittedConstant {
  const char* name;  // column of disc_materials.csv
  double unit;       // of that column in SI
  double DiscMaterial::*member;
  double typical, low, high;
};
const std::vector<FittedConstant>& fittedConstants();

struct DiscCalibration {
  DiscMaterial material;
  double cost;     // sum of squares
  int iterations;  // of the Levenberg-Marquardt method
};

// Least squares over all `tests` on all `discs`, from `start`, whose constants that are not fitted
// stay. With r the logarithm of ours over the published value, in half widths of the published
// range's logarithm: each test and disc gives a residual r / 4, and one of 20 (|r| - 1) outside of
// the range, measured from the bound; each fitted constant gives log(constant / typical) / log 4.
// Deterministic, whatever the number of threads. Loss factors, which do not depend on the fitted
// constants, and preload ratios, of which there is no publication for human discs alone, are left
// out. Throws std::invalid_argument if discs or tests are empty, or the tests are of several
// regions.
DiscCalibration calibrateDiscs(const std::vector<DiscMesh>& discs,
                               const std::vector<DiscTest>& tests, const DiscMaterial& start,
                               int threads = 1);

}  // namespace torso
