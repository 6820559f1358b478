// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_batch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <new>
#include <random>
#include <thread>

#include "model/disc_elasticity.h"
#include "model/disc_group.h"
#include "model/disc_reference.h"
#include "tests/model/disc_test_util.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Counts every allocation of the program, those of libraries too.
#define TORSO_COUNT_ALLOCATIONS
static std::atomic<long> allocations{0};
extern "C" {
void* __libc_malloc(size_t);
void* __libc_memalign(size_t, size_t);
void* malloc(size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
void* aligned_alloc(size_t alignment, size_t n) {
  ++allocations;
  return __libc_memalign(alignment, n);
}
}
#endif

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const char* const kInstructionSets[] = {"portable", "avx2", "avx512"};

// Restores the instruction set that the machine's best program uses.
class DiscBatchTest : public testing::Test {
 protected:
  void TearDown() override { DiscBatch::setInstructionSet(best_); }
  std::string best_ = DiscBatch::instructionSet();
};

using DiscKernelsTest = DiscBatchTest;

std::vector<DiscBatch::Disc> spine(int count) {
  std::vector<DiscBatch::Disc> discs;
  for (int i = 0; i < count; ++i) {
    const double t = count > 1 ? static_cast<double>(i) / (count - 1) : 1;
    const DiscShape shape = {0.017 + 0.033 * t, 0.015 + 0.020 * t, 0.005 + 0.008 * t,
                             0.0045 + 0.005 * t};
    DiscMaterial material = kDiscMaterial;
    material.annulus_modulus = 2e6 + 2e6 * t;
    material.annulus_poisson = 0.40 + 0.05 * t;
    material.fibre_modulus = 15e6 - 10e6 * t;
    discs.push_back({makeDiscMesh(shape), material});
  }
  return discs;
}

// Difference of two wrenches over the size of the second; forces count at half the disc's depth.
double relativeError(const DiscWrench& a, const DiscWrench& b, double half_depth) {
  return (asVector(a, half_depth) - asVector(b, half_depth)).norm() /
         asVector(b, half_depth).norm();
}

// Iterates at fixed poses until nothing moves.
void converge(BatchRun& run) {
  DiscBatch::Options options;
  options.tolerance = 1e-6;
  options.max_iterations = 200;
  for (int i = 0; i < 2; ++i) run.evaluate(options);
}

DiscPose randomPose(std::mt19937& rng, double degrees, double mm) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vector3d(uniform(rng), uniform(rng), uniform(rng)); };
  const Vector3d rotation = degrees * vector(), position = mm * vector();
  return discPose(rotation, position);
}

// ---- local step ----

// Forces of each kernel against the plain ones, from small strains to tets turned inside out.
TEST_F(DiscKernelsTest, ForcesAreTheReferences) {
  const auto discs = spine(kLanes);
  std::vector<DiscElasticity> elasticities;
  std::vector<const DiscElasticity*> pointers;
  std::vector<const DiscMesh*> meshes;
  elasticities.reserve(kLanes);
  for (const auto& disc : discs) {
    elasticities.emplace_back(disc.mesh, disc.material);
    pointers.push_back(&elasticities.back());
    meshes.push_back(&disc.mesh);
  }
  std::mt19937 rng(1);
  std::normal_distribution<double> normal;
  for (const DiscKernels* kernels :
       {&kDiscKernelsPortable, &kDiscKernelsAvx2, &kDiscKernelsAvx512}) {
    if (!DiscBatch::setInstructionSet(kernels->name)) continue;
    const DiscGroup group(meshes, pointers, *kernels);
    const int nnode = group.view().nnode;
    LaneArray u(3 * nnode), f(3 * nnode), work(group.workSize() / kLanes), pressure(1);
    for (double strain : {0.01, 0.1, 0.5, 1.5}) {
      std::vector<Eigen::VectorXd> displacement;
      for (int lane = 0; lane < kLanes; ++lane) {
        Matrix3d A;
        for (int k = 0; k < 9; ++k) A(k) = strain * normal(rng);
        Eigen::VectorXd x(3 * nnode);
        for (int i = 0; i < 3 * nnode; i += 3) {
          x.segment<3>(i) = A * elasticities[lane].rest.segment<3>(i);
          for (int k = 0; k < 3; ++k) {
            x[i + k] = static_cast<float>(x[i + k] + 1e-4 * strain * normal(rng));
            u(3 * group.number()[i / 3] + k, lane) = static_cast<float>(x[i + k]);
          }
        }
        displacement.push_back(x);
      }
      kernels->forces(group.view(), u.data(), f.data(), pressure.data(), work.data());
      for (int lane = 0; lane < kLanes; ++lane) {
        Eigen::VectorXd expected;
        elasticities[lane].energy(displacement[lane], &expected);
        double error = 0;
        for (int i = 0; i < 3 * nnode; ++i) {
          const double actual = f(3 * group.number()[i / 3] + i % 3, lane);
          error = std::max(error, std::abs(actual - expected[i]));
        }
        EXPECT_LT(error, 2e-5 * expected.cwiseAbs().maxCoeff() + 0.01)
            << kernels->name << " " << strain;
        const double p = elasticities[lane].nucleusPressure(displacement[lane]);
        EXPECT_NEAR(pressure(0, lane), p, 1e-4 * std::abs(p));
      }
    }
  }
}

