// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/progress_bar.h"
#include "tools/validation.h"

namespace torso::tools {
namespace {

// Of Debian's libmujoco-samples.
constexpr const char* kHumanoid = "/usr/share/mujoco/model/humanoid/humanoid.xml";

struct Options {
  std::string folder = "validation";
  ValidationInput input;
  std::vector<std::string> only;
  bool short_form = false, json = false, list = false;
};

volatile std::sig_atomic_t interrupted = 0;

void onInterrupt(int) {
  interrupted = 1;
  std::signal(SIGINT, SIG_DFL);
}

// Those of the form, and of --only, that there are.
std::vector<Section> chosen(const Options& options) {
  const std::vector<Section> all = validationSections(options.input);
  std::vector<std::string> ids;
  for (const Section& section : all) ids.push_back(section.id);
  for (const std::string& id : options.only) {
    if (std::find(ids.begin(), ids.end(), id) != ids.end()) continue;
    throw Error(fmt::format("--only {}: there is no such section; choose from {}", id,
                            fmt::join(ids, ", ")));
  }
  std::vector<Section> sections;
  for (const Section& section : all) {
    const auto& only = options.only;
    if (!only.empty() && std::find(only.begin(), only.end(), section.id) == only.end()) continue;
    if (options.short_form && section.short_arguments.empty()) continue;
    sections.push_back(section);
  }
  if (sections.empty()) throw Error("--only: the short form has none of these sections");
  return sections;
}

void validate(const Options& options) {
  const std::vector<Section> sections = chosen(options);
  if (options.list) {
    for (const Section& section : sections) {
      fmt::print("{:<26}{:<56}{}\n", section.id, section.title,
                 fmt::join(options.short_form ? section.short_arguments : section.arguments, " "));
    }
    return;
  }
  checkFolder(options.folder);
  std::signal(SIGINT, onInterrupt);
  std::vector<SectionResult> results;
  {
    const ProgressBar bar;
    results = runSections(
        sections, options.folder, options.short_form, [&](double share) { bar.show(share); },
        [] { return interrupted != 0; });
  }
  if (interrupted) {
    std::cerr << fmt::format(
        "torso validate: interrupted after {} of {} sections; the same command goes on\n",
        results.size(), sections.size());
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
  const std::string page = options.folder + "/index.html";
  writeFile(page, validationPage(sections, results, options.folder, options.short_form));
  Json json = {{"page", page}, {"sections", Json::array()}};
  std::string failures;
  for (std::size_t i = 0; i < results.size(); i++) {
    const SectionResult& result = results[i];
    json["sections"].push_back({{"id", sections[i].id},
                                {"command", result.command},
                                {"date", result.date},
                                {"seconds", result.seconds},
                                {"failed", result.failed},
                                {"message", result.message}});
    if (result.failed) failures += (failures.empty() ? "" : ", ") + sections[i].id;
  }
  if (options.json) {
    std::cout << json.dump(2) << '\n';
  } else {
    for (std::size_t i = 0; i < results.size(); i++) {
      fmt::print("{:<26}{:>8.1f} s  {}\n", sections[i].id, results[i].seconds,
                 results[i].failed ? "failed: " + results[i].message : "done");
    }
    fmt::print("{}\n", page);
  }
  std::cout << std::flush;
  std::fflush(stdout);
  if (!failures.empty()) throw Error("failed sections: " + failures);
}

}  // namespace

void addValidate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "validate", "Run all validations and write one page of their figures and pictures.");
  command->footer(
      "Runs torso's own commands (--list) one after another and writes FOLDER/index.html, a page\n"
      "that needs no other file: tables of our figures beside published ones, plots (with "
      "gnuplot),\n"
      "pictures, sources, version, machine, date, and command and time of each section. Each\n"
      "section's result is kept in FOLDER/SECTION.json: started again after an interruption, the "
      "same\n"
      "command goes on; a section that this build has done with the same options is not run "
      "again.\n"
      "A section that fails is shown as failed, and the exit status is 1.\n\n"
      "Examples:\n"
      "  torso validate -o report                     13 minutes on two idle cores\n"
      "  torso validate --short -o short              half a minute, for continuous integration\n"
      "  torso validate --only rom,pressure\n"
      "  torso validate -o report --clips out --optimized swing,jump --tests build");
  command->add_option("-o,--output", options->folder, "Folder of the page and of the results")
      ->capture_default_str();
  command->add_flag("--short", options->short_form, "A part of each section, some left out");
  command->add_option("--only", options->only, "Only these sections, with commas")->delimiter(',');
  command
      ->add_option("--clips", options->input.clips,
                   "Folder that torso retrofit has written: with statistics of it")
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--optimized", options->input.optimized,
                   "Folders that torso optimize has written, with commas")
      ->delimiter(',')
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--tests", options->input.build,
                   "Build folder: with the figures that tests print")
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--humanoids", options->input.humanoids,
                   "MJCF humanoids to graft the torso into, with commas (default: MuJoCo's own)")
      ->delimiter(',')
      ->check(CLI::ExistingFile);
  command->add_flag("--list", options->list, "List the sections and their commands, run nothing");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] {
    if (options->input.humanoids.empty() && std::filesystem::exists(kHumanoid)) {
      options->input.humanoids = {kHumanoid};
    }
    validate(*options);
  });
}

}  // namespace torso::tools
