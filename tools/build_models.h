// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>

#include "model/anatomy.h"
#include "tools/own_bones.h"

namespace torso::tools {

// torso.xml, human.xml, human_fixed.xml, scene.xml, torso_held.xml and the bone meshes in assets/:
// contents by path within their folder. Bones are made on so many threads, each bone the same
// whatever their number; `progress` is told the share that is done, 0 to 1, from any of them but
// one at a time. `own` bones, if given, take the place of the generated ones. `muscles`: in
// torso.xml and human.xml.
std::map<std::string, std::string> buildModels(
    const Anatomy& anatomy, int threads, const std::function<void(double)>& progress = nullptr,
    const OwnBones* own = nullptr, bool muscles = false);

}  // namespace torso::tools
