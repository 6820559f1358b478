// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "model/csv.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/retrofit_batch.h"
#include "tools/retrofit_clip.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  RetrofitBatch batch;
  std::string map, write_map, anatomy;
  bool explain = false, json = false;
};

void explain(const Json& clip) {
  fmt::print("{}\n", clip["clip"].get<std::string>());
  for (const Json& part : clip["parts"]) {
    std::string joints;
    for (const std::string joint : part["joints"]) joints += (joints.empty() ? "" : ", ") + joint;
    fmt::print("  {:<16} {:<28} {}: {}\n", part["part"].get<std::string>(),
               joints.empty() ? "-" : joints, part["sureness"].get<std::string>(),
               part["reason"].get<std::string>());
  }
  fmt::print("  stature {:.2f} m, trunk {:.3f} of the tables', limbs on top of it:",
             clip["stature_m"].get<double>(), clip["torso_scale"].get<double>());
  for (const auto& [segment, scale] : clip["limb_scale"].items()) {
    fmt::print(" {} {:.3f}", segment, scale.get<double>());
  }
  fmt::print("\n");
  for (const std::string note : clip["notes"]) fmt::print("  note: {}\n", note);
  if (!clip["kept_at_rest"].empty()) {
    std::string names;
    for (const std::string name : clip["kept_at_rest"]) names += (names.empty() ? "" : ", ") + name;
    fmt::print("  not in the clip, kept at rest: {}\n", names);
  }
}

void print(const Json& row) {
  if (row.contains("error")) return;  // told on stderr
  const auto number = [&](const char* key, const char* of) { return row[key][of].get<double>(); };
  fmt::print(
      "{:<40} {:>6} {:>7.2f} {:>7.2f} {:>6.2f} {:>7.2f} {:>6.2f} {:>6.2f} {:>5.2f}  {:>4} {}\n",
      row["clip"].get<std::string>(), row["frames"].get<size_t>(), row["seconds"].get<double>(),
      row["core_seconds"].get<double>(), row["core_s_per_s"].get<double>(),
      number("held_error_mm", "median"), number("held_error_mm", "p95"),
      number("held_error_deg", "median"), number("held_error_deg", "p95"),
      row["frames_flagged"].get<size_t>(), row["flags"].get<std::string>());
}

// How far the held bones are off, over the frames of all takes.
struct HeldErrors {
  std::vector<double> mm, degrees;

  void print(const char* which) const {
    if (mm.empty()) return;
    const auto at = [](std::vector<double> values, double share) {
      std::sort(values.begin(), values.end());
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    std::size_t close = 0;
    for (std::size_t i = 0; i < mm.size(); i++) close += mm[i] < 10 && degrees[i] < 3;
    const double within = 100.0 * static_cast<double>(close) / static_cast<double>(mm.size());
    fmt::print(
        "held bones in {:>6} frames {:<15} median {:.2f} mm {:.2f} deg, 95 % {:.2f} mm {:.2f} deg, "
        "within 10 mm and 3 deg {:.1f} %\n",
        mm.size(), which, at(mm, 0.5), at(degrees, 0.5), at(mm, 0.95), at(degrees, 0.95), within);
  }
};

// Of all takes together, from their read-outs.
void printAll(const Json& rows, const std::string& folder) {
  HeldErrors all, reached;
  for (const Json& row : rows) {
    if (row.contains("error")) continue;
    const CsvTable table(folder + "/" + row["clip"].get<std::string>() + "_readouts.csv");
    for (int i = 0; i < table.rows(); i++) {
      for (HeldErrors* errors : {&all, &reached}) {
        if (errors == &reached && !table.empty(i, "flags")) continue;
        errors->mm.push_back(table.number(i, "held_error_mm"));
        errors->degrees.push_back(table.number(i, "held_error_deg"));
      }
    }
  }
  all.print("in all");
  reached.print("not flagged");
}

// Only what the clips' joints are.
Json recognise(const Options& options, const Anatomy& tables) {
  Json rows = Json::array();
  for (const std::string& file : clipFiles(options.batch.inputs)) {
    std::vector<std::string> errors;
    const std::string stem = std::filesystem::path(file).stem().string();
    for (const Person& person :
         readPersons(file, stem, options.batch.rate, options.batch.map, &errors)) {
      try {
        rows.push_back(describePerson(tables, person));
      } catch (const Error& e) {
        errors.push_back(e.what());
        continue;
      }
      if (!options.write_map.empty()) {
        writeFile(options.write_map,
                  writePartMap(mapOf(person.clip, person.roles), roleMapParts()));
      }
    }
    for (const std::string& e : errors) rows.push_back({{"file", file}, {"error", e}});
  }
  return rows;
}

void run(Options options) {
  RetrofitBatch& batch = options.batch;
  const bool only_recognise = batch.output.empty();
  if (only_recognise && !options.explain && options.write_map.empty()) {
    throw Error(
        "give a folder to write into, -o DIR (or --explain, to see what a clip's joints "
        "are taken for)");
  }
  if (!only_recognise && !options.write_map.empty()) {
    throw Error("--write-map goes without -o: correct the map, then give it with --map");
  }
  if (!only_recognise) checkFolder(batch.output);
  if (clipFiles(batch.inputs).empty()) throw Error("there is no clip in the folders given");
  if (!options.map.empty()) batch.map = readPartMap(options.map, roleMapParts());
  const Anatomy tables = Anatomy::load(options.anatomy.empty() ? anatomyFolder() : options.anatomy);

  const Processes processes;
  if (processes.rank() > 0 && only_recognise) return processes.leave();
  const Json rows =
      only_recognise ? recognise(options, tables) : retrofitBatch(tables, batch, processes);
  processes.leave();
  if (processes.rank() > 0) return;  // the first one tells
  if (options.json) {
    std::cout << rows.dump(2) << '\n';
  } else {
    for (const Json& row : rows) {
      if (options.explain && !row.contains("error")) explain(row);
    }
    if (!only_recognise) {
      fmt::print("{:<40} {:>6} {:>7} {:>7} {:>6} {:>14} {:>12}  flagged frames\n", "clip", "frames",
                 "s", "core-s", "/ s", "held, mm", "held, deg");
      for (const Json& row : rows) print(row);
      printAll(rows, batch.output);
    }
  }
  std::cout << std::flush;
  size_t failed = 0;
  for (const Json& row : rows) {
    if (!row.contains("error")) continue;
    failed++;
    fmt::print(stderr, "torso retrofit: {}\n", row["error"].get<std::string>());
  }
  if (failed == rows.size()) throw Error("no clip could be used");
  if (failed) throw Error(fmt::format("{} failed, {} went through", failed, rows.size() - failed));
}

}  // namespace