// ---- rest ----

TEST_F(DiscBatchTest, RestHasExactlyNoWrench) {
  for (const char* set : kInstructionSets) {
    if (!DiscBatch::setInstructionSet(set)) continue;
    BatchRun run(spine(11));
    EXPECT_EQ(run.evaluate(), 1);
    EXPECT_EQ(run.evaluate(), 0);  // nothing has moved
    for (const DiscWrench& w : run.wrenches) {
      EXPECT_EQ(w.force, Vector3d::Zero());
      EXPECT_EQ(w.moment, Vector3d::Zero());
      EXPECT_EQ(w.pressure, 0);
    }
    // The state is that of rest, but for saying that it has settled.
    double sum = 0;
    for (double x : run.state) sum += std::abs(x);
    EXPECT_EQ(sum, 11);
  }
}

TEST_F(DiscBatchTest, BoundIsTheReferences) {
  const auto discs = spine(3);
  const DiscBatch batch(discs);
  for (int i = 0; i < 3; ++i) {
    const ReferenceDisc reference(discs[i].mesh, discs[i].material);
    const auto& K = reference.elasticity().bound_stiffness;
    EXPECT_LT((batch.boundStiffness(i) - K).norm(), 1e-12 * K.norm());
  }
}

// A disc whose bones stand still is iterated until it has settled and then left alone; its wrench
// and state stay to the bit, whatever its neighbours do.
TEST_F(DiscBatchTest, NothingIsRecomputedWhereNothingMoves) {
  const auto discs = spine(9);  // two groups
  BatchRun run(discs);
  for (auto& pose : run.poses) pose = discPose({2, 4, 1}, {0.2, 0, -0.3});
  int evaluations = 0;
  while (run.evaluate() > 0) ASSERT_LT(++evaluations, 60);
  EXPECT_GT(evaluations, 2);
  const std::vector<double> state = run.state;
  const DiscWrench first = run.wrenches[0], last = run.wrenches[8];
  EXPECT_EQ(run.evaluate(), 0);
  EXPECT_EQ(run.state, state);
  run.poses[1] = discPose({3, 4, 1}, {0.2, 0, -0.3});  // of the first group
  EXPECT_GE(run.evaluate(), 1);
  EXPECT_EQ(run.wrenches[0].force, first.force);
  EXPECT_EQ(run.wrenches[0].nucleus_pressure, first.nucleus_pressure);
  EXPECT_EQ(run.wrenches[8].moment, last.moment);
  EXPECT_NE(run.state, state);
  run.poses[8] = discPose({2.1, 4, 1}, {0.2, 0, -0.3});
  run.evaluate();
  EXPECT_NE(run.wrenches[8].moment, last.moment);
  // Settled means converged.
  const ReferenceDisc::Method newton = ReferenceDisc::Method::kNewton;
  ReferenceDisc reference(discs[0].mesh, discs[0].material, newton);
  reference.solve(run.poses[0], 50, 1e-7);
  EXPECT_LT(relativeError(first, reference.wrench(), 0.01), 1e-4);
}

