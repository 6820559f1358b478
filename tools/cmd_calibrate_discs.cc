// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "model/disc_calibration.h"
#include "model/disc_fit.h"
#include "model/parallel.h"
#include "tools/bone_files.h"
#include "tools/commands.h"
#include "tools/disc_report.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

const char kTable[] = "disc_materials.csv";

struct Options {
  std::string folder;
  std::vector<std::string> levels;
  bool json = false;
};

struct DiscFit {
  std::string disc;
  DiscMaterial before;
  DiscCalibration fit;
  std::vector<std::string> outside;  // quantities that are not in their range
};

// As the table's units: moduli in MPa.
double tableValue(const FittedConstant& constant, const DiscMaterial& material) {
  return material.*constant.member / constant.unit;
}

std::string tableText(const FittedConstant& constant, const DiscMaterial& material) {
  return fmt::format("{:.4g}", tableValue(constant, material));
}

// The material as the table will give it back.
DiscMaterial rounded(DiscMaterial material) {
  for (const FittedConstant& constant : fittedConstants()) {
    material.*constant.member = std::stod(tableText(constant, material)) * constant.unit;
  }
  return material;
}

std::vector<std::string> outsideOf(const Disc& disc, const DiscMesh& mesh,
                                   const std::vector<DiscTest>& tests,
                                   const DiscMaterial& material) {
  std::vector<std::string> outside;
  const DiscBench bench(mesh, material);
  for (const DiscTest& test : tests) {
    DiscOutcome outcome = {test, std::nullopt};
    try {
      outcome.ours = simulateDiscTest(bench, disc.retardation_time, test);
    } catch (const DiscGaveWay&) {
    }
    if (!outcome.inside()) outside.push_back(discQuantityName(test.quantity));
  }
  return outside;
}

DiscFit fitDisc(const Anatomy& anatomy, const Skeleton& skeleton, const Disc& disc) {
  std::vector<DiscTest> tests;
  for (const DiscTest& test : anatomy.disc_tests) {
    if (test.region == disc.region && test.fit) tests.push_back(test);
  }
  // From the published constants, so that the answer does not depend on the table's last one.
  DiscMaterial start = disc.material;
  for (const FittedConstant& c : fittedConstants()) start.*c.member = c.typical;
  const DiscMesh mesh = fittedDiscMesh(anatomy, skeleton, disc);
  DiscFit result = {disc.name, disc.material, calibrateDiscs({mesh}, tests, start), {}};
  result.fit.material = rounded(result.fit.material);
  result.outside = outsideOf(disc, mesh, tests, result.fit.material);
  return result;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

// The table with the fitted constants replaced and everything else as it was.
std::string rewritten(const std::string& path, const std::vector<DiscFit>& fits) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot read this table");
  std::map<std::string, DiscMaterial> materials;
  for (const DiscFit& fit : fits) materials[fit.disc] = fit.fit.material;
  std::string text;
  std::vector<std::string> header;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') {
      text += line + '\n';
      continue;
    }
    std::vector<std::string> cells = split(line);
    if (header.empty()) {
      header = cells;
    } else {
      for (std::size_t i = 0; i < cells.size() && i < header.size(); i++) {
        for (const FittedConstant& constant : fittedConstants()) {
          if (header[i] == constant.name && materials.count(cells[0])) {
            cells[i] = tableText(constant, materials.at(cells[0]));
          }
        }
      }
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

Json describe(const std::vector<DiscFit>& fits, const std::string& path) {
  Json discs = Json::array();
  for (const DiscFit& fit : fits) {
    Json before, after;
    for (const FittedConstant& constant : fittedConstants()) {
      before[constant.name] = tableValue(constant, fit.before);
      after[constant.name] = tableValue(constant, fit.fit.material);
    }
    discs.push_back({{"disc", fit.disc},
                     {"before", before},
                     {"fitted", after},
                     {"cost", fit.fit.cost},
                     {"iterations", fit.fit.iterations},
                     {"outside", fit.outside}});
  }
  return {{"table", path}, {"discs", discs}};
}

void print(const Json& result) {
  fmt::print("{:<8}", "disc");
  for (const FittedConstant& constant : fittedConstants()) fmt::print("{:>24}", constant.name);
  fmt::print("{:>8}  outside of the published range\n", "cost");
  for (const Json& disc : result["discs"]) {
    fmt::print("{:<8}", disc["disc"].get<std::string>());
    for (const auto& [name, value] : disc["fitted"].items()) {
      fmt::print("{:>24.4g}", value.get<double>());
    }
    fmt::print("{:>8.2g}  {}\n", disc["cost"].get<double>(),
               fmt::join(disc["outside"].get<std::vector<std::string>>(), ", "));
  }
  fmt::print("written: {}\n", result["table"].get<std::string>());
}

void calibrate(const Options& options) {
  const std::string tables = anatomyFolder();
  const Anatomy anatomy = Anatomy::load(tables);
  const std::string folder = options.folder.empty() ? tables : options.folder;
  makeFolder(folder);
  const Skeleton skeleton = readSkeleton(anatomy, mjcfFolder() + "/assets", spineBodies(anatomy));
  const int threads = static_cast<int>(std::thread::hardware_concurrency());
  std::vector<Disc> discs;
  for (const std::string& level : options.levels) {
    for (const Disc& disc : chooseDiscs(anatomy, level)) discs.push_back(disc);
  }
  if (options.levels.empty()) discs = anatomy.discs;
  std::vector<DiscFit> fits(discs.size());
  {
    const ProgressBar bar;
    std::mutex mutex;
    int done = 0;
    forEach(static_cast<int>(fits.size()), threads, [&](int i) {
      fits[i] = fitDisc(anatomy, skeleton, discs[i]);
      const std::lock_guard<std::mutex> lock(mutex);
      bar.show(++done / static_cast<double>(fits.size()));
    });
  }
  const std::string path = folder + "/" + kTable;
  writeFile(path, rewritten(tables + "/" + kTable, fits));
  const Json result = describe(fits, path);
  if (options.json) {
    std::cout << result.dump(2) << '\n';
  } else {
    print(result);
  }
}

}  // namespace

void addCalibrateDiscs(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "calibrate-discs", "Fits the discs' material to published tests; rewrites its table.");
  command->footer(
      "Least squares, disc by disc, of the moduli of annulus, fibres and nucleus, the annulus'\n"
      "Poisson's ratio and the fibres' stiffening against the rows marked fit in disc_tests.csv, "
      "in\n"
      "units of the published ranges; what the tests leave open stays at typical published "
      "values.\n"
      "Discs lie between the bones of the models in mjcf: after a change of bones, build those "
      "first.\n"
      "The answer does not depend on the present table. It takes some minutes; models see the new\n"
      "table after `torso build`.\n\n"
      "Examples:\n"
      "  torso calibrate-discs\n"
      "  torso calibrate-discs --level L4/L5 L5/S1\n"
      "  torso calibrate-discs --out out --json");
  command->add_option("--out", options->folder,
                      "Write disc_materials.csv into this folder; by default the anatomy's own");
  command->add_option("--level", options->levels, "Only these discs, e.g. L4/L5; by default all");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { calibrate(*options); });
}

}  // namespace torso::tools
