// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/disc_plots.h"
#include "tools/disc_report.h"
#include "tools/error.h"
#include "tools/gnuplot.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;
using Quantity = DiscTest::Quantity;

struct Options {
  std::string level, plot_folder;
  double preload = 400;
  bool all = false, json = false;
};

// ---- JSON ----

Json matrixJson(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (int i = 0; i < 6; i++) {
    Json row = Json::array();
    for (int j = 0; j < 6; j++) row.push_back(matrix(i, j));
    rows.push_back(row);
  }
  return rows;
}

Json boundJson(double bound, double unit) {
  return std::isfinite(bound) ? Json(bound / unit) : Json();
}

Json testJson(const DiscOutcome& outcome) {
  const DiscTest& test = outcome.test;
  const DiscUnits units = discUnits(test.quantity);
  return {{"quantity", discQuantityName(test.quantity)},
          {"unit", units.value},
          {"load", test.load},
          {"load_unit", units.load},
          {"preload_n", test.preload},
          {"ours", outcome.ours ? Json(*outcome.ours / units.value_si) : Json()},
          {"published", test.value / units.value_si},
          {"low", boundJson(test.low, units.value_si)},
          {"high", boundJson(test.high, units.value_si)},
          {"inside", outcome.inside()},
          {"fit", test.fit},
          {"source", test.source},
          {"provenance", test.provenance},
          {"note", test.note}};
}

Json curveJson(const DiscLoading& loading) {
  const DiscUnits units = discUnits(loading.quantity);
  std::vector<double> displacement = loading.curve.displacement;
  for (double& x : displacement) x /= units.displacement_si;
  std::vector<double> pressure = loading.curve.nucleus_pressure;
  for (double& x : pressure) x /= 1e6;
  return {{"quantity", discQuantityName(loading.quantity)},
          {"preload_n", loading.preload},
          {"load_unit", units.load},
          {"displacement_unit", units.displacement},
          {"load", loading.curve.load},
          {"displacement", displacement},
          {"nucleus_pressure_mpa", pressure}};
}

Json discJson(const DiscReport& report) {
  Json tests = Json::array(), curves = Json::array();
  for (const DiscOutcome& outcome : report.outcomes) tests.push_back(testJson(outcome));
  for (const DiscLoading& loading : report.loadings) curves.push_back(curveJson(loading));
  return {{"name", report.disc.name},
          {"region", regionName(report.disc.region)},
          {"area_mm2", report.area * 1e6},
          {"tests", tests},
          {"stiffness_si", matrixJson(report.stiffness)},
          {"preload_n", report.preload},
          {"stiffness_preloaded_si", matrixJson(report.stiffness_preloaded)},
          {"curves", curves}};
}

// ---- text ----

// Three significant digits without an exponent.
std::string significant(double x) {
  return std::abs(x) >= 1000 ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
}

std::string rangeText(const DiscTest& test, double unit) {
  if (!std::isfinite(test.low) && !std::isfinite(test.high)) return "-";
  return significant(test.low / unit) + " - " + significant(test.high / unit);
}

std::string loadText(const DiscTest& test) {
  std::string text =
      test.load > 0 ? fmt::format("{:g} {}", test.load, discUnits(test.quantity).load) : "small";
  if (test.quantity == Quantity::kLossFactor) text = "1 Hz";
  if (test.preload > 0) text += fmt::format(" on {:g} N", test.preload);
  return text;
}

const char* verdict(const DiscOutcome& outcome) {
  if (!outcome.ours) return "gives way";
  if (!std::isfinite(outcome.test.low) && !std::isfinite(outcome.test.high)) return "";
  return outcome.inside() ? "yes" : *outcome.ours < outcome.test.low ? "LOW" : "HIGH";
}

void printDisc(const DiscReport& report) {
  fmt::print("{} ({}, {:.0f} mm2)\n", report.disc.name, regionName(report.disc.region),
             report.area * 1e6);
  fmt::print("  {:<16}{:<18}{:>8}{:>11}  {:<14}{:<8}{:<11}{}\n", "quantity", "load", "ours",
             "published", "range", "unit", "inside", "source");
  for (const DiscOutcome& outcome : report.outcomes) {
    const DiscTest& test = outcome.test;
    const DiscUnits units = discUnits(test.quantity);
    fmt::print("  {:<16}{:<18}{:>8}{:>11}  {:<14}{:<8}{:<11}{}\n", discQuantityName(test.quantity),
               loadText(test), outcome.ours ? significant(*outcome.ours / units.value_si) : "-",
               significant(test.value / units.value_si), rangeText(test, units.value_si),
               units.value, verdict(outcome), test.source);
  }
}

void printMatrix(const char* title, const Matrix6d& K) {
  fmt::print("  {} (x, y, z, rotations about them; SI)\n", title);
  for (int i = 0; i < 6; i++) {
    fmt::print("   ");
    // Without the noise of the differences.
    for (int j = 0; j < 6; j++) {
      const bool zero = std::abs(K(i, j)) < 1e-5 * std::sqrt(K(i, i) * K(j, j));
      fmt::print(" {:>11}", zero ? "0" : fmt::format("{:.4g}", K(i, j)));
    }
    fmt::print("\n");
  }
}

