// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/pressure_study.h"

#include <algorithm>
#include <cmath>

#include "model/muscle.h"
#include "model/muscle_stress.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kSmallMoment = 1, kStill = 0.1;  // [Nm]
constexpr int kMaxRounds = 12;
// Of the way to new tensions, after the first round: the body gives way, so that whole steps
// overshoot by half.
constexpr double kLaterSteps = 0.5;
constexpr int kL4L5 = 1;  // among the cuts

Loading loading(PosedBody& body, const MuscleMoments& moments) {
  const mjModel* m = body.model();
  const mjData* d = body.data();
  Loading result;
  for (int i = 0; torso_discName(m, i); i++) {
    DiscLoad load;
    load.disc = torso_discName(m, i);
    load.nucleus_pressure = kUnloadedPressure + torso_discNucleusPressure(m, d, i);
    load.surface_pressure = torso_discPressure(m, d, i);
    Vector3d force, moment, point, origin;
    mjtNum axes[9];
    torso_discWrench(m, d, i, force.data(), moment.data(), point.data());
    torso_discFrame(m, d, i, origin.data(), axes);
    load.compression = force.dot(Vector3d(axes[2], axes[5], axes[8]));  // on the upper bone
    load.area = body.discArea(i);
    result.discs.push_back(load);
  }
  const VectorXd servos = moments.servoMoments(d);
  for (Eigen::Index k = 0; k < servos.size(); k += 3) result.servo_moments.push_back(servos[k + 1]);
  return result;
}

// "MF" of the actuator "MF_m1s_left".
std::string groupOf(const mjModel* m, int muscle) {
  const std::string name = nameOf(m, mjOBJ_ACTUATOR, muscle);
  return name.substr(0, name.find('_'));
}

// Psoas and quadratus lumborum, which electrodes on the skin do not see.
bool isDeep(const std::string& group) { return group == "PS" || group == "QL"; }

// Flexion moment of the pressure in the abdomen about the disc of a cut [Nm].
double abdominalMoment(const PosedBody& body, const Cut& cut) {
  const Vector3d centre(body.data()->site_xpos + 3 * cut.site);
  return (body.diaphragm() - centre).cross(body.abdominalForce()).y();
}

std::vector<Balance> balances(const PosedBody& body, const MuscleMoments& moments) {
  const mjData* d = body.data();
  const VectorXd external = moments.externalMoments(d), servos = moments.servoMoments(d);
  const VectorXd tensions = moments.tensions(d);
  const VectorXd muscles = moments.arms(d) * tensions, pulls = moments.pulls(d) * tensions;
  const Vector3d push = body.abdominalForce();
  std::vector<Balance> result;
  for (std::size_t c = 0; c < moments.cuts().size(); c++) {
    const int site = moments.cuts()[c].site, flexion = 3 * c + 1;
    const mjtNum* axes = d->site_xmat + 9 * site;
    Balance b;
    b.disc = moments.cuts()[c].disc;
    b.abdomen = abdominalMoment(body, moments.cuts()[c]);
    b.external = external[flexion] - b.abdomen;  // among the applied forces
    b.muscles = muscles[flexion];
    b.servos = servos[flexion];
    b.muscle_pull = pulls[c];
    b.abdomen_push = push.dot(Vector3d(axes[2], axes[5], axes[8]));
    result.push_back(b);
  }
  return result;
}

}  // namespace

double abdominalPressure(double moment) { return std::max(0., 79 * moment - 1127); }

double coactivation(double load) { return 0.017 + (0.029 - 0.017) * load / 32; }

const DiscLoad& Loading::at(const std::string& disc) const {
  for (const DiscLoad& load : discs) {
    if (load.disc == disc) return load;
  }
  throw Error("the model has no disc " + disc);
}

ActivityLoads measureActivity(PosedBody& body, const MuscleMoments& moments,
                              const Activity& activity, bool muscles,
                              const Assumptions& assumptions) {
  const mjModel* m = body.model();
  mjData* d = body.data();
  ActivityLoads result;
  result.activity = activity;
  body.take(activity);
  body.settle();
  result.servos = loading(body, moments);
  result.lean = body.lean();
  if (!muscles) return result;

  const VectorXd sections = moments.sections();
  VectorXd always = VectorXd::Zero(sections.size());
  double free = 1;
  if (assumptions.coactivation && activity.held != Held::kBed) {
    const double share = coactivation(activity.load);
    always = share * kLargestMuscleStress * sections;
    for (std::size_t i = 0; i < moments.muscles().size(); i++) {
      if (isDeep(groupOf(m, moments.muscles()[i]))) always[i] = 0;
    }
    free = 1 - share;
  }
  double before = moments.servoMoments(d).lpNorm<Eigen::Infinity>();
  for (int round = 0; round < kMaxRounds && activity.held != Held::kBed; round++) {
    const double weight =
        moments.externalMoments(d)[3 * kL4L5 + 1] - abdominalMoment(body, moments.cuts()[kL4L5]);
    if (assumptions.abdomen) result.abdominal_pressure = abdominalPressure(weight);
    body.pressurise(result.abdominal_pressure);
    const Eigen::MatrixXd arms = moments.arms(d);
    const VectorXd demand = moments.servoMoments(d) + arms * (moments.tensions(d) - always);
    const VectorXd least =
        always + leastStressForces(arms, demand, sections, free * kLargestMuscleStress);
    const double step = round == 0 ? 1 : kLaterSteps;
    moments.setTensions(d, moments.tensions(d) + step * (least - moments.tensions(d)));
    body.settle();
    const double now = moments.servoMoments(d).lpNorm<Eigen::Infinity>();
    if (now < kSmallMoment || std::abs(now - before) < kStill) break;
    before = now;
  }
  result.muscles = loading(body, moments);
  result.balance = balances(body, moments);
  const VectorXd tensions = moments.tensions(d);
  result.largest_stress = tensions.cwiseQuotient(sections).maxCoeff();
  for (std::size_t i = 0; i < moments.muscles().size(); i++) {
    result.group_force[groupOf(m, moments.muscles()[i])] += tensions[i];
  }
  return result;
}

}  // namespace torso::tools
