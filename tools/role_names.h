// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the name of a joint says, in the conventions of Mixamo, CMU, Daz/Poser, Character Studio and
// 3ds Max, Rokoko, MakeHuman, Rigify, Unity, Unreal and their like.

#include <string>

namespace torso::tools {

enum class LimbRole { kClavicle, kUpperArm, kLowerArm, kHand, kThigh, kShin, kFoot, kToe };

// The name without what is before the last ':' or '|', in lower case, and without words that look
// like parts of a body and are none ("armature").
std::string plainName(const std::string& name);

// How much a plain name speaks for a role: 3 for a name that means nothing else ("forearm"), less
// for one that different conventions use for neighbours ("shoulder", "leg"), negative for names of
// other roles and of helpers (twist, roll, IK).
double nameScore(LimbRole role, const std::string& plain);

// Greater than 0 for words of legs, less for words of arms, 0 for others.
int legOrArm(const std::string& plain);

bool isPelvisName(const std::string& plain);  // of the mid-line: no hip of one side
bool isNeckName(const std::string& plain);
bool isHeadName(const std::string& plain);  // no end of a head
bool isAnimalName(const std::string& plain);

// -1 left, 1 right, 0: it does not say.
int sideOf(const std::string& name);

}  // namespace torso::tools
