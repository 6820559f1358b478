// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The shipped material against the published ranges.

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "model/anatomy.h"
#include "model/disc_bench.h"
#include "model/disc_fit.h"
#include "tools/bone_files.h"

namespace torso {
namespace {

// Every disc is inside the published range of every test that its material is fitted to, but for
// the exceptions: an exception that has come inside is a failure, too.
TEST(DiscRanges, EveryDiscIsInsideThePublishedRanges) {
  const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  // Cervical discs: bending as stiff as Moroney et al. 1988 measured (joints of the uncinate
  // processes included, which these discs have not) asks for more shear stiffness than they
  // measured, and for more fibre than torsion allows.
  const std::set<std::string> exceptions = {"C5/C6 posterior_shear", "C5/C6 extension",
                                            "C5/C6 axial_torsion",   "C4/C5 posterior_shear",
                                            "C4/C5 extension",       "C3/C4 posterior_shear",
                                            "C3/C4 extension",       "C3/C4 lateral_bending",
                                            "C2/C3 posterior_shear", "C2/C3 extension"};
  const Skeleton skeleton =
      tools::readSkeleton(anatomy, TORSO_MJCF "/assets", tools::spineBodies(anatomy));
  int tests = 0;
  for (const Disc& disc : anatomy.discs) {
    const DiscBench bench(fittedDiscMesh(anatomy, skeleton, disc), disc.material);
    for (const DiscTest& test : anatomy.disc_tests) {
      // Of preload ratios there is no publication for human discs alone.
      if (test.region != disc.region || !test.fit ||
          test.quantity == DiscTest::Quantity::kPreloadRatio) {
        continue;
      }
      const double ours = simulateDiscTest(bench, disc.retardation_time, test);
      const std::string name = disc.name + " " + discQuantityName(test.quantity);
      EXPECT_EQ(insideRange(test, ours), exceptions.count(name) == 0)
          << name << ": " << ours << " is not in " << test.low << " to " << test.high;
      tests++;
    }
  }
  EXPECT_EQ(tests, 17 * 11 + 6 * 10);  // cervical tension is not fitted
}

}  // namespace
}  // namespace torso
