// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/spine_curve.h"

#include <cmath>
#include <stdexcept>

#include "model/pitch.h"

namespace torso {
namespace {

using Eigen::Vector3d;

// The spine as a stack: disc i lies below vertebra i (the last is C2). A wedge is the angle by
// which the pitch falls from its lower to its upper face.
struct Curve {
  double base;  // pitch of the S1 endplate
  std::vector<double> discs, bodies;
};

Curve curveOf(const Anatomy& a) {
  Curve c{a.sacral_slope, {}, {}};
  double below = a.sacral_slope;
  for (const Vertebra* v : levels(a)) {
    c.discs.push_back(below - v->lower_endplate_pitch);
    c.bodies.push_back(v->lower_endplate_pitch - v->upper_endplate_pitch);
    below = v->upper_endplate_pitch;
  }
  return c;
}

// Adds `change` to the sum of the wedges, in proportion to their sizes, and to `others` at the same
// rate.
void spread(double change, const std::vector<double*>& wedges,
            const std::vector<double*>& others = {}) {
  double sum = 0;
  for (const double* w : wedges) sum += std::abs(*w);
  const double rate = change / sum;
  for (double* w : wedges) *w += rate * std::abs(*w);
  for (double* w : others) *w += rate * std::abs(*w);
}

int indexOf(const Anatomy& a, const std::string& level) {
  for (std::size_t i = 0; i < a.vertebrae.size(); i++) {
    if (a.vertebrae[i].name == level) return static_cast<int>(i);
  }
  throw std::runtime_error("anatomy: no vertebra is called '" + level + "'");
}

// Centres of discs and bodies, stacked from their heights on the S1 endplate.
struct Stack {
  std::vector<Vector3d> discs, bodies;
};

Stack stackOf(const Anatomy& a) {
  Stack stack;
  Vector3d top = Vector3d::Zero();
  const auto lay = [&](double anterior, double posterior, double pitch) {
    const Vector3d half = (anterior + posterior) / 4 * upAt(pitch);
    top += 2 * half;
    return Vector3d(top - half);
  };
  double below = a.sacral_slope;
  std::size_t i = 0;
  for (const Vertebra* v : levels(a)) {
    const DiscShape& d = a.discs[i++].shape;
    stack.discs.push_back(
        lay(d.height_anterior, d.height_posterior, (below + v->lower_endplate_pitch) / 2));
    stack.bodies.push_back(lay(v->body_height_anterior, v->body_height_posterior,
                               (v->lower_endplate_pitch + v->upper_endplate_pitch) / 2));
    below = v->upper_endplate_pitch;
  }
  return stack;
}

// Gives the spine another curve. Middle heights stay; what changes is added to the tables' values,
// so that their rounding stays, too.
void bend(Anatomy& a, const Curve& curve) {
  const Stack before = stackOf(a);
  const Curve old = curveOf(a);
  const auto wedge = [](double from, double to, double depth, double& anterior, double& posterior) {
    const double change = depth * (std::tan(to) - std::tan(from)) / 2;
    anterior += change;
    posterior -= change;
  };
  double below = curve.base, below_before = old.base;
  const std::vector<Vertebra*> all = levels(a);
  for (std::size_t i = 0; i < all.size(); i++) {
    Vertebra& v = *all[i];
    Disc& d = a.discs[i];
    wedge(old.discs[i], curve.discs[i], d.shape.depth, d.shape.height_anterior,
          d.shape.height_posterior);
    wedge(old.bodies[i], curve.bodies[i], meanDepth(v), v.body_height_anterior,
          v.body_height_posterior);
    const double lower = below - curve.discs[i], upper = lower - curve.bodies[i];
    const double turn = (lower - v.lower_endplate_pitch + upper - v.upper_endplate_pitch) / 2;
    const double disc_turn = (below - below_before + lower - v.lower_endplate_pitch) / 2;
    d.frame.linear() = pitchMatrix(pitchOf(d.frame.linear()) + disc_turn);
    below_before = v.upper_endplate_pitch;
    v.lower_endplate_pitch = lower;
    v.upper_endplate_pitch = upper;
    v.pitch += turn;
    below = upper;
  }
  a.sacral_slope = curve.base;
  const Stack after = stackOf(a);
  for (std::size_t i = 0; i < all.size(); i++) {
    all[i]->position += after.bodies[i] - before.bodies[i];
    a.discs[i].frame.translation() += after.discs[i] - before.discs[i];
  }
  for (const Disc& d : a.discs) {
    if (d.shape.height_anterior > 0 && d.shape.height_posterior > 0) continue;
    throw std::invalid_argument("lordosis and kyphosis: disc " + d.name +
                                " would have no height left at its front or back");
  }
}

// The wedges that give the person's lordosis and kyphosis on that sacral slope, and a level gaze.
Curve personalCurve(const Anatomy& a, const Person& person, double sacral_slope) {
  Curve c = curveOf(a);
  const SagittalAlignment now = sagittalAlignment(a);
  const double level_gaze = c.base - a.c2.lower_endplate_pitch;
  c.base = sacral_slope;
  const int l1 = indexOf(a, "L1"), t12 = indexOf(a, "T12"), t4 = indexOf(a, "T4"),
            t1 = indexOf(a, "T1"), c2 = static_cast<int>(a.vertebrae.size());
  std::vector<double*> lumbar, thoracic, upper_thoracic, cervical;
  for (int i = 0; i <= l1; i++) {
    lumbar.push_back(&c.discs[i]);
    lumbar.push_back(&c.bodies[i]);
  }
  for (int i = t12; i <= t1; i++) {
    if (i > t12) (i <= t4 ? thoracic : upper_thoracic).push_back(&c.discs[i]);
    (i <= t4 ? thoracic : upper_thoracic).push_back(&c.bodies[i]);
  }
  if (person.lordosis) spread(*person.lordosis - now.lumbar_lordosis, lumbar);
  if (person.kyphosis) {
    spread(now.thoracic_kyphosis - *person.kyphosis, thoracic, upper_thoracic);
  }
  double fall = 0;  // of the pitch from S1 to C2's lower endplate
  for (int i = 0; i <= c2; i++) fall += c.discs[i] + (i < c2 ? c.bodies[i] : 0);
  for (int i = t1 + 1; i <= c2; i++) cervical.push_back(&c.discs[i]);
  spread(sacral_slope - (a.sacral_slope - level_gaze) - fall, cervical);
  return c;
}

}  // namespace

void bendSpine(Anatomy& a, const Person& person, double sacral_slope) {
  bend(a, personalCurve(a, person, sacral_slope));
}

}  // namespace torso
