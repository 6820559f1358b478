// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/anatomy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "model/facet.h"
#include "model/ligament.h"
#include "tests/model/anatomy_copy.h"

namespace torso {
namespace {

using Eigen::Vector3d;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180;

class AnatomyTest : public ::testing::Test {
 protected:
  static const Anatomy& anatomy() {
    static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
    return a;
  }
};

TEST_F(AnatomyTest, IsAManOf170CentimetresAnd72Kilograms) {
  EXPECT_NEAR(anatomy().mass(), 72.0, 0.5);
  EXPECT_NEAR(anatomy().stature(), 1.70, 0.01);
}

TEST_F(AnatomyTest, HasTheCountsOfTheDesign) {
  const Anatomy& a = anatomy();
  EXPECT_EQ(a.vertebrae.size(), 22u);
  EXPECT_EQ(a.discs.size(), 23u);
  EXPECT_EQ(a.ligaments.size(), 20u);
  EXPECT_EQ(makeLigaments(a).size(), 440u);
  EXPECT_EQ(makeFacets(a).size(), 74u);
  EXPECT_EQ(2 * a.joints.size() - 1, 17u);  // all but the head's are a pair
  EXPECT_EQ(a.c2.name, "C2");
}

TEST_F(AnatomyTest, LevelsFollowEachOtherFromBelow) {
  const Anatomy& a = anatomy();
  std::string below = "S1";
  double z = 0;
  for (std::size_t i = 0; i < a.discs.size(); i++) {
    const Disc& disc = a.discs[i];
    const Vertebra& above = i < a.vertebrae.size() ? a.vertebrae[i] : a.c2;
    EXPECT_EQ(disc.lower, below);
    EXPECT_EQ(disc.upper, above.name);
    EXPECT_EQ(disc.name, above.name + "/" + below);
    EXPECT_GT(disc.frame.translation().z(), z);
    EXPECT_GT(above.position.z(), disc.frame.translation().z());
    below = above.name;
    z = above.position.z();
  }
}

// The disc fills the gap: its two faces lie on the endplates of its bones.
TEST_F(AnatomyTest, DiscsTouchBothEndplates) {
  const Anatomy& a = anatomy();
  for (const Disc& disc : a.discs) {
    const double half = 0.25 * (disc.shape.height_anterior + disc.shape.height_posterior);
    const Vector3d up = disc.frame.linear().col(2);
    const auto endplate = [&](const std::string& level, bool upper) -> Vector3d {
      if (level == "S1") return Vector3d::Zero();
      const Vertebra& v = a.vertebra(level);
      const double h = 0.25 * (v.body_height_anterior + v.body_height_posterior);
      return v.frame() * Vector3d(0, 0, upper ? h : -h);
    };
    // C2's body centre is that of its body without the dens, whose height the table does not give.
    EXPECT_LT((disc.frame.translation() - half * up - endplate(disc.lower, true)).norm(), 1e-3)
        << disc.name;
    if (disc.upper == "C2") continue;
    EXPECT_LT((disc.frame.translation() + half * up - endplate(disc.upper, false)).norm(), 1e-3)
        << disc.name;
  }
}

// Standing radiographs of 300 asymptomatic adults, Vialle et al. 2005, J Bone Joint Surg Am
// 87:260-267, mean +- one standard deviation; C2-C7 from reviews of asymptomatic adults.
TEST_F(AnatomyTest, SagittalCurvesAreThoseOfStandingAdults) {
  const Anatomy& a = anatomy();
  const double L1 = a.vertebra("L1").upper_endplate_pitch / kDegree;
  const double slope = a.sacral_slope / kDegree;
  EXPECT_NEAR(slope, 41, 8.4);
  EXPECT_NEAR(slope - L1, 60, 10);  // lumbar lordosis
  EXPECT_NEAR(
      (a.vertebra("T4").upper_endplate_pitch - a.vertebra("T12").lower_endplate_pitch) / kDegree,
      41, 10);  // thoracic kyphosis
  EXPECT_NEAR(
      (a.vertebra("C7").lower_endplate_pitch - a.vertebra("C2").lower_endplate_pitch) / kDegree, 15,
      11);  // cervical lordosis
  EXPECT_NEAR(a.vertebra("T1").upper_endplate_pitch / kDegree, 25, 8);
}

TEST_F(AnatomyTest, DiscsLieInTheRangeOfMeasurements) {
  for (const Disc& disc : anatomy().discs) {
    const double height = 0.5 * (disc.shape.height_anterior + disc.shape.height_posterior);
    EXPECT_GT(height, 0.0035) << disc.name;  // upper thorax and neck, 4-6 mm
    EXPECT_LT(height, 0.0135) << disc.name;  // lower lumbar, 10-12 mm
    EXPECT_GT(disc.shape.width, 0.95 * disc.shape.depth) << disc.name;
    EXPECT_EQ(checkDiscMaterial(disc.material), "") << disc.name;
    EXPECT_GT(disc.retardation_time, 0) << disc.name;
  }
}

TEST_F(AnatomyTest, EveryLevelHasARangeOfMotionAndAFacet) {
  const Anatomy& a = anatomy();
  std::set<std::string> with_facet;
  for (const ArticularFacet& f : a.facets) {
    with_facet.insert(f.level);
    EXPECT_NEAR(f.normal.norm(), 1, 1e-12);
    EXPECT_GT(f.position.y(), 0) << f.level;
    EXPECT_LT(f.position.x(), 0) << f.level << ": facets lie behind the body";
    EXPECT_LT(f.normal.x(), 0) << f.level << ": superior facets look back";
    EXPECT_GT(f.normal.z(), 0) << f.level << ": superior facets look up";
  }
  for (const Disc& disc : a.discs) {
    EXPECT_EQ(a.range_of_motion.count(disc.name), 1u) << disc.name;
    EXPECT_EQ(with_facet.count(disc.lower), 1u) << disc.lower;
  }
}

// The 492 N/mm and 0.42 Nm/deg of cervical discs that Moroney et al. 1988 measured.
TEST_F(AnatomyTest, DiscTestsAreInSiUnits) {
  using Quantity = DiscTest::Quantity;
  const auto find = [](Quantity quantity) {
    for (const DiscTest& test : anatomy().disc_tests) {
      if (test.region == Region::kCervical && test.quantity == quantity && !test.whole_segment &&
          test.source == "Moroney 1988") {
        return test;
      }
    }
    throw std::runtime_error("no such test");
  };
  EXPECT_NEAR(find(Quantity::kCompression).value, 492e3, 1e-6);
  EXPECT_NEAR(find(Quantity::kCompression).load, 73.6, 1e-12);
  EXPECT_NEAR(find(Quantity::kAxialTorsion).value, 24.06, 0.01);
  EXPECT_NEAR(find(Quantity::kAxialTorsion).preload, 49, 1e-12);
}

TEST_F(AnatomyTest, EveryQuantityOfARegionHasOneDiscTestToFit) {
  std::map<std::pair<Region, DiscTest::Quantity>, int> fits;
  for (const DiscTest& test : anatomy().disc_tests) {
    if (!test.fit) continue;
    fits[{test.region, test.quantity}]++;
    EXPECT_FALSE(test.whole_segment);
  }
  EXPECT_EQ(fits.size(), 3u * 12u - 1);
  for (const auto& [what, count] : fits) EXPECT_EQ(count, 1);
}

// A whole segment adds facets and ligaments to its disc. Tests of the two agree with that where one
// publication measured both under the same loads; posterior shear is equal within the rounding.
TEST_F(AnatomyTest, WholeSegmentsAreStifferThanTheirDiscs) {
  int compared = 0;
  for (const DiscTest& segment : anatomy().disc_tests) {
    for (const DiscTest& disc : anatomy().disc_tests) {
      if (!segment.whole_segment || disc.whole_segment || segment.source != disc.source ||
          segment.quantity != disc.quantity ||
          segment.quantity == DiscTest::Quantity::kPreloadRatio) {
        continue;
      }
      EXPECT_GT(segment.value, 0.97 * disc.value) << disc.source;
      compared++;
    }
  }
  EXPECT_EQ(compared, 8);
}

TEST_F(AnatomyTest, DiscTestsTellWhereTheyComeFrom) {
  for (const DiscTest& test : anatomy().disc_tests) {
    EXPECT_THAT(test.provenance, AnyOf("measured", "quoted", "recalled", "blend", "assumed"));
    EXPECT_NE(test.source, "");
    EXPECT_NE(test.note, "") << test.source;
  }
}

TEST_F(AnatomyTest, MirrorKeepsTheFlowOfARotation) {
  const Vector3d axis = Vector3d(0.3, -0.5, 0.8).normalized(), point(0.1, 0.2, 0.3);
  const Eigen::AngleAxisd turn(0.7, axis), mirrored_turn(0.7, mirrorAxis(axis));
  EXPECT_LT((mirror(turn * point) - mirrored_turn * mirror(point)).norm(), 1e-15);
}

TEST_F(AnatomyTest, UnknownNamesAreNamed) {
  const auto message = [](auto call) -> std::string {
    try {
      call();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(message([] { anatomy().vertebra("T13"); }), "anatomy: no vertebra is called 'T13'");
  EXPECT_EQ(message([] { anatomy().landmark("tail"); }), "anatomy: no landmark is called 'tail'");
  EXPECT_EQ(message([] { anatomy().segment("wing"); }), "anatomy: no segment is called 'wing'");
}

// Damage to a table is reported with its file, its line and its column.
class DamagedAnatomyTest : public ::testing::Test {
 protected:
  std::string loadError() const {
    try {
      Anatomy::load(copy.folder());
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "no error";
  }
  AnatomyCopy copy{TORSO_ANATOMY_DIR};
};

TEST_F(DamagedAnatomyTest, IntactCopyLoads) { EXPECT_EQ(loadError(), "no error"); }

TEST_F(DamagedAnatomyTest, MissingTable) {
  copy.remove("facets.csv");
  EXPECT_EQ(loadError(), copy.path("facets.csv") + ": cannot read this anatomy table");
}

TEST_F(DamagedAnatomyTest, WordWhereANumberMustBe) {
  const int line = copy.replace("discs.csv", "L4/L5,L4,L5,48.4,", "L4/L5,L4,L5,wide,");
  EXPECT_EQ(loadError(), copy.path("discs.csv") + ":" + std::to_string(line) +
                             ": column 'width_mm' holds 'wide', which is not a number");
}

TEST_F(DamagedAnatomyTest, NumberThatIsNotFinite) {
  const int line = copy.replace("discs.csv", "L4/L5,L4,L5,48.4,", "L4/L5,L4,L5,nan,");
  EXPECT_EQ(loadError(), copy.path("discs.csv") + ":" + std::to_string(line) +
                             ": column 'width_mm' holds 'nan', which is not a number");
}

TEST_F(DamagedAnatomyTest, MissingCell) {
  const int line = copy.replace("costal_joints.csv", "T1,costovertebral,", "T1,");
  EXPECT_THAT(loadError(), HasSubstr(copy.path("costal_joints.csv") + ":" + std::to_string(line) +
                                     ": 5 cells, the header has 6"));
}

TEST_F(DamagedAnatomyTest, MissingColumn) {
  copy.replace("disc_materials.csv", "mpa,retardation_time_s", "mpa,delay");
  EXPECT_EQ(loadError(),
            copy.path("disc_materials.csv") + ": the table has no column 'retardation_time_s'");
}

TEST_F(DamagedAnatomyTest, MissingLandmark) {
  copy.replace("landmarks.csv", "elbow,", "ellbow,");
  EXPECT_EQ(loadError(), "anatomy: no landmark is called 'elbow'");
}

TEST_F(DamagedAnatomyTest, DiscTooFew) {
  copy.eraseLine("discs.csv", "L4/L5,");
  EXPECT_EQ(loadError(),
            copy.folder() + "/discs.csv: 22 discs for 22 free vertebrae; there must be one more");
}

TEST_F(DamagedAnatomyTest, DiscTestThatCannotBe) {
  const std::string row = "cervical,compression,disc,73.6,0,492,246,984,N/mm,1,";
  const std::pair<std::string, std::string> damages[] = {
      {"sacral,compression,disc,73.6,0,492,246,738,N/mm,1,",
       ": column 'region' holds 'sacral', which is none of lumbar, thoracic, cervical"},
      {"cervical,squeeze,disc,73.6,0,492,246,738,N/mm,1,",
       ": column 'quantity' holds 'squeeze', which is none of compression, tension, "},
      {"cervical,compression,bone,73.6,0,492,246,738,N/mm,1,",
       ": column 'specimen' holds 'bone', which is none of disc, fsu"},
      {"cervical,compression,disc,73.6,0,492,246,738,Nm/deg,1,",
       ": column 'unit' holds 'Nm/deg', which is none of N/mm"},
      {"cervical,compression,disc,73.6,0,492,246,738,N/mm,yes,",
       ": column 'fit' holds 'yes', which is none of 0, 1"},
      {"cervical,compression,disc,some,0,492,246,738,N/mm,1,",
       ": column 'load' holds 'some', which is not a number"},
      {"cervical,compression,disc,73.6,0,492,500,738,N/mm,1,",
       ": value must be positive and from low to high"},
      {"cervical,compression,disc,73.6,0,492,246,400,N/mm,1,",
       ": value must be positive and from low to high"},
      {"cervical,compression,disc,73.6,0,0,0,738,N/mm,1,",
       ": value must be positive and from low to high"},
      {"cervical,compression,disc,-1,0,492,246,738,N/mm,1,",
       ": load and preload_n must not be negative"},
      {"cervical,compression,disc,73.6,0,492,,738,N/mm,1,", ": a row to fit needs low and high"},
  };
  for (const auto& [damaged, message] : damages) {
    const int line = copy.replace("disc_tests.csv", row, damaged);
    EXPECT_THAT(loadError(),
                HasSubstr(copy.path("disc_tests.csv") + ":" + std::to_string(line) + message));
    copy.replace("disc_tests.csv", damaged, row);
  }
  EXPECT_EQ(loadError(), "no error");
}

TEST_F(DamagedAnatomyTest, DiscTestWithoutPublishedBoundsIsUnbounded) {
  copy.replace("disc_tests.csv", "cervical,compression,disc,73.6,0,492,246,984,N/mm,1,",
               "cervical,compression,disc,73.6,0,492,,,N/mm,0,");
  for (const DiscTest& test : Anatomy::load(copy.folder()).disc_tests) {
    EXPECT_LE(test.low, test.value);
    EXPECT_LE(test.value, test.high);
  }
}

TEST_F(DamagedAnatomyTest, LastVertebraIsNotC2) {
  copy.eraseLine("vertebrae.csv", "C2,");
  EXPECT_EQ(loadError(), copy.folder() + "/vertebrae.csv: the last row must be C2");
}

}  // namespace
}  // namespace torso
