// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/ligament.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace torso {
namespace {

using Eigen::Vector3d;

class LigamentTest : public ::testing::Test {
 protected:
  const Anatomy anatomy = Anatomy::load(TORSO_ANATOMY_DIR);
  const std::vector<LigamentSegment> segments = makeLigaments(anatomy);
  std::map<std::string, const LigamentSegment*> by_name = [this] {
    std::map<std::string, const LigamentSegment*> map;
    for (const LigamentSegment& s : segments) map[s.name] = &s;
    return map;
  }();
};

TEST_F(LigamentTest, EachIsAChainOver22Gaps) {
  EXPECT_EQ(by_name.size(), 440u) << "names are unique";
  std::map<std::string, std::vector<const LigamentSegment*>> chains;
  for (const LigamentSegment& s : segments) chains[s.ligament].push_back(&s);
  EXPECT_EQ(chains.size(), 20u);
  for (const auto& [name, chain] : chains) {
    ASSERT_EQ(chain.size(), 22u) << name;
    EXPECT_EQ(chain.front()->lower, "S1");
    EXPECT_EQ(chain.back()->upper, "C3");
    for (std::size_t i = 1; i < chain.size(); i++) EXPECT_EQ(chain[i]->lower, chain[i - 1]->upper);
  }
}

TEST_F(LigamentTest, IsSlackAtRestByItsRatio) {
  for (const LigamentSegment& s : segments) {
    const double length = (s.upper_point - s.lower_point).norm();
    const auto ligament = std::find_if(anatomy.ligaments.begin(), anatomy.ligaments.end(),
                                       [&](const Ligament& l) { return l.name == s.ligament; });
    ASSERT_NE(ligament, anatomy.ligaments.end()) << s.ligament;
    EXPECT_GT(length, 1e-3) << s.name;
    EXPECT_LT(length, 0.08) << s.name << ": longer than a level is high";
    const double ratio = ligament->max_length_ratio.at(s.upper + "/" + s.lower);
    EXPECT_GT(ratio, 1) << s.name;
    EXPECT_NEAR(s.max_length, ratio * length, 1e-12) << s.name;
  }
}

TEST_F(LigamentTest, RunsUpwardsAlongTheDiscsAxis) {
  for (const Disc& disc : anatomy.discs) {
    for (const LigamentSegment& s : segments) {
      if (s.lower != disc.lower) continue;
      const Vector3d up = s.upper_point - s.lower_point;
      EXPECT_GT(up.dot(disc.frame.linear().col(2)), 0) << s.name;
    }
  }
}

TEST_F(LigamentTest, RightIsTheMirrorOfLeftAndMidIsInTheMiddle) {
  int pairs = 0, middle = 0;
  for (const LigamentSegment& s : segments) {
    const std::size_t at = s.name.find("_left");
    if (at != std::string::npos) {
      std::string name = s.name;
      name.replace(at, 5, "_right");
      ASSERT_EQ(by_name.count(name), 1u) << name;
      EXPECT_EQ(mirror(s.lower_point), by_name[name]->lower_point) << name;
      EXPECT_EQ(mirror(s.upper_point), by_name[name]->upper_point) << name;
      EXPECT_GT(s.lower_point.y(), 0) << s.name;
      EXPECT_GT(s.upper_point.y(), 0) << s.name;
      pairs++;
    } else if (s.name.find("_right") == std::string::npos) {
      EXPECT_EQ(s.lower_point.y(), 0) << s.name;
      EXPECT_EQ(s.upper_point.y(), 0) << s.name;
      middle++;
    }
  }
  EXPECT_EQ(pairs, 8 * 22);
  EXPECT_EQ(middle, 4 * 22);
}

// From front to back: ALL, disc, PLL, ligamentum flavum, interspinous, supraspinous.
TEST_F(LigamentTest, LayersFollowEachOtherFromFrontToBack) {
  for (const Disc& disc : anatomy.discs) {
    if (disc.upper == anatomy.c2.name) continue;
    const auto x = [&](const std::string& ligament) {
      const LigamentSegment& s = *by_name.at(ligament + "_" + disc.name);
      return (disc.frame.inverse() * (0.5 * (s.lower_point + s.upper_point))).x();
    };
    EXPECT_GT(x("ALL_mid"), 0) << disc.name;
    EXPECT_LT(x("PLL_mid"), 0) << disc.name;
    EXPECT_LT(x("LF_med_left"), x("PLL_mid")) << disc.name;
    EXPECT_LT(x("ISL"), x("LF_med_left")) << disc.name;
    EXPECT_LT(x("SSL_nuchal"), x("ISL")) << disc.name;
  }
}

}  // namespace
}  // namespace torso
