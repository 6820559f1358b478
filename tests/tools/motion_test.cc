// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Motions as files: what is read back, by our own reader or by assimp, is the motion of the model.

#include <gtest/gtest.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>

#include "tools/error.h"
#include "tools/files.h"
#include "tools/motion_bvh.h"
#include "tools/motion_file.h"
#include "tools/motion_glb.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Eigen::Matrix4d;

const mjModel* human() {
  static const ModelPtr m = loadModel(TORSO_MJCF "/human.xml");
  return m.get();
}

// Joints turn at random, a little, and the whole body goes along x.
Motion someMotion(int frames) {
  const mjModel* m = human();
  Motion motion;
  motion.rate = 24;
  motion.columns = qposColumns(m);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 0.1);
  std::vector<mjtNum> velocity(m->nv);
  for (int frame = 0; frame < frames; frame++) {
    std::vector<mjtNum> qpos(m->qpos0, m->qpos0 + m->nq);
    for (int j = 0; j < m->njnt; j++) {
      const bool is_free = m->jnt_type[j] == mjJNT_FREE;
      mjtNum* v = velocity.data() + m->jnt_dofadr[j];
      if (is_free) v[0] = 0.1 * frame, v[1] = v[2] = 0;
      for (int k = 0; k < 3; k++) v[(is_free ? 3 : 0) + k] = normal(random);
    }
    mj_integratePos(m, qpos.data(), velocity.data(), 1);
    motion.qpos.insert(motion.qpos.end(), qpos.begin(), qpos.end());
  }
  return motion;
}

class MotionFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("motion_test_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    writeFile(path, content);
    return path;
  }
  std::string messageOf(const std::string& content) {
    try {
      readMotion(write("broken", content));
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(MotionFile, BothFormatsComeBackBitForBit) {
  const Motion motion = someMotion(5);
  for (const std::string& content : {motionCsv(motion), motionBinary(motion)}) {
    const Motion back = readMotion(write("any.name", content));
    EXPECT_EQ(back.rate, motion.rate);
    EXPECT_EQ(back.columns, motion.columns);
    EXPECT_EQ(back.qpos, motion.qpos);
  }
}

TEST_F(MotionFile, DamagedFilesAreRefusedByName) {
  const Motion motion = someMotion(3);
  const std::string csv = motionCsv(motion), binary = motionBinary(motion);
  EXPECT_NE(messageOf("").find("not a motion"), std::string::npos);
  EXPECT_NE(messageOf("{\"format\": 3}\n").find("not a motion"), std::string::npos);
  EXPECT_NE(messageOf(binary.substr(0, binary.size() - 8)).find("cut off"), std::string::npos);
  EXPECT_NE(messageOf(csv.substr(0, csv.size() - 30)).find("cells"), std::string::npos);
  EXPECT_NE(messageOf(csv + "x" + std::string(motion.columns.size(), ',') + "\n").find(":6: "),
            std::string::npos);
  Motion bad = motion;
  bad.qpos[100] = NAN;
  EXPECT_NE(messageOf(motionBinary(bad)).find("finite"), std::string::npos);
}

TEST_F(MotionFile, GoesToModelsByTheNamesOfJoints) {
  const ModelPtr arm = compileModel(
      "<mujoco><worldbody><body><joint name='other'/><geom size='1'/>"
      "<body><joint name='left_knee' type='ball'/><geom size='1'/></body></body></worldbody>"
      "</mujoco>",
      "arm");
  Motion motion;
  motion.rate = 10;
  motion.columns = {"left_knee:qw", "left_knee:qx", "left_knee:qy", "left_knee:qz"};
  motion.qpos = {1, 0, 0, 0, 0, 1, 0, 0};
  const Motion on_arm = motionOf(arm.get(), motion, "file");
  EXPECT_EQ(on_arm.qpos, (std::vector<double>{0, 1, 0, 0, 0, 0, 0, 1, 0, 0}));
  motion.columns[0] = "tail";
  EXPECT_THROW(motionOf(arm.get(), motion, "file"), Error);

  // Half way between two frames a quarter turn of half a turn's two ends.
  mjtNum qpos[5];
  motionAt(arm.get(), on_arm, 0.05, qpos);
  EXPECT_NEAR(std::abs(qpos[1]), std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(std::abs(qpos[2]), std::sqrt(0.5), 1e-9);
}

Matrix4d matrix(const aiMatrix4x4& a) {
  Matrix4d m;
  m << a.a1, a.a2, a.a3, a.a4, a.b1, a.b2, a.b3, a.b4, a.c1, a.c2, a.c3, a.c4, a.d1, a.d2, a.d3,
      a.d4;
  return m;
}

// World pose of a node with all animated nodes as in a frame.
Matrix4d poseInFrame(const aiScene* scene, const aiNode* node, unsigned frame) {
  Matrix4d local = matrix(node->mTransformation);
  const aiAnimation* animation = scene->mAnimations[0];
  for (unsigned c = 0; c < animation->mNumChannels; c++) {
    const aiNodeAnim* channel = animation->mChannels[c];
    if (channel->mNodeName != node->mName) continue;
    const aiQuaternion q =
        channel->mRotationKeys[std::min(frame, channel->mNumRotationKeys - 1)].mValue;
    const aiVector3D p =
        channel->mPositionKeys[std::min(frame, channel->mNumPositionKeys - 1)].mValue;
    local.setIdentity();
    local.topLeftCorner<3, 3>() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
    local.topRightCorner<3, 1>() = Eigen::Vector3d(p.x, p.y, p.z);
  }
  return node->mParent ? poseInFrame(scene, node->mParent, frame) * local : local;
}

struct Placed {
  Eigen::Vector3d position;
  Eigen::Matrix3d rotation;
};

Placed placed(const mjData* d, int body) {
  Placed result;
  result.position = Eigen::Map<const Eigen::Vector3d>(d->xpos + 3 * body);
  result.rotation =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->xmat + 9 * body);
  return result;
}

TEST_F(MotionFile, GlbShowsEveryBoneWhereTheModelHasIt) {
  const mjModel* m = human();
  const Motion motion = someMotion(3);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(write("motion.glb", motionGlb(m, motion)), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumAnimations, 1u);
  const DataPtr d = makeData(m);
  int bones = 0;
  for (unsigned frame = 0; frame < 3; frame++) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    for (int b = 1; b < m->nbody; b++) {
      const aiNode* node = scene->mRootNode->FindNode(nameOf(m, mjOBJ_BODY, b).c_str());
      if (!node) continue;
      bones++;
      const Matrix4d X = poseInFrame(scene, node, frame);
      const Placed bone = placed(d.get(), b);
      // y up: x, z, -y
      const Eigen::Vector3d expected(bone.position.x(), bone.position.z(), -bone.position.y());
      EXPECT_LT((X.topRightCorner<3, 1>() - expected).norm(), 1e-5) << node->mName.C_Str();
    }
  }
  EXPECT_EQ(bones, 3 * 41);  // 24 free bodies and 17 on ball joints, each with its mesh
}

TEST_F(MotionFile, BvhTurnsEveryBoneAsTheModelDoes) {
  const mjModel* m = human();
  const Motion motion = someMotion(3);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(write("motion.bvh", motionBvh(m, motion)), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  const DataPtr rest = makeData(m), d = makeData(m);
  mj_kinematics(m, rest.get());
  Eigen::Matrix3d P;  // x left, y up, z forward
  P << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  int bones = 0;
  for (unsigned frame = 0; frame < 3; frame++) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    for (int b = 1; b < m->nbody; b++) {
      if (m->body_jntnum[b] == 0) continue;
      const aiNode* node = scene->mRootNode->FindNode(nameOf(m, mjOBJ_BODY, b).c_str());
      ASSERT_NE(node, nullptr) << nameOf(m, mjOBJ_BODY, b);
      bones++;
      const Eigen::Matrix3d turn = P * placed(d.get(), b).rotation *
                                   placed(rest.get(), b).rotation.transpose() * P.transpose();
      EXPECT_LT((poseInFrame(scene, node, frame).topLeftCorner<3, 3>() - turn).norm(), 1e-3)
          << node->mName.C_Str();
    }
  }
  EXPECT_EQ(bones, 3 * 41);
}

}  // namespace
}  // namespace torso::tools
