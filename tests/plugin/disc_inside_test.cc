// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What the C interface tells of the inside of discs.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <string>
#include <vector>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class DiscInsideTest : public PluginTest {
 protected:
  DiscInsideTest() {
    std::string text = modelText("torso.xml");
    fixPelvis(&text);
    m = loadText(text);
    d = makeData(m.get());
    randomControls(m.get(), d.get(), 0.3, 5);
    for (int i = 0; i < 300; i++) mj_step(m.get(), d.get());
    mj_forward(m.get(), d.get());
    count = torsoOf(m.get()).ndisc;
  }

  struct Inside {
    std::vector<Vector3d> nodes, rest;
    std::vector<int> tets, cells;
    std::vector<Matrix3d> stress;
    std::vector<mjtNum> stretch;
  };
  Inside inside(const mjData* data, int disc) const {
    int nnode, ntet;
    EXPECT_EQ(torso_discSize(m.get(), disc, &nnode, &ntet), 0);
    Inside in = {std::vector<Vector3d>(nnode), std::vector<Vector3d>(nnode),
                 std::vector<int>(4 * ntet),   std::vector<int>(ntet),
                 std::vector<Matrix3d>(ntet),  std::vector<mjtNum>(2 * ntet)};
    EXPECT_EQ(torso_discNodes(m.get(), data, disc, in.nodes[0].data()), 0);
    EXPECT_EQ(torso_discRest(m.get(), disc, in.rest[0].data()), 0);
    EXPECT_EQ(torso_discTets(m.get(), disc, in.tets.data()), 0);
    EXPECT_EQ(torso_discCells(m.get(), disc, in.cells.data()), 0);
    EXPECT_EQ(torso_discStress(m.get(), data, disc, in.stress[0].data(), in.stretch.data()), 0);
    return in;
  }

  ModelPtr m;
  DataPtr d;
  int count;
};

TEST_F(DiscInsideTest, FrameIsTheLowerSite) {
  for (int i = 0; i < count; i++) {
    mjtNum pos[3], mat[9];
    ASSERT_EQ(torso_discFrame(m.get(), d.get(), i, pos, mat), 0);
    const std::string name = std::string(torso_discName(m.get(), i)) + "_lower";
    const int site = mj_name2id(m.get(), mjOBJ_SITE, name.c_str());
    ASSERT_GE(site, 0) << name;
    for (int k = 0; k < 3; k++) EXPECT_NEAR(pos[k], d->site_xpos[3 * site + k], 1e-12);
    for (int k = 0; k < 9; k++) EXPECT_NEAR(mat[k], d->site_xmat[9 * site + k], 1e-12);
  }
}

// In the start pose the discs are as at rest, without stress.
TEST_F(DiscInsideTest, RestIsTheStartPose) {
  const DataPtr start = makeData(m.get());
  mj_forward(m.get(), start.get());
  for (int i = 0; i < count; i++) {
    const Inside in = inside(start.get(), i);
    mjtNum pos[3], mat[9];
    ASSERT_EQ(torso_discFrame(m.get(), start.get(), i, pos, mat), 0);
    const Eigen::Map<const Eigen::Matrix<mjtNum, 3, 3, Eigen::RowMajor>> R(mat);
    for (std::size_t k = 0; k < in.nodes.size(); k++) {
      const Vector3d expected = Vector3d(pos[0], pos[1], pos[2]) + R * in.rest[k];
      EXPECT_LT((in.nodes[k] - expected).norm(), 1e-6);
    }
    for (const Matrix3d& s : in.stress) EXPECT_LT(s.norm(), 2e4);
    for (mjtNum s : in.stretch) EXPECT_NEAR(s, 1, 2e-3);
  }
}

TEST_F(DiscInsideTest, SkinBearsTheDiscsName) {
  for (int i = 0; i < count; i++) {
    const int skin = torso_discSkin(m.get(), i);
    ASSERT_GE(skin, 0);
    EXPECT_STREQ(mj_id2name(m.get(), mjOBJ_SKIN, skin), torso_discName(m.get(), i));
  }
}

// Principle of virtual work with a motion w that is 1 on the upper endplate and 0 on the lower one:
// the force on the upper bone is minus the integral of stress times grad w. Over the nodes between,
// which bear no load, w may be anything; the mesh's five layers of nodes come one after the other.
TEST_F(DiscInsideTest, StressBalancesTheForceOnTheBone) {
  for (int i = 0; i < count; i++) {
    const Inside in = inside(d.get(), i);
    const std::size_t layer = in.nodes.size() / 5;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t e = 0; e < in.cells.size(); e++) {
      Eigen::Matrix4d corners;
      Eigen::RowVector4d w;
      for (int k = 0; k < 4; k++) {
        const int node = in.tets[4 * e + k];
        corners.col(k) << 1, in.nodes[node];
        w[k] = static_cast<double>(node / layer) / 4;
      }
      const Vector3d gradient = (w * corners.inverse()).tail<3>();
      sum -= corners.determinant() / 6 * in.stress[e] * gradient;
    }
    mjtNum force[3];
    ASSERT_EQ(torso_discWrench(m.get(), d.get(), i, force, nullptr, nullptr), 0);
    const Vector3d expected(force[0], force[1], force[2]);
    EXPECT_LT((sum - expected).norm(), 0.03 * expected.norm()) << torso_discName(m.get(), i);
  }
}

TEST_F(DiscInsideTest, NullAndOutOfRange) {
  int ntet;
  torso_discSize(m.get(), 0, nullptr, &ntet);
  std::vector<mjtNum> stretch(2 * ntet);
  EXPECT_EQ(torso_discStress(m.get(), d.get(), 0, nullptr, stretch.data()), 0);
  EXPECT_EQ(stretch, inside(d.get(), 0).stretch);
  EXPECT_EQ(torso_discStress(m.get(), d.get(), 0, nullptr, nullptr), 0);
  mjtNum x[9];
  int cell;
  EXPECT_EQ(torso_discStress(m.get(), d.get(), count, x, x), -1);
  EXPECT_EQ(torso_discRest(m.get(), -1, x), -1);
  EXPECT_EQ(torso_discFrame(m.get(), d.get(), count, x, x), -1);
  EXPECT_EQ(torso_discCells(m.get(), count, &cell), -1);
  EXPECT_EQ(torso_discSkin(m.get(), count), -1);
  char error[100];
  torso_lastError(error, sizeof error);
  EXPECT_STREQ(error, "disc 23 does not exist, there are 23");
}

}  // namespace
}  // namespace torso