// ---- against the reference ----

TEST_F(DiscBatchTest, ConvergesToTheReference) {
  for (const char* set : kInstructionSets) {
    if (!DiscBatch::setInstructionSet(set)) continue;
    const auto discs = spine(8);
    BatchRun run(discs);
    std::mt19937 rng(5);
    double worst = 0, sum = 0;
    int count = 0;
    for (int repetition = 0; repetition < (best_ == set ? 6 : 1); ++repetition) {
      for (auto& pose : run.poses) pose = randomPose(rng, 6, 0.7);
      std::fill(run.state.begin(), run.state.end(), 0.0);
      converge(run);
      for (size_t i = 0; i < discs.size(); ++i) {
        ReferenceDisc reference(discs[i].mesh, discs[i].material);
        reference.solve(run.poses[i], 100, 1e-5);
        const double error = relativeError(run.wrenches[i], reference.wrench(), 0.01);
        worst = std::max(worst, error);
        sum += error;
        ++count;
        EXPECT_NEAR(run.wrenches[i].pressure, reference.wrench().pressure,
                    1e-3 * std::abs(reference.wrench().pressure) + 100);
        EXPECT_NEAR(run.wrenches[i].nucleus_pressure, reference.wrench().nucleus_pressure,
                    1e-3 * std::abs(reference.wrench().nucleus_pressure) + 500);

        std::vector<double> x(3 * discs[i].mesh.rest_positions.size());
        run.batch.positions(static_cast<int>(i), run.poses[i], run.state.data(), x.data());
        double distance = 0;
        for (size_t n = 0; n < discs[i].mesh.rest_positions.size(); ++n) {
          distance = std::max(distance,
                              (Eigen::Map<Vector3d>(&x[3 * n]) - reference.positions()[n]).norm());
        }
        EXPECT_LT(distance, 2e-5);  // 20 um
      }
    }
    printf("%s: %d random poses, relative error of the wrench: mean %.1e, worst %.1e\n", set, count,
           sum / count, worst);
    EXPECT_LT(worst, 5e-3);
    EXPECT_LT(sum / count, 5e-4);
  }
}

// At every step of a motion, one iteration from the last step's shape gives the force that belongs
// to the pose.
void checkMotion(double hertz, double degrees, double bound) {
  const DiscShape lumbar = {0.05, 0.035, 0.013, 0.009}, cervical = {0.018, 0.016, 0.006, 0.005};
  const std::vector<DiscBatch::Disc> discs = {{makeDiscMesh(lumbar), kDiscMaterial},
                                              {makeDiscMesh(cervical), kDiscMaterial}};
  for (int axis = 0; axis < 4; ++axis) {
    BatchRun run(discs);
    ReferenceDisc reference[2] = {{discs[0].mesh, kDiscMaterial}, {discs[1].mesh, kDiscMaterial}};
    double worst = 0;
    for (int step = 0; step <= hertz; ++step) {
      const double phase = 2 * M_PI * step / hertz;
      Vector3d rotation = Vector3d::Zero(), position = Vector3d::Zero();
      if (axis < 3) {
        rotation[axis] = degrees * std::sin(phase);
      } else {  // all axes, out of phase, and translations
        for (int k = 0; k < 3; ++k) {
          rotation[k] = degrees * std::sin(phase + k) * std::min(1.0, phase);
        }
        position = 0.3 * Vector3d(std::sin(2 * phase), std::sin(3 * phase), std::sin(phase));
      }
      for (auto& pose : run.poses) pose = discPose(rotation, position);
      run.evaluate();
      if (step % 15 != 7) continue;
      for (int i = 0; i < 2; ++i) {
        reference[i].solve(run.poses[i], 60, 1e-4);
        worst = std::max(
            worst, relativeError(run.wrenches[i], reference[i].wrench(), i == 0 ? 0.0175 : 0.008));
      }
    }
    printf("%3g Hz, +-%g deg, axis %d: worst relative error %.1e\n", hertz, degrees, axis, worst);
    EXPECT_LT(worst, bound) << "axis " << axis;
  }
}

