// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/role_names.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "tools/part_names.h"

namespace torso::tools {
namespace {

struct Word {
  const char* text;
  LimbRole role;
  double score;
};

// Longer words first: a word that was found hides those within it.
const Word kWords[] = {{"hipjoint", LimbRole::kThigh, -2},   {"buttock", LimbRole::kThigh, -2},
                       {"upperarm", LimbRole::kUpperArm, 3}, {"lowerarm", LimbRole::kLowerArm, 3},
                       {"upperleg", LimbRole::kThigh, 3},    {"lowerleg", LimbRole::kShin, 3},
                       {"clavicle", LimbRole::kClavicle, 3}, {"shoulder", LimbRole::kUpperArm, 1.5},
                       {"humerus", LimbRole::kUpperArm, 3},  {"forearm", LimbRole::kLowerArm, 3},
                       {"collar", LimbRole::kClavicle, 3},   {"scapula", LimbRole::kClavicle, 3},
                       {"uparm", LimbRole::kUpperArm, 3},    {"lowarm", LimbRole::kLowerArm, 3},
                       {"upleg", LimbRole::kThigh, 3},       {"lowleg", LimbRole::kShin, 3},
                       {"shldr", LimbRole::kUpperArm, 2},    {"elbow", LimbRole::kLowerArm, 3},
                       {"radius", LimbRole::kLowerArm, 3},   {"wrist", LimbRole::kHand, 3},
                       {"thigh", LimbRole::kThigh, 3},       {"femur", LimbRole::kThigh, 3},
                       {"tibia", LimbRole::kShin, 3},        {"ankle", LimbRole::kFoot, 3},
                       {"clav", LimbRole::kClavicle, 3},     {"hand", LimbRole::kHand, 3},
                       {"palm", LimbRole::kHand, 2},         {"knee", LimbRole::kShin, 3},
                       {"shin", LimbRole::kShin, 3},         {"calf", LimbRole::kShin, 3},
                       {"foot", LimbRole::kFoot, 3},         {"toe", LimbRole::kToe, 3},
                       {"hip", LimbRole::kThigh, 2},         {"arm", LimbRole::kUpperArm, 2},
                       {"leg", LimbRole::kShin, 2}};

std::vector<const Word*> wordsIn(std::string plain) {
  std::vector<const Word*> words;
  for (const Word& word : kWords) {
    const size_t at = plain.find(word.text);
    if (at == std::string::npos) continue;
    words.push_back(&word);
    plain.replace(at, std::string(word.text).size(), " ");
  }
  return words;
}

bool isLeg(LimbRole role) { return role >= LimbRole::kThigh; }

}  // namespace

std::string plainName(const std::string& name) {
  const size_t colon = name.find_last_of(":|");
  std::string plain = lower(colon == std::string::npos ? name : name.substr(colon + 1));
  for (const char* other : {"armature", "skeleton", "character"}) {
    const size_t at = plain.find(other);
    if (at != std::string::npos) plain.erase(at, std::string(other).size());
  }
  // "upper_arm", "Upper Arm" and "UpperArm" are one word; so are "up leg" and "fore.arm".
  std::string joined;
  for (const char c : plain) {
    if (std::isalnum(static_cast<unsigned char>(c))) joined += c;
  }
  return joined;
}

double nameScore(LimbRole role, const std::string& plain) {
  double score = 0;
  for (const Word* word : wordsIn(plain)) {
    if (word->role == role) {
      score = std::max(score, word->score);
      if (word->score < 0) return word->score;
    } else if (role == LimbRole::kClavicle && word->role == LimbRole::kUpperArm &&
               word->score < 2) {
      score = std::max(score, 1.5);  // "shoulder"
    } else if (role == LimbRole::kThigh && word->role == LimbRole::kShin && word->score < 3) {
      score = std::max(score, 1.0);  // "leg"
    } else if (word->score == 3 && score <= 0) {
      score = -3;
    }
  }
  if (countWords(plain, {"twist", "roll", "helper", "pole", "target", "ctrl"}) > 0) score -= 2;
  if (countWords(plain, {"thumb", "index", "middle", "ring", "pinky", "finger"}) > 0) score -= 3;
  return score;
}

int legOrArm(const std::string& plain) {
  int sum = 0;
  for (const Word* word : wordsIn(plain)) sum += isLeg(word->role) ? 1 : -1;
  return sum - (countWords(plain, {"thumb", "finger", "index", "pinky"}) > 0 ? 1 : 0);
}

bool isPelvisName(const std::string& plain) {
  return countWords(plain, {"pelvis"}) > 0 || plain == "hips" || plain == "hip" ||
         (plain.size() > 4 && plain.compare(plain.size() - 4, 4, "hips") == 0);
}
bool isNeckName(const std::string& plain) { return plain.find("neck") != std::string::npos; }
bool isHeadName(const std::string& plain) {
  return countWords(plain, {"head", "skull"}) > 0 &&
         countWords(plain, {"headtop", "headend", "headnub", "forehead", "site"}) == 0;
}
bool isAnimalName(const std::string& plain) {
  return countWords(plain, {"tail", "paw", "hoof", "forelimb", "hindlimb", "foreleg", "frontleg",
                            "hindleg", "backleg", "rearleg", "wing", "snout"}) > 0;
}

int sideOf(const std::string& name) {
  const size_t colon = name.find_last_of(":|");
  const std::string own = colon == std::string::npos ? name : name.substr(colon + 1);
  const std::string low = lower(own);
  if (low.find("left") != std::string::npos) return -1;
  if (low.find("right") != std::string::npos) return 1;
  // A letter that stands alone: "L Thigh", "arm_l", "hand.L.001", "lShldr", "LThumb".
  const auto side = [](char c) { return c == 'l' ? -1 : c == 'r' ? 1 : 0; };
  for (size_t i = 0; i < own.size(); i++) {
    const bool begins = i == 0 || !std::isalnum(static_cast<unsigned char>(own[i - 1]));
    const bool ends = i + 1 == own.size() || !std::isalnum(static_cast<unsigned char>(own[i + 1]));
    if (begins && ends && side(low[i])) return side(low[i]);
  }
  if (own.size() > 1 && side(low[0]) && std::isupper(static_cast<unsigned char>(own[1]))) {
    return side(low[0]);
  }
  if (own.size() > 3 && side(low[0]) && !wordsIn(low.substr(1)).empty() &&
      wordsIn(low).size() == wordsIn(low.substr(1)).size()) {
    return side(low[0]);  // "rshoulder", "lfemur"
  }
  return 0;
}

}  // namespace torso::tools
