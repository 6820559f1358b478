// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What `torso discs` finds out about a disc on the bench, and the units in which it is told.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/anatomy.h"
#include "model/disc_bench.h"
#include "model/skeleton.h"

namespace torso::tools {

// The disc called `level`, or all if that is empty. Throws Error with the names that there are.
std::vector<Disc> chooseDiscs(const Anatomy& anatomy, const std::string& level);

struct DiscOutcome {
  DiscTest test;
  std::optional<double> ours;  // SI, as DiscTest::value; none if the disc gives way under the load
  bool inside() const { return ours && insideRange(test, *ours); }
};

struct DiscLoading {
  DiscTest::Quantity quantity;
  double preload;   // [N]
  DiscCurve curve;  // ends early where the disc gives way
};

struct DiscReport {
  Disc disc;
  double area;  // of the endplate [m^2]
  std::vector<DiscOutcome> outcomes;
  std::vector<DiscLoading> loadings;
  Matrix6d stiffness, stiffness_preloaded;  // SI
  double preload;                           // of the latter [N]
};

// Unit of a quantity's values, loads and displacements, and what one of it is in SI.
struct DiscUnits {
  const char *value, *load, *displacement;
  double value_si, displacement_si;
};
DiscUnits discUnits(DiscTest::Quantity quantity);

// Of the discs between the skeleton's bones (spineBodies): tests of discs alone of the disc's
// region: the rows to fit, those of quantities that have none, or all of them. Curves are made if
// asked for: of each loading, up to the largest load of the region's tests that is not beyond twice
// that of the row to fit. The axial preload of the second matrix is `preload` [N] on L4/L5 and the
// same mean stress elsewhere. progress (share done, 0 to 1) may be empty. Throws Error.
std::vector<DiscReport> benchDiscs(const Anatomy& anatomy, const Skeleton& skeleton,
                                   const std::vector<Disc>& discs, bool all_tests, bool curves,
                                   double preload, int threads,
                                   const std::function<void(double)>& progress);

}  // namespace torso::tools
