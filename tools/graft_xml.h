// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Small helpers to read and change MJCF with tinyxml2.

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

namespace torso::tools {

// The value of an attribute, "" if it is not there.
std::string text(const tinyxml2::XMLElement* e, const char* attribute);

// The name of an element, or "<tag> in line N".
std::string nameOrTag(const tinyxml2::XMLElement* e);

// Numbers of an attribute, `missing` if it is not there.
std::vector<double> numbers(const tinyxml2::XMLElement* e, const char* attribute,
                            const std::vector<double>& missing = {});

Eigen::Isometry3d isometry(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& position);

// Sets pos and quat, whatever else gave the orientation before.
void setPose(tinyxml2::XMLElement* e, const Eigen::Isometry3d& X);

// Visits the children of <mujoco> of that name; the visitor may delete the one it gets.
void forEachSection(tinyxml2::XMLElement* root, const char* name,
                    const std::function<void(tinyxml2::XMLElement*)>& visit);

// The first section of that name, made if there is none.
tinyxml2::XMLElement* section(tinyxml2::XMLElement* root, const char* name);

// The value of an attribute over all sections of that name: the last one counts.
std::string setting(tinyxml2::XMLElement* root, const char* name, const char* attribute);

void setSetting(tinyxml2::XMLElement* root, const char* name, const char* attribute,
                const std::string& value);

}  // namespace torso::tools
