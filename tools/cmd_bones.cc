// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "model/bone_fit.h"
#include "model/bone_measure.h"
#include "model/skeleton.h"
#include "tools/bone_pictures.h"
#include "tools/commands.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> only;
  std::string plot_folder;
  bool json = false;
};

// A measure of ours, a published one, or both of one thing.
struct Row {
  std::string bone, quantity, unit;
  const BoneMeasure* ours = nullptr;
  const PublishedMeasure* published = nullptr;
};

std::string unitOf(const std::string& quantity) {
  const auto ends = [&](const std::string& end) {
    return quantity.size() >= end.size() &&
           quantity.compare(quantity.size() - end.size(), end.size(), end) == 0;
  };
  return ends("angle") ? "deg" : ends("area") ? "mm2" : ends("volume") ? "cm3" : "mm";
}

std::vector<Row> compare(const std::vector<BoneMeasure>& ours,
                         const std::vector<PublishedMeasure>& published) {
  std::vector<Row> rows;
  std::set<const PublishedMeasure*> used;
  for (const BoneMeasure& m : ours) {
    Row row{m.bone, m.quantity, unitOf(m.quantity), &m, nullptr};
    for (const PublishedMeasure& p : published) {
      if (p.bone == m.bone && p.quantity == m.quantity) row.published = &p;
    }
    used.insert(row.published);
    rows.push_back(row);
  }
  for (const PublishedMeasure& p : published) {
    if (!used.count(&p)) rows.push_back({p.bone, p.quantity, p.unit, nullptr, &p});
  }
  return rows;
}

const char* verdict(const Row& row) {
  if (!row.published) return "";
  if (!row.ours) return "MISSING";
  if (inside(*row.published, row.ours->value)) return "yes";
  return row.ours->value < row.published->mean ? "LOW" : "HIGH";
}

Json rowJson(const Row& row) {
  const double unit = measureUnit(row.unit);
  Json json = {{"bone", row.bone},
               {"quantity", row.quantity},
               {"unit", row.unit},
               {"ours", row.ours ? Json(row.ours->value / unit) : Json()}};
  if (row.published) {
    const PublishedMeasure& p = *row.published;
    json["published"] = p.mean / unit;
    json["sd"] = p.sd > 0 ? Json(p.sd / unit) : Json();
    json["inside"] = row.ours ? inside(p, row.ours->value) : false;
    json["source"] = p.source;
    json["provenance"] = p.provenance;
    json["note"] = p.note;
  }
  return json;
}

void print(const std::vector<Row>& rows) {
  std::string bone;
  int compared = 0, within = 0;
  for (const Row& row : rows) {
    if (row.bone != bone) {
      bone = row.bone;
      fmt::print("{}\n  {:<32}{:>8}{:>11}{:>8}  {:<5}{:<9}{}\n", bone, "quantity", "ours",
                 "published", "SD", "unit", "inside", "source");
    }
    const double unit = measureUnit(row.unit);
    const std::string ours = row.ours ? fmt::format("{:.1f}", row.ours->value / unit) : "-";
    std::string mean = "-", sd = "-", source;
    if (row.published) {
      mean = fmt::format("{:.1f}", row.published->mean / unit);
      if (row.published->sd > 0) sd = fmt::format("{:.1f}", row.published->sd / unit);
      source = row.published->source + " (" + row.published->provenance + ")";
      compared++;
      within += row.ours && inside(*row.published, row.ours->value);
    }
    fmt::print("  {:<32}{:>8}{:>11}{:>8}  {:<5}{:<9}{}\n", row.quantity, ours, mean, sd, row.unit,
               verdict(row), source);
  }
  fmt::print("{} of {} published measures inside\n", within, compared);
}

Json fitJson(const FitCheck& check) {
  const double unit = check.length ? 1e-3 : 1;
  const auto number = [&](double x) { return std::isfinite(x) ? Json(x / unit) : Json(); };
  return {{"check", check.check},
          {"where", check.where},
          {"unit", check.length ? "mm" : "-"},
          {"value", number(check.value)},
          {"low", number(check.low)},
          {"high", number(check.high)},
          {"passed", check.passed()}};
}

