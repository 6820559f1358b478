// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// From the tables' man of 1.70 m and 72 kg to the body of a person.

#include <optional>

#include "model/anatomy.h"

namespace torso {

// Cobb angles between endplates in standing, and what follows from them [rad], [m].
struct SagittalAlignment {
  double lumbar_lordosis;    // S1 upper to L1 upper endplate
  double thoracic_kyphosis;  // T12 lower to T4 upper endplate
  double kyphosis_t1_t12;    // T12 lower to T1 upper endplate
  double cervical_lordosis;  // C7 lower to C2 lower endplate
  double sacral_slope;       // S1 endplate against the horizontal
  double pelvic_tilt;        // S1 endplate's centre to hip axis, against the vertical
  double c7_offset;          // C7's centre in front of S1's rear edge: the plumb line [m]
  double centre_of_mass;     // of the whole body, in front of the ankles [m]
  double pelvic_incidence() const { return sacral_slope + pelvic_tilt; }
};
SagittalAlignment sagittalAlignment(const Anatomy& anatomy);

// What is not given stays as the tables have it.
struct Person {
  enum class Sex { kMale, kFemale };
  Sex sex = Sex::kMale;
  std::optional<double> stature;       // [m]
  std::optional<double> mass;          // [kg]
  std::optional<double> lordosis;      // L1-S1, as SagittalAlignment's [rad]
  std::optional<double> kyphosis;      // T4-T12 [rad]
  std::optional<double> sacral_slope;  // [rad]
};

// The tables of a person's body, made from the unscaled tables of Anatomy::load.
//
// Stature scales all lengths, mass all masses. Flesh is as much thicker or thinner as its mass
// asks for; bones and discs are not: the same tissue carries more in a heavier person, so moduli
// stay. Joints and servos grow as Anatomy::scaled says. Sex: sex.csv.
//
// Lordosis and kyphosis are spread over the wedges of discs and vertebrae of their region in
// proportion to what each of them has; T1-T3 go on bending as T4-T12 do. Heights in the middle of
// discs and bodies stay, and the spine is stacked anew. The gaze stays level: the discs of the neck
// make up for the slope of T1. Legs and arms keep their directions; the rest goes with the spine
// (model/body_warp.h). Pelvis and sacrum turn together about the hips (pelvic incidence belongs to
// the bone): to the sacral slope that is given or, if a curve is given without it, to the one that
// keeps the whole body's centre of mass over the same place of the feet. The C7 plumb line goes
// where that leaves it.
//
// A Person{} gets the tables unchanged. Pure. Throws std::invalid_argument "name value: what is
// allowed and why", with names as those of the fields (sacral-slope), for a person whom the tables
// cannot be stretched to.
Anatomy personalAnatomy(const Anatomy& tables, const Person& person);

}  // namespace torso
