// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What the names of a humanoid's bodies or joints say.

#include <initializer_list>
#include <string>

namespace torso::tools {

std::string lower(std::string text);

// How many of the words are in a text.
int countWords(const std::string& text, std::initializer_list<const char*> words);

// -1: a is on the left of b by their names ("l_leg", "r_leg"), 1: on the right, 0: they do not say.
int sideByName(const std::string& a, const std::string& b);

}  // namespace torso::tools