TEST_F(DiscBatchTest, ForceIsAFunctionOfThePoseInMotionAt600Hz) { checkMotion(600, 5, 0.01); }
TEST_F(DiscBatchTest, ForceIsAFunctionOfThePoseInMotionAt200Hz) { checkMotion(200, 5, 0.01); }

// A second iteration is for the steps where little force is left and fibres begin to be stretched.
TEST_F(DiscBatchTest, MotionTakesAboutOneIterationAStep) {
  for (double hertz : {600.0, 200.0}) {
    BatchRun run(spine(8));
    int iterations = 0;
    for (int step = 1; step <= hertz; ++step) {
      for (auto& pose : run.poses) {
        pose = discPose({0, 5 * std::sin(2 * M_PI * step / hertz), 0}, {0, 0, -0.2});
      }
      iterations += run.evaluate();
    }
    printf("%g Hz: %.2f iterations a step\n", hertz, iterations / hertz);
    EXPECT_LT(iterations, (hertz > 500 ? 1.1 : 1.8) * hertz);
  }
}

TEST_F(DiscBatchTest, TeleportIteratesByItselfAndEndsNearTheConvergedWrench) {
  const auto discs = spine(8);
  for (const Vector3d& degrees : {Vector3d(0, 12, 0), Vector3d(0, 0, 20), Vector3d(8, -6, 5)}) {
    BatchRun run(discs), settled(discs);
    for (size_t i = 0; i < discs.size(); ++i) {
      run.poses[i] = settled.poses[i] = discPose(degrees, {0, 0, 0});
    }
    const int iterations = run.evaluate();
    EXPECT_GT(iterations, 1);
    EXPECT_LE(iterations, 8);
    converge(settled);
    for (size_t i = 0; i < discs.size(); ++i) {
      EXPECT_LT(relativeError(run.wrenches[i], settled.wrenches[i], 0.01), 0.05) << i;
    }
    // Back at rest nothing is left but what one step leaves.
    for (auto& pose : run.poses) pose = DiscPose();
    for (int i = 0; i < 10; ++i) run.evaluate();
    for (size_t i = 0; i < discs.size(); ++i) {
      EXPECT_LT(run.wrenches[i].force.norm(), 1e-3 * settled.wrenches[i].force.norm() + 1e-2);
    }
  }
}

// ---- invariances ----

TEST_F(DiscBatchTest, MirroredPoseHasTheMirroredWrench) {
  const auto discs = spine(4);
  BatchRun left(discs), right(discs);
  std::mt19937 rng(6);
  for (size_t i = 0; i < discs.size(); ++i) {
    left.poses[i] = randomPose(rng, 8, 0.5);
    const Eigen::Quaterniond& q = left.poses[i].rotation;
    right.poses[i].position = left.poses[i].position.cwiseProduct(Vector3d(1, -1, 1));
    right.poses[i].rotation = Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z());
  }
  converge(left);
  converge(right);
  for (size_t i = 0; i < discs.size(); ++i) {
    DiscWrench mirrored;
    mirrored.force = right.wrenches[i].force.cwiseProduct(Vector3d(1, -1, 1));
    mirrored.moment = right.wrenches[i].moment.cwiseProduct(Vector3d(-1, 1, -1));
    EXPECT_LT(relativeError(left.wrenches[i], mirrored, 0.01), 1e-3);
    EXPECT_NEAR(left.wrenches[i].pressure, right.wrenches[i].pressure,
                1e-3 * std::abs(left.wrenches[i].pressure));
  }
}

TEST_F(DiscBatchTest, QuaternionsOfEitherSignAndAnyLengthAreTheSamePose) {
  BatchRun run(spine(3));
  const DiscPose pose = discPose({3, 4, -5}, {0.2, 0.1, -0.3});
  for (auto& p : run.poses) p = pose;
  run.poses[1].rotation.coeffs() *= -1;
  run.poses[2].rotation.coeffs() *= 3;
  const auto first = run.batch.disc(0);
  BatchRun same({first, first, first});
  same.poses = run.poses;
  same.evaluate();
  for (int i = 1; i < 3; ++i) {
    EXPECT_LT(relativeError(same.wrenches[i], same.wrenches[0], 0.01), 1e-5);
  }
}

