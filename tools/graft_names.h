// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// The names in an MJCF document: which elements define them and which attributes refer to them.

#include <tinyxml2.h>

#include <functional>
#include <set>
#include <string>
#include <utility>

namespace torso::tools {

// A kind of object with names of its own ("body", "joint", "geom", "site", "camera", "light",
// "mesh", "texture", "material", "hfield", "skin", "tendon", "actuator", "sensor", "equality",
// "numeric", "text", "tuple", "key", "pair", "exclude", or "class" for defaults), and a name.
using MjcfName = std::pair<std::string, std::string>;

// Called with an element, the attribute that holds a name, the name's kind, and whether the element
// defines it (or else refers to it).
using NameVisitor = std::function<void(tinyxml2::XMLElement* element, const char* attribute,
                                       const std::string& kind, bool defines)>;

// Visits every name below `section`, a child of <mujoco>. The visitor may change the attribute's
// value, but not the tree.
void visitNames(tinyxml2::XMLElement* section, const NameVisitor& visit);

// The kind of object that an element defines, "" if none. `section` is the tag of the child of
// <mujoco> that holds it.
std::string definedKind(const tinyxml2::XMLElement* element, const std::string& section);

// All names that a document's root element <mujoco> defines.
std::set<MjcfName> definedNames(tinyxml2::XMLElement* root);

}  // namespace torso::tools
