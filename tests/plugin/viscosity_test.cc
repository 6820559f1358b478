// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The damping of a disc is that of its material, not of the time step.

#include <cmath>
#include <string>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

class ViscosityTest : public PluginTest {};

// The line of an MJCF text that holds `word`.
std::string lineWith(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  if (at == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

// One disc of the torso between the world and a light body.
std::string oneDisc(const std::string& name) {
  const std::string torso = modelText("torso.xml");
  return "<mujoco><option gravity='0 0 0'/><size nuserdata='20000' njmax='50'/><worldbody>"
         "<body name='lower'><geom size='.001'/><site name='l'/></body>"
         "<body name='upper'><freejoint/><inertial pos='0 0 0' mass='.2' diaginertia='1e-4 1e-4 "
         "1e-4'/><site name='u'/></body></worldbody>"
         "<equality><weld name='w' body1='upper' body2='lower' anchor='0 0 0' torquescale='.3'/>"
         "</equality><custom><numeric name='mujoco_torso' data='2 0 0'/>" +
         lineWith(torso, "<numeric name=\"disc:" + name + "\"") +
         lineWith(torso, "<text name=\"disc:" + name + "\"") +
         lineWith(torso, "<text name=\"disc_topology\"") + "<tuple name='disc:" + name +
         "'><element objtype='site' objname='l'/><element objtype='site' objname='u'/>"
         "<element objtype='equality' objname='w'/><element objtype='numeric' objname='disc:" +
         name + "'/><element objtype='text' objname='disc:" + name +
         "'/><element objtype='text' objname='disc_topology'/></tuple></custom></mujoco>";
}

struct Response {
  double stiffness;    // amplitude of the force over that of the displacement in phase [N/m]
  double loss_factor;  // displacement in quadrature over that in phase
};

// Compression by 300 N and +-100 N at `hertz`, in the fifth cycle.
Response respond(const std::string& disc, double hertz, double timestep) {
  const ModelPtr m = loadText(oneDisc(disc));
  m->opt.timestep = timestep;
  const DataPtr d = makeData(m.get());
  double in_phase = 0, quadrature = 0;
  int steps = 0;
  const auto phase = [&] { return 2 * M_PI * hertz * d->time; };
  while (phase() < 10 * M_PI) {
    const double ramp = std::min(1.0, hertz * d->time);
    d->xfrc_applied[6 * 2 + 2] = -300 * ramp - 100 * std::sin(phase());
    mj_step(m.get(), d.get());
    if (phase() < 8 * M_PI) continue;
    in_phase -= d->qpos[2] * std::sin(phase());
    quadrature += d->qpos[2] * std::cos(phase());
    steps++;
  }
  in_phase *= 2.0 / steps;
  quadrature *= 2.0 / steps;
  return {100 / in_phase, quadrature / in_phase};
}

// Loss factors of 0.1 to 0.3 in dynamic tests (disc_tests.csv).
TEST_F(ViscosityTest, LossFactorIsThatOfDynamicTests) {
  for (const char* disc : {"L4/L5", "T7/T8", "C5/C6"}) {
    const Response r = respond(disc, 1, 1.0 / 600);
    printf("%s: %.0f N/mm, loss factor %.3f at 1 Hz\n", disc, r.stiffness * 1e-3, r.loss_factor);
    EXPECT_GT(r.loss_factor, 0.1) << disc;
    EXPECT_LT(r.loss_factor, 0.3) << disc;
  }
}

// The implicit step acts with the stiffness of all fibres taut, which exceeds the disc's: the rest
// is damping, small beside the disc's own.
TEST_F(ViscosityTest, TimeStepAddsLittleDamping) {
  const Response fine = respond("L4/L5", 1, 1.0 / 1800), coarse = respond("L4/L5", 1, 1.0 / 200);
  printf("1800 Hz: %.0f N/mm, loss factor %.3f; 200 Hz: %.0f N/mm, %.3f\n", fine.stiffness * 1e-3,
         fine.loss_factor, coarse.stiffness * 1e-3, coarse.loss_factor);
  EXPECT_NEAR(coarse.loss_factor, fine.loss_factor, 0.2 * fine.loss_factor);
  EXPECT_NEAR(coarse.stiffness, fine.stiffness, 0.05 * fine.stiffness);
}

// A viscous disc loses in proportion to the rate.
TEST_F(ViscosityTest, LossGrowsWithTheRate) {
  const double slow = respond("L4/L5", 0.25, 1.0 / 600).loss_factor;
  const double fast = respond("L4/L5", 1, 1.0 / 600).loss_factor;
  EXPECT_NEAR(fast / slow, 4, 0.5);
}

}  // namespace
}  // namespace torso