// ---- batches ----

// Refinements and attached nodes mixed: three topologies, one of them alone; one without fibres.
std::vector<DiscBatch::Disc> mixedDiscs() {
  std::vector<DiscBatch::Disc> discs;
  const auto shapes = discShapes();
  for (int i = 0; i < 12; ++i) {
    const DiscShape& shape = shapes[i % shapes.size()];
    DiscMesh mesh = i % 3 == 1 ? makeDiscMesh(shape, 2) : makeDiscMesh(shape);
    if (i == 5) mesh.upper_nodes.pop_back();
    DiscMaterial material = kDiscMaterial;
    material.annulus_modulus += 1e5 * i;
    material.annulus_poisson = 0.45 - 0.02 * i;
    if (i == 3) material.fibre_modulus = 0;
    discs.push_back({mesh, material});
  }
  return discs;
}

TEST_F(DiscBatchTest, DiscsDoNotInfluenceEachOther) {
  const auto discs = mixedDiscs();
  BatchRun all(discs);
  std::mt19937 rng(7);
  std::vector<std::unique_ptr<BatchRun>> single;
  for (const auto& disc : discs) {
    single.push_back(std::make_unique<BatchRun>(std::vector<DiscBatch::Disc>{disc}));
  }
  // The last poses are large and take several iterations.
  for (double degrees : {1.0, 3.0, 6.0, 40.0, 5.0}) {
    for (size_t i = 0; i < discs.size(); ++i) {
      all.poses[i] = single[i]->poses[0] = randomPose(rng, degrees * (i % 4 == 0 ? 1 : 0.5), 0.3);
    }
    all.evaluate();
    for (size_t i = 0; i < discs.size(); ++i) {
      single[i]->evaluate();
      EXPECT_EQ(all.wrenches[i].force, single[i]->wrenches[0].force) << i;
      EXPECT_EQ(all.wrenches[i].moment, single[i]->wrenches[0].moment) << i;
    }
  }
}

TEST_F(DiscBatchTest, MixedTopologiesConvergeToTheReference) {
  const auto discs = mixedDiscs();
  BatchRun run(discs);
  for (auto& pose : run.poses) pose = discPose({2, 3, -2}, {0.1, 0, -0.2});
  converge(run);
  for (size_t i = 0; i < discs.size(); ++i) {
    ReferenceDisc reference(discs[i].mesh, discs[i].material);
    reference.solve(run.poses[i], 100, 1e-5);
    EXPECT_LT(relativeError(run.wrenches[i], reference.wrench(), 0.01), 2e-3) << i;
  }
}

TEST_F(DiscBatchTest, DiscWithoutFreeNodesAndEmptyBatchWork) {
  // One layer of prisms, each tet a cell, no nucleus.
  DiscMesh layer;
  for (int z = 0; z < 2; ++z) {
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}}) {
      layer.rest_positions.emplace_back(0.02 * x, 0.02 * y, 0.01 * z - 0.005);
    }
  }
  layer.tets = {{0, 1, 2, 5}, {0, 1, 5, 4}, {0, 4, 5, 3}};
  layer.lower_nodes = {0, 1, 2};
  layer.upper_nodes = {3, 4, 5};
  layer.cells = {0, 1, 2};
  layer.hoops = {{0, 1}, {0, 1}, {0, 1}};
  BatchRun stiff({{layer, kDiscMaterial}});
  stiff.poses[0] = discPose({0, 1, 0}, {0, 0, -0.1});
  stiff.evaluate();
  ReferenceDisc reference(stiff.batch.disc(0).mesh, kDiscMaterial);
  reference.solve(stiff.poses[0], 10, 1e-6);
  EXPECT_LT(relativeError(stiff.wrenches[0], reference.wrench(), 0.01), 1e-3);
  EXPECT_EQ(stiff.wrenches[0].nucleus_pressure, 0);

  const DiscBatch empty({});
  EXPECT_EQ(empty.stateSize(), 0);
  EXPECT_EQ(empty.evaluate(nullptr, nullptr, nullptr, nullptr, nullptr, {}), 0);
}