// One line for each check with its extremes, and the places where it fails.
void print(const std::vector<FitCheck>& checks) {
  fmt::print("fit\n  {:<20}{:>7}{:>20}{:>16}  {:<4}{}\n", "check", "places", "least - most",
             "bounds", "unit", "fails");
  const auto number = [](double x) {
    return std::isfinite(x) ? fmt::format("{:.2f}", x) : std::string("-");
  };
  std::vector<std::string> names;
  for (const FitCheck& c : checks) {
    if (std::find(names.begin(), names.end(), c.check) == names.end()) names.push_back(c.check);
  }
  for (const std::string& name : names) {
    double least = INFINITY, most = -INFINITY, low = 0, high = 0, unit = 1;
    int places = 0, fails = 0;
    for (const FitCheck& c : checks) {
      if (c.check != name) continue;
      unit = c.length ? 1e-3 : 1;
      least = std::min(least, c.value / unit);
      most = std::max(most, c.value / unit);
      low = c.low / unit;
      high = c.high / unit;
      places++;
      fails += !c.passed();
    }
    fmt::print("  {:<20}{:>7}{:>20}{:>16}  {:<4}{}\n", name, places,
               number(least) + " - " + number(most), number(low) + " - " + number(high),
               unit < 1 ? "mm" : "-", fails ? std::to_string(fails) : "none");
    for (const FitCheck& c : checks) {
      if (c.check == name && !c.passed()) {
        fmt::print("    {:<50}{:>10}\n", c.where, number(c.value / unit));
      }
    }
  }
}

void drawInto(const std::string& folder) {
  checkFolder(folder);
  std::map<std::string, std::string> files;
  for (const auto& [name, png] : drawBones(mjcfFolder())) files[folder + "/" + name] = png;
  writeFiles(files);
}

void bones(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const std::vector<std::string> all = bodyNames(anatomy);
  for (const std::string& body : options.only) {
    if (std::find(all.begin(), all.end(), body) == all.end()) {
      throw Error(fmt::format("no body of the torso is called '{}'; choose from {}", body,
                              fmt::join(all, ", ")));
    }
  }
  if (!options.plot_folder.empty()) drawInto(options.plot_folder);
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  const Skeleton skeleton(anatomy, options.only.empty() ? all : options.only, threads);
  const std::vector<BoneMeasure> ours = measureBones(anatomy, skeleton);
  std::vector<PublishedMeasure> published;
  for (const PublishedMeasure& row : loadPublishedMeasures(anatomyFolder())) {
    if (skeleton.has(bodyOfBone(row.bone))) published.push_back(scaled(row, anatomy.length_scale));
  }
  const std::vector<Row> rows = compare(ours, published);
  const std::vector<FitCheck> fit = checkFit(anatomy, skeleton, threads);
  if (options.json) {
    Json json = Json::array();
    for (const Row& row : rows) json.push_back(rowJson(row));
    Json fit_json = Json::array();
    for (const FitCheck& check : fit) fit_json.push_back(fitJson(check));
    std::cout << Json{{"measures", json}, {"fit", fit_json}}.dump(2) << '\n';
    return;
  }
  print(rows);
  print(fit);
  std::fflush(stdout);
}

}  // namespace

void addBones(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "bones", "Measures the bones' surfaces and compares them with published measures.");
  command->footer(
      "Measures are taken on the generated meshes, as with a caliper; published ones are the rows "
      "of\nmodel/anatomy/bone_measures.csv. Inside: within one SD of the mean, or 5 % of it where "
      "no SD is\nknown.\n\n"
      "Examples:\n"
      "  torso bones\n"
      "  torso bones --only L4 L5 pelvis\n"
      "  torso bones --plot pictures\n"
      "  torso bones --json | jq '.measures[] | select(.inside == false)'");
  command->add_option("--only", options->only, "Only these bodies, e.g. L4 pelvis left_scapula");
  command->add_option("--plot", options->plot_folder,
                      "Also draw the bones of the models that come with the project, into PNG "
                      "files in this folder");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { bones(*options); });
}

}  // namespace torso::tools
