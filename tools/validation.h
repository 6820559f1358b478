// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// What `torso validate` runs: a list of sections, each a call of one of torso's own commands, whose
// JSON becomes rows of a table beside published figures.

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace torso::tools {

using Json = nlohmann::ordered_json;

struct Row {
  std::string what, ours, published;
  std::optional<bool> inside = std::nullopt;  // of the published range; empty: nothing to compare
  std::string source = "";
  bool headline = false;  // shown in the page's first table too
};

struct Section {
  std::string id;  // of its files and of its part of the page
  std::string title, about;
  // Of torso, without --json; run in the report's folder, where "ID" is a folder for plots and
  // files.
  std::vector<std::string> arguments, short_arguments;  // none: not in the short form
  double seconds;                                       // that it takes about, on two idle cores
  std::function<std::vector<Row>(const Json&)> rows;
};

// What the user adds to what torso can do by itself: paths, "" and none where nothing is given.
struct ValidationInput {
  std::string clips;                   // a folder that torso retrofit has written
  std::vector<std::string> optimized;  // folders that torso optimize has written
  std::string build;                   // a build folder, whose tests print figures
  std::vector<std::string> humanoids;  // MJCF files that get the torso
};

// All sections, in the order of the page (validation_sections.cc).
std::vector<Section> validationSections(const ValidationInput& input);

struct SectionResult {
  bool failed = false;
  std::string message;  // why it failed, or what it remarked
  std::string command;  // as a user types it, in the report's folder
  std::string date;     // when it began, UTC
  double seconds = 0;   // wall time
  Json output;          // of the command; a text if that is no JSON
  std::vector<Row> rows;
};

// Runs sections as processes of this executable in `folder`, one after another. What a section gave
// is kept in FOLDER/ID.json, as a whole file; it is not run again if it was done by the same build
// of torso with the same command. progress: told the share that is done. Ends early, without a
// result for the section at hand, once `interrupted` says so. Throws Error if the folder cannot be
// written; a section that fails, or whose figures cannot be read, is a failed result.
std::vector<SectionResult> runSections(const std::vector<Section>& sections,
                                       const std::string& folder, bool short_form,
                                       const std::function<void(double)>& progress,
                                       const std::function<bool()>& interrupted);

// One HTML file, complete in itself: pictures, FOLDER/ID/*.png, are part of it. Sections without a
// result, at the end, are left out.
std::string validationPage(const std::vector<Section>& sections,
                           const std::vector<SectionResult>& results, const std::string& folder,
                           bool short_form);

}  // namespace torso::tools