TEST_F(DiscBatchTest, FaultNamesTheDisc) {
  auto discs = spine(3);
  std::swap(discs[2].mesh.tets[9][0], discs[2].mesh.tets[9][1]);
  try {
    DiscBatch batch(discs);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("disc 2: tet 9"), std::string::npos) << e.what();
  }
}

// ---- instruction sets, threads, memory ----

TEST_F(DiscBatchTest, InstructionSetsAgreeToFloatRounding) {
  const auto discs = spine(8);
  std::vector<std::vector<DiscWrench>> results;
  std::vector<std::vector<double>> states;
  for (const char* set : kInstructionSets) {
    if (!DiscBatch::setInstructionSet(set)) continue;
    EXPECT_STREQ(DiscBatch::instructionSet(), set);
    BatchRun run(discs);
    for (int step = 1; step <= 20; ++step) {
      for (auto& pose : run.poses) pose = discPose(0.2 * step * Vector3d(1, 1, -1), {0, 0, -0.1});
      run.evaluate();
    }
    results.push_back(run.wrenches);
    states.push_back(run.state);
  }
  for (size_t k = 1; k < results.size(); ++k) {
    for (size_t i = 0; i < discs.size(); ++i) {
      EXPECT_LT(relativeError(results[k][i], results[0][i], 0.01), 2e-4);
    }
    for (size_t i = 0; i < states[0].size(); ++i) {
      // Displacements [m], and wrenches and pressures.
      EXPECT_NEAR(states[k][i], states[0][i], 2e-7 + 2e-3 * std::abs(states[0][i]));
    }
  }
  EXPECT_FALSE(DiscBatch::setInstructionSet("mmx"));
}

TEST_F(DiscBatchTest, ThreadsShareABatchAndGetTheSameBits) {
  const auto discs = spine(23);
  const DiscBatch batch(discs);
  std::vector<DiscWrench> wrenches[3];
  std::vector<double> states[3];
  const auto work = [&](int k) {
    std::vector<double>& state = states[k];
    state.assign(batch.stateSize(), 0.0);
    wrenches[k].resize(discs.size());
    std::unique_ptr<void, void (*)(void*)> scratch(
        std::aligned_alloc(64, (batch.scratchSize() + 63) / 64 * 64), std::free);
    std::mt19937 rng(8);
    for (int step = 0; step < 30; ++step) {
      std::vector<DiscPose> poses;
      for (size_t i = 0; i < discs.size(); ++i) poses.push_back(randomPose(rng, 10, 0.5));
      batch.evaluate(poses.data(), state.data(), state.data(), wrenches[k].data(), scratch.get(),
                     {});
    }
  };
  work(0);
  std::thread a(work, 1), b(work, 2);
  a.join();
  b.join();
  for (int k = 1; k < 3; ++k) {
    EXPECT_EQ(std::memcmp(states[k].data(), states[0].data(), 8 * states[0].size()), 0);
    for (size_t i = 0; i < discs.size(); ++i) {
      EXPECT_EQ(wrenches[k][i].force, wrenches[0][i].force);
      EXPECT_EQ(wrenches[k][i].moment, wrenches[0][i].moment);
    }
  }
}

TEST_F(DiscBatchTest, StateInIsNotWritten) {
  BatchRun run(spine(9));
  for (auto& pose : run.poses) pose = discPose({1, 2, 3}, {0, 0, 0});
  run.evaluate();
  const std::vector<double> before = run.state;
  std::vector<double> in_place = run.state, out(run.state.size(), 7.0);
  const auto evaluate = [&](const double* from, double* to) {
    run.batch.evaluate(run.poses.data(), from, to, run.wrenches.data(), run.scratch.get(), {});
  };
  evaluate(run.state.data(), out.data());
  EXPECT_EQ(run.state, before);
  evaluate(in_place.data(), in_place.data());
  EXPECT_EQ(in_place, out);
}

