// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "model/person.h"

namespace torso {

constexpr double kDeg = M_PI / 180;

inline Person person(Person::Sex sex, double stature, double mass) {
  Person p;
  p.sex = sex;
  p.stature = stature;
  p.mass = mass;
  return p;
}
inline Person withCurves(Person p, double lordosis_deg, double kyphosis_deg) {
  p.lordosis = lordosis_deg * kDeg;
  p.kyphosis = kyphosis_deg * kDeg;
  return p;
}

// Small and tall, slight and heavy, straight and bent, of both sexes.
inline std::vector<Person> people() {
  constexpr auto kMale = Person::Sex::kMale, kFemale = Person::Sex::kFemale;
  std::vector<Person> all = {
      person(kFemale, 1.55, 50),
      withCurves(person(kFemale, 1.85, 90), 55, 40),
      person(kMale, 1.95, 110),
      withCurves(person(kMale, 1.70, 72), 40, 25),
      withCurves(person(kMale, 1.60, 90), 75, 60),
      withCurves(person(kFemale, 1.45, 36), 65, 30),
  };
  Person tilted = withCurves(person(kMale, 1.80, 75), 60, 45);
  tilted.sacral_slope = 36 * kDeg;
  all.push_back(tilted);
  return all;
}

inline std::string describe(const Person& p) {
  std::string text = p.sex == Person::Sex::kMale ? "man" : "woman";
  text += " of " + std::to_string(*p.stature) + " m, " + std::to_string(*p.mass) + " kg";
  if (p.lordosis) text += ", lordosis " + std::to_string(*p.lordosis / kDeg);
  if (p.kyphosis) text += ", kyphosis " + std::to_string(*p.kyphosis / kDeg);
  return text;
}

}  // namespace torso