void addRetrofit(CLI::App& app) {
  auto options = std::make_shared<Options>();
  RetrofitBatch& batch = options->batch;
  CLI::App* command = app.add_subcommand(
      "retrofit", "Recover spine and shoulder motion from motion capture clips.");
  command->footer(
      "Reads BVH, FBX, glTF and GLB with a human skeleton of any names, unit and axes. Writes for\n"
      "each clip\n"
      "  NAME.csv, NAME.bin   the motion of all bones, for torso view and render --motion\n"
      "  NAME.xml             the body in the person's size, for the same\n"
      "  NAME.bvh, NAME.glb   the motion for other programs; GLB has the bones' meshes\n"
      "  NAME_readouts.csv    turns, disc pressures, ligaments, facets and flags of each frame\n"
      "  NAME.json            the report on a file, and the mark that it is done\n"
      "and summary.csv. What is done and newer than its clip is skipped: after Ctrl-C the same\n"
      "command goes on where it was. What fails is reported and does not stop the others; the "
      "exit\n"
      "status is 0 if all went through, else 1. Under mpirun (OpenMPI) the processes share the\n"
      "files, for one folder that all machines have.\n\n"
      "The table: frames, seconds of motion, core-seconds of work and both divided; how far held\n"
      "bones (head, upper arms) are from where the clip has them, median and 95 % over frames of\n"
      "the worst bone; frames flagged, and why. The last lines are about all takes together.\n\n"
      "Examples:\n"
      "  torso retrofit walk.bvh -o out\n"
      "  torso retrofit clips/ --jobs 4 -o out\n"
      "  mpirun -n 8 torso retrofit clips/ -o out\n"
      "  torso render out/walk.xml --motion out/walk.bin --video walk.mp4\n"
      "  torso retrofit odd.glb --explain --write-map map.json   what is taken for what, and why\n"
      "  torso retrofit odd.glb --map map.json -o out            with that corrected");
  command->add_option("CLIP", batch.inputs, "Motion capture files, or folders of them")->required();
  command->add_option("-o,--output", batch.output, "Folder to write into");
  command->add_option("--jobs", batch.jobs, "Clips worked on at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--rate", batch.rate,
                   "Frames per second [Hz] (default: the clip's own, but at most 30)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--again", batch.again, "Also what is done already");
  command->add_option("--map", options->map, "JSON file that says which joint is what");
  command->add_option("--write-map", options->write_map,
                      "Write what was recognised to this file, to be edited for --map");
  command->add_flag("--explain", options->explain, "Say what was recognised and why");
  command->add_flag("--temporary", batch.temporary,
                    "Also write NAME_temporary.xml and .csv: the skeleton that the clip is put on "
                    "before its torso is filled in");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->add_flag("--json", options->json, "Print the report as JSON on stdout");
  command->callback([options] { run(*options); });
}

}  // namespace torso::tools
