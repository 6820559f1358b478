// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/run_record.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include "model/disc_batch.h"
#include "model/fnv1a.h"
#include "plugin/mujoco_torso.h"
#include "plugin/note.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

// The members of Extremes with their names in a record.
template <typename E, typename Visit>
void visitExtremes(E& e, const Visit& visit) {
  visit("max_disc_pressure", e.max_disc_pressure);
  visit("min_disc_thickness", e.min_disc_thickness);
  visit("max_disc_thickness", e.max_disc_thickness);
  visit("min_disc_column", e.min_disc_column);
  visit("max_disc_column", e.max_disc_column);
  visit("max_ligament_violation", e.max_ligament_violation);
  visit("max_facet_violation", e.max_facet_violation);
}

void readBins(const Json& bins, LengthHistogram* histogram) {
  for (const Json& bin : bins) {
    if (!histogram->addBin(bin.at(0), bin.at(1))) throw Error("a bin that does not exist");
  }
}

}  // namespace

std::string recordText(const RunResult& run, const Violations& violations) {
  Json json = {
      {"seed", run.seed},         {"failure", run.failure},         {"warnings", run.warnings},
      {"steps", run.steps},       {"constraints", run.constraints}, {"core_s", run.core_seconds},
      {"on_floor", run.on_floor}, {"state_hash", run.state_hash}};
  visitExtremes(run.extremes, [&](const char* name, const Extreme& extreme) {
    json[name] = {extreme.value, extreme.id, extreme.time};
  });
  json["ligament_violations"] = violations.ligament.bins();
  json["facet_violations"] = violations.facet.bins();
  // MuJoCo's messages may quote a model's names in any encoding.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

RunResult parseRecord(const std::string& text, const std::string& where, Violations* all) {
  try {
    const Json json = Json::parse(text);
    RunResult run;
    run.seed = json.at("seed");
    run.done = true;
    run.failure = json.at("failure");
    run.warnings = json.at("warnings");
    run.steps = json.at("steps");
    run.constraints = json.at("constraints");
    run.core_seconds = json.at("core_s");
    run.on_floor = json.at("on_floor");
    run.state_hash = json.at("state_hash");
    visitExtremes(run.extremes, [&](const char* name, Extreme& extreme) {
      const Json& array = json.at(name);
      extreme = {array.at(0), array.at(1), array.at(2), run.seed};
    });
    readBins(json.at("ligament_violations"), &all->ligament);
    readBins(json.at("facet_violations"), &all->facet);
    return run;
  } catch (const std::exception& e) {
    throw Error(
        fmt::format("{}: not a result of torso run ({}); delete it to have that seed run "
                    "again",
                    where, e.what()));
  }
}

// Hash of the model as a binary file, without the plugin's note, which differs in each process.
std::uint64_t modelHash(const mjModel* m) {
  const std::unique_ptr<mjModel, Deleter> copy(mj_copyModel(nullptr, m));
  if (!copy) throw Error("not enough memory to copy the model");
  for (int i = 0; i < copy->nnumeric; i++) {
    const std::string name = copy->names + copy->name_numericadr[i];
    const std::string note = plugin::kNoteName;
    const bool ends = name.size() >= note.size() &&
                      name.compare(name.size() - note.size(), note.size(), note) == 0;
    if (ends && copy->numeric_size[i] > 1) copy->numeric_data[copy->numeric_adr[i] + 1] = 0;
  }
  std::vector<unsigned char> bytes(mj_sizeModel(copy.get()));
  mj_saveModel(copy.get(), nullptr, bytes.data(), static_cast<int>(bytes.size()));
  Fnv1a hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

Json runSettings(const mjModel* m, const RolloutOptions& options) {
  static constexpr std::array<const char*, 3> kControls = {"none", "hold", "random"};
  return {{"torso", torso_versionString()},
          {"mujoco", mj_versionString()},
          {"instruction_set", DiscBatch::instructionSet()},
          {"model", fmt::format("{:016x}", modelHash(m))},
          {"timestep", m->opt.timestep},
          {"seconds", options.seconds},
          {"control", kControls.at(static_cast<std::size_t>(options.control))},
          {"amplitude", options.amplitude},
          {"drop", options.lift},
          {"keyframe", options.keyframe}};
}

void checkSettings(const Json& ours, const std::string& theirs, const std::string& where) {
  const Json other = Json::parse(theirs, nullptr, false);
  if (!other.is_object()) throw Error(where + ": not the settings of torso run; delete the folder");
  for (const auto& [name, value] : ours.items()) {
    const Json there = other.contains(name) ? other[name] : Json();
    if (there != value) {
      throw Error(
          fmt::format("{}: {} is {} there, but {} now; results of different settings cannot "
                      "be merged",
                      where, name, there.dump(), value.dump()));
    }
  }
}

RunFolder::RunFolder(const std::string& path, const Json& settings, bool resume)
    : path_(path), settings_(path + "/settings.json"), result_(path + "/result.json") {
  const bool has_results = std::filesystem::exists(settings_);
  if (has_results && !resume) {
    throw Error(path +
                ": holds results already; add --resume to go on with them, or choose "
                "another folder");
  }
  if (has_results) checkSettings(settings, readFile(settings_), settings_);
  text_ = settings.dump(2) + "\n";
}

void RunFolder::open() const {
  makeFolder(path_);
  writeFile(settings_, text_);
  std::error_code error;
  std::filesystem::remove(result_, error);
}

void RunFolder::finish(const std::string& text) const { writeFile(result_, text); }

std::set<std::uint64_t> RunFolder::seeds(std::uint64_t first, int count) const {
  std::set<std::uint64_t> seeds;
  if (!std::filesystem::exists(settings_)) return seeds;
  for (int i = 0; i < count; i++) {
    if (std::filesystem::exists(file(first + i))) seeds.insert(first + i);
  }
  return seeds;
}

std::string RunFolder::file(std::uint64_t seed) const {
  return fmt::format("{}/seed{}.json", path_, seed);
}

void RunFolder::save(std::uint64_t seed, const std::string& text) const {
  writeFile(file(seed), text + "\n");
}

std::string RunFolder::load(std::uint64_t seed) const {
  const std::string text = readFile(file(seed));
  Violations unused;
  const RunResult run = parseRecord(text, file(seed), &unused);
  if (run.seed != seed) {
    throw Error(fmt::format("{}: holds seed {}; delete it to have this seed run again", file(seed),
                            run.seed));
  }
  return text;
}

}  // namespace torso::tools
