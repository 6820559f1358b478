// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/disc_bench.h"

namespace torso {
namespace {

using Quantity = DiscTest::Quantity;

constexpr double kDegree = M_PI / 180;

Disc lumbarDisc() {
  Disc disc;
  disc.name = "L4/L5";
  disc.shape = {0.048, 0.034, 0.014, 0.007};
  disc.region = Region::kLumbar;
  return disc;
}

DiscMaterial material(double annulus, double fibre, double stiffening, double nucleus) {
  return {annulus, 0.45, fibre, stiffening, 30 * kDegree, nucleus, 100e6};
}

// Tests that a disc of this material passes in the middle of a narrow range.
std::vector<DiscTest> testsPassedBy(const DiscMaterial& material) {
  const DiscBench bench(makeDiscMesh(lumbarDisc().shape), material);
  std::vector<DiscTest> tests;
  for (const auto& [quantity, load] : {std::pair{Quantity::kCompression, 1000.0},
                                       {Quantity::kTension, 400.0},
                                       {Quantity::kAnteriorShear, 150.0},
                                       {Quantity::kFlexion, 1.0},
                                       {Quantity::kFlexion, 5.0},
                                       {Quantity::kLateralBending, 5.0},
                                       {Quantity::kAxialTorsion, 1.0},
                                       {Quantity::kAxialTorsion, 5.0},
                                       {Quantity::kPressure, 1000.0}}) {
    DiscTest test = {};
    test.region = Region::kLumbar;
    test.quantity = quantity;
    test.load = load;
    test.value = simulateDiscTest(bench, 0, test);
    test.low = test.value / 1.001;
    test.high = test.value * 1.001;
    tests.push_back(test);
  }
  return tests;
}

void expectSame(const DiscMaterial& one, const DiscMaterial& other, double tolerance) {
  for (const FittedConstant& c : fittedConstants()) {
    EXPECT_NEAR(std::log(one.*c.member / (other.*c.member)), 0, tolerance) << c.name;
  }
}

TEST(DiscCalibration, RecoversTheMaterialFromEitherSide) {
  const DiscMaterial truth = material(1.8e6, 14e6, 20, 0.4e6);
  const auto tests = testsPassedBy(truth);
  for (const DiscMaterial& start :
       {material(3e6, 8e6, 10, 0.25e6), material(1.2e6, 20e6, 40, 0.7e6)}) {
    const DiscCalibration fit = calibrateDiscs({makeDiscMesh(lumbarDisc().shape)}, tests, start);
    expectSame(fit.material, truth, 0.02);
  }
}

TEST(DiscCalibration, ThreadsDoNotChangeTheAnswer) {
  auto tests = testsPassedBy(material(1.8e6, 14e6, 20, 0.4e6));
  tests.resize(2);
  Disc small = lumbarDisc();
  small.shape.width = 0.04;
  const std::vector<DiscMesh> discs = {makeDiscMesh(lumbarDisc().shape), makeDiscMesh(small.shape)};
  const DiscMaterial start = material(2e6, 12e6, 15, 0.3e6);
  const DiscCalibration one = calibrateDiscs(discs, tests, start, 1);
  const DiscCalibration two = calibrateDiscs(discs, tests, start, 2);
  expectSame(one.material, two.material, 0);
  EXPECT_EQ(one.cost, two.cost);
}

TEST(DiscCalibration, StaysWithinPublishedBounds) {
  auto tests = testsPassedBy(material(2.5e6, 10e6, 10, 0.3e6));
  tests.resize(2);
  for (DiscTest& test : tests) {
    test.value *= 100;
    test.low *= 100;
    test.high *= 100;
  }
  const DiscMaterial m =
      calibrateDiscs({makeDiscMesh(lumbarDisc().shape)}, tests, material(2.5e6, 10e6, 10, 0.3e6))
          .material;
  for (const FittedConstant& c : fittedConstants()) {
    EXPECT_GE(m.*c.member, c.low * (1 - 1e-12)) << c.name;
    EXPECT_LE(m.*c.member, c.high * (1 + 1e-12)) << c.name;
  }
}

TEST(DiscCalibration, MixedRegionsAreRefused) {
  auto tests = testsPassedBy(material(2.5e6, 10e6, 10, 0.3e6));
  tests[0].region = Region::kCervical;
  EXPECT_THROW(
      calibrateDiscs({makeDiscMesh(lumbarDisc().shape)}, tests, material(2.5e6, 10e6, 10, 0.3e6)),
      std::invalid_argument);
  EXPECT_THROW(calibrateDiscs({}, tests, material(2.5e6, 10e6, 10, 0.3e6)), std::invalid_argument);
}

}  // namespace
}  // namespace torso