void printMatrices(const DiscReport& report) {
  printMatrix("stiffness for small displacements from rest", report.stiffness);
  printMatrix(fmt::format("the same under {:.0f} N", report.preload).c_str(),
              report.stiffness_preloaded);
  fmt::print("  ratio of the diagonals ");
  for (int i = 0; i < 6; i++) {
    fmt::print(" {:.2f}", report.stiffness_preloaded(i, i) / report.stiffness(i, i));
  }
  fmt::print(
      "\n  (whole lumbar segments, mean over the terms: 1.71 at 250 N, 2.11 at 500 N, "
      "Gardner-Morse and Stokes 2004)\n");
}

// Smallest and largest of a region's discs for each of its rows to fit.
void printSummary(const std::vector<DiscReport>& reports, Region region) {
  const DiscReport* first = nullptr;
  for (const DiscReport& report : reports) {
    if (report.disc.region == region && !first) first = &report;
  }
  if (!first) return;
  fmt::print("{} discs\n  {:<16}{:<18}{:<17}{:<10}{:<14}{:<8}{}\n", regionName(region), "quantity",
             "load", "ours", "published", "range", "unit", "outside");
  for (std::size_t t = 0; t < first->outcomes.size(); t++) {
    const DiscTest& test = first->outcomes[t].test;
    if (!test.fit) continue;
    const double unit = discUnits(test.quantity).value_si;
    double low = INFINITY, high = -INFINITY;
    std::string outside;
    for (const DiscReport& report : reports) {
      if (report.disc.region != region) continue;
      const DiscOutcome& outcome = report.outcomes[t];
      if (outcome.ours) low = std::min(low, *outcome.ours / unit);
      if (outcome.ours) high = std::max(high, *outcome.ours / unit);
      if (!outcome.inside()) outside += (outside.empty() ? "" : ", ") + report.disc.name;
    }
    fmt::print("  {:<16}{:<18}{:<17}{:<10}{:<14}{:<8}{}\n", discQuantityName(test.quantity),
               loadText(test), significant(low) + " - " + significant(high),
               significant(test.value / unit), rangeText(test, unit),
               discUnits(test.quantity).value, outside.empty() ? "none" : outside);
  }
}

void discs(const Options& options) {
  const Anatomy anatomy = Anatomy::load(anatomyFolder());
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const std::vector<Disc> chosen = chooseDiscs(anatomy, options.level);
  const bool curves = options.json || !options.plot_folder.empty();
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  std::vector<DiscReport> reports;
  {
    const ProgressBar bar;
    reports = benchDiscs(anatomy, skeleton, chosen, options.all, curves, options.preload, threads,
                         [&bar](double share) { bar.show(share); });
  }
  if (options.json) {
    Json json = Json::array();
    for (const DiscReport& report : reports) json.push_back(discJson(report));
    std::cout << Json{{"discs", json}}.dump(2) << '\n';
  } else {
    for (const DiscReport& report : reports) {
      printDisc(report);
      if (!options.level.empty()) printMatrices(report);
      fmt::print("\n");
    }
    for (Region region : kRegions) {
      if (options.level.empty()) printSummary(reports, region);
    }
    std::fflush(stdout);
  }
  if (options.plot_folder.empty()) return;
  writeDiscPlots(options.plot_folder, anatomy, reports);
  runGnuplot("discs", options.plot_folder, "discs.gp");
}

}  // namespace

void addDiscs(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("discs", "The discs on the laboratory's bench, against published tests.");
  command->footer(
      "Each disc between its two bones, without ligaments and facets, the lower bone clamped; the\n"
      "converged solution (quasi-static, double precision). Tests and sources are the rows of\n"
      "model/anatomy/disc_tests.csv for discs alone. Stiffnesses are secants from rest, or from "
      "the\n"
      "pose under the preload, to the load named; 'small' is 0.1 N or 1 mNm.\n"
      "Forces act at the centre of the disc, moments have a fixed axis. Flexion, extension, "
      "bending\n"
      "and torsion: all other motions free. Compression, tension and shear: rotations held for\n"
      "lumbar and thoracic discs, as by testing machines and shear rigs; free for cervical discs, "
      "as\n"
      "Moroney 1988 loaded them. Motions across the load are always free.\n"
      "--level adds the 6x6 stiffness matrices at rest and under --preload; for other discs than\n"
      "L4/L5 the preload is in proportion to the disc's area.\n\n"
      "Examples:\n"
      "  torso discs\n"
      "  torso discs --level L4/L5 --all\n"
      "  torso discs --plot out/discs\n"
      "  torso discs --json | jq '.discs[] | {name, tests}'");
  command->add_option("--level", options->level, "Only this disc, e.g. L4/L5");
  command
      ->add_option("--preload", options->preload, "Axial preload of the second matrix on L4/L5 [N]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--all", options->all, "All published tests of discs, not only those to fit");
  command->add_flag("--json", options->json, "Print JSON, with matrices and curves");
  command->add_option("--plot", options->plot_folder,
                      "Write the curves into this folder, and draw them with gnuplot");
  command->callback([options] { discs(*options); });
}

}  // namespace torso::tools
