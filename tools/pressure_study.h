// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Loads of the discs in everyday activities, held by servos and by muscles.

#include <map>
#include <string>
#include <vector>

#include "tools/activity.h"
#include "tools/measured_man.h"
#include "tools/muscle_moments.h"
#include "tools/posed_body.h"

namespace torso::tools {

constexpr const char* kMeasuredDisc = "L4/L5";
// In the nucleus of a disc under no load [Pa], for the ligaments press on it and it swells:
// Nachemson and Evans 1968, J Biomech 1:211-220. Pressures of our discs are above it.
constexpr double kUnloadedPressure = 0.07e6;
// Compression over disc area and nucleus pressure of healthy discs in the laboratory: Nachemson
// 1960, Acta Orthop Scand Suppl 43. Others find 0.60 - 0.77.
constexpr double kForceOverPressure = 0.66;

struct DiscLoad {
  std::string disc;
  double nucleus_pressure;  // as a needle measures, that of the unloaded disc included [Pa]
  double surface_pressure;  // normal force on the endplate over its area [Pa], as the paper's
  double compression;       // along the disc's axis [N]
  double area;              // of the endplate [m^2]
  // That of the nucleus if the same force were on a disc of the subject's area [Pa].
  double pressureOnSubjectsArea() const {
    return kUnloadedPressure + (nucleus_pressure - kUnloadedPressure) * area / kSubjectsArea;
  }
};

// Flexion moments about a disc's centre, on what is above it [Nm], and what becomes of them.
struct Balance {
  std::string disc;
  double external;      // of weight above and load
  double muscles;       // of the muscles' tensions
  double abdomen;       // of the pressure in the abdomen
  double servos;        // that muscles leave over
  double muscle_pull;   // sum of the muscles' pulls along the disc's axis [N]
  double abdomen_push;  // that it takes off the disc [N]
  // What is left to the spine itself: disc, ligaments, facets.
  double passive() const { return -external - muscles - abdomen - servos; }
};

struct Loading {
  std::vector<DiscLoad> discs;        // all, from below
  std::vector<double> servo_moments;  // flexion, at the cuts of MuscleMoments, from below [Nm]
  const DiscLoad& at(const std::string& disc) const;  // throws Error
};

struct ActivityLoads {
  Activity activity;
  Loading servos;                             // without muscles
  Loading muscles;                            // with; no discs if they were not asked for
  std::vector<Balance> balance;               // at the cuts of MuscleMoments, with muscles
  std::map<std::string, double> group_force;  // sum of tensions by muscle [N]
  double lean = 0;                            // forwards, of the whole body, that balances it [rad]
  double abdominal_pressure = 0;              // [Pa]
  double largest_stress = 0;                  // [Pa]
};

// Pressure in the abdomen [Pa] while an extending moment [Nm] is wanted at L4/L5: regression over
// lifts of 6 - 72 kg by 14 men standing, r = 0.75, Mairiaux et al. 1984, Ergonomics 27:883-894
// (read in its abstract); none below 14 Nm.
double abdominalPressure(double moment);

// Share of their strength that abdominal muscles and extensors of the back give all the time
// against each other to keep the spine stable: 1.7 % upright without load, 2.9 % with 32 kg on the
// trunk (EMG on the skin, ten people, Cholewicki et al. 1997, Spine 22:2207-2212, recalled), in
// between as the load [kg].
double coactivation(double load);

// What muscles are helped or hindered by.
struct Assumptions {
  bool abdomen = true;       // pressure in the abdomen goes with the moment at L4/L5
  bool coactivation = true;  // of abdominal and back muscles
};

// Puts the body in the posture, lets the servos hold it, and, if asked for, lets muscles take over,
// helped by the pressure in the abdomen that goes with the moment at L4/L5: their tensions are
// coactivation, and on top of it those of least stress (model/muscle_stress.h) that give the
// moments which servos and muscles together gave at rest, again and again until the servos' share
// at the cuts is below 1 Nm or stands still. The servos stay, and give what muscles cannot. On a
// bed muscles are silent (relaxed muscles show no EMG: Basmajian and De Luca 1985, Muscles Alive)
// and the bed holds the posture, which the servos stand for. Throws Error.
ActivityLoads measureActivity(PosedBody& body, const MuscleMoments& moments,
                              const Activity& activity, bool muscles,
                              const Assumptions& assumptions = {});

}  // namespace torso::tools