TEST_F(DiscBatchTest, EvaluateAllocatesNothing) {
#ifdef TORSO_COUNT_ALLOCATIONS
  BatchRun run(mixedDiscs());
  run.evaluate();
  std::mt19937 rng(9);
  for (double degrees : {1.0, 10.0, 100.0}) {  // the last inverts tets
    for (auto& pose : run.poses) pose = randomPose(rng, degrees, 2);
    const long before = allocations;
    run.evaluate();
    EXPECT_EQ(allocations - before, 0);
  }
  const long before = allocations;
  run.poses.reserve(1000);
  EXPECT_GT(allocations - before, 0);  // the counter counts
#else
  GTEST_SKIP() << "sanitizers bring their own allocator";
#endif
}

// ---- absurd input ----

bool finite(const BatchRun& run) {
  for (const DiscWrench& w : run.wrenches) {
    if (!w.force.allFinite() || !w.moment.allFinite() || !std::isfinite(w.pressure)) return false;
  }
  for (double x : run.state) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

TEST_F(DiscBatchTest, AbsurdPosesStayFiniteAndAreForgotten) {
  for (const char* set : kInstructionSets) {
    if (!DiscBatch::setInstructionSet(set)) continue;
    BatchRun run(spine(8));
    std::vector<DiscPose> absurd = {
        discPose({0, 0, 0}, {0, 0, -11}),  // faces through each other
        discPose({0, 0, 0}, {0, 0, -200}),    discPose({180, 0, 0}, {0, 0, 0}),
        discPose({0, 90, 0}, {10, 10, 10}),   discPose({0, 0, 179}, {0, 0, 0}),
        discPose({1, 2, 3}, {1e9, -1e9, 1e9})};
    absurd.push_back(absurd[0]);
    absurd.back().position = Vector3d(1e300, -1e300, 1e308);
    absurd.push_back(absurd[0]);
    absurd.back().rotation.coeffs().setZero();
    absurd.push_back(absurd[0]);
    absurd.back().rotation.coeffs() *= 1e-300;
    for (const DiscPose& pose : absurd) {
      for (auto& p : run.poses) p = pose;
      for (int i = 0; i < 3; ++i) {
        EXPECT_LE(run.evaluate(), 8);
        ASSERT_TRUE(finite(run));
      }
    }
    // Junk in the state, too.
    for (size_t i = 0; i < run.state.size(); ++i) run.state[i] = i % 2 ? 1e300 : -1e300;
    run.evaluate();
    ASSERT_TRUE(finite(run));

    // Back in a sane pose the answer is the one from rest.
    BatchRun fresh(spine(8));
    for (size_t i = 0; i < run.poses.size(); ++i) {
      run.poses[i] = fresh.poses[i] = discPose({1, 3, 2}, {0, 0, -0.2});
    }
    for (int i = 0; i < 60; ++i) {
      run.evaluate();
      fresh.evaluate();
    }
    for (size_t i = 0; i < run.poses.size(); ++i) {
      EXPECT_LT(relativeError(run.wrenches[i], fresh.wrenches[i], 0.01), 1e-3) << i;
    }
  }
}

// The force of a disc that is bent or crushed far beyond life does not jump about while the pose
// stands still.
TEST_F(DiscBatchTest, LargeStrainsSettle) {
  for (const DiscPose& pose : {discPose({0, 15, 0}, {0, 0, 0}), discPose({0, -15, 0}, {0, 0, 0}),
                               discPose({0, 0, 20}, {0, 0, 0}), discPose({0, 0, 0}, {0, 0, -1}),
                               discPose({0, 0, 0}, {0, 0, -2}), discPose({0, 0, 0}, {0, 0, -4})}) {
    BatchRun run({{makeDiscMesh(kLumbarShape), kDiscMaterial}});
    run.poses[0] = pose;
    ReferenceDisc reference(run.batch.disc(0).mesh, kDiscMaterial);
    reference.solve(pose, 300, 1e-3);
    for (int i = 0; i < 20; ++i) run.evaluate();
    for (int i = 0; i < 5; ++i) {
      run.evaluate();
      EXPECT_LT(relativeError(run.wrenches[0], reference.wrench(), 0.0175), 0.01)
          << pose.position.transpose() << " " << pose.rotation.coeffs().transpose();
    }
  }
}

}  // namespace
}  // namespace torso
