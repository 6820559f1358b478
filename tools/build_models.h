// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "model/anatomy.h"
#include "tools/own_bones.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {

// The whole body's file: "human.xml", "human_fixed.xml", "human_simple.xml".
std::string humanFile(TorsoKind kind);

// The file of that name beside a detailed body's: "<folder>/body_fixed.xml" for
// "<folder>/body.xml"; "" if it is not there.
std::string humanBeside(const std::string& human, TorsoKind kind);

// The whole body's files of those kinds, with the detailed one torso.xml and torso_held.xml, and
// scene.xml and the bone meshes in assets/: contents by path within their folder. Bones are made on
// so many threads, each bone the same whatever their number; `progress` is told the share that is
// done, 0 to 1, from any of them but one at a time. `own` bones, if given, take the place of the
// generated ones. `muscles`: in torso.xml and human.xml.
std::map<std::string, std::string> buildModels(
    const Anatomy& anatomy, int threads, const std::function<void(double)>& progress = nullptr,
    const OwnBones* own = nullptr, bool muscles = false,
    const std::set<TorsoKind>& kinds = {TorsoKind::kDetailed, TorsoKind::kFixed,
                                        TorsoKind::kSimple});

}  // namespace torso::tools
