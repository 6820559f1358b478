// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/disc_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/files.h"

namespace torso::tools {
namespace {

using Quantity = DiscTest::Quantity;

std::vector<const DiscReport*> ofRegion(const std::vector<DiscReport>& reports, Region region) {
  std::vector<const DiscReport*> chosen;
  for (const DiscReport& report : reports) {
    if (report.disc.region == region) chosen.push_back(&report);
  }
  return chosen;
}

// What a curve of the quantity shows over the load: pressure in the nucleus, or displacement.
const std::vector<double>& ordinate(const DiscCurve& curve, bool pressure) {
  return pressure ? curve.nucleus_pressure : curve.displacement;
}

// Column names without the slash of "L4/L5", as file names and gnuplot like them.
std::string curveTable(const std::vector<const DiscReport*>& reports, int loading, bool pressure) {
  const DiscUnits units = discUnits(reports[0]->loadings[loading].quantity);
  std::string text = fmt::format("load_{}", units.load);
  std::size_t points = 0;
  const std::vector<double>* loads = nullptr;
  for (const DiscReport* report : reports) {
    text += fmt::format(",{}_{}", report->disc.name, pressure ? "MPa" : units.displacement);
    const DiscCurve& curve = report->loadings[loading].curve;
    if (curve.load.size() > points) loads = &curve.load;
    points = std::max(points, curve.load.size());
  }
  for (std::size_t i = 0; i < points; i++) {
    text += fmt::format("\n{:.5g}", (*loads)[i]);
    for (const DiscReport* report : reports) {
      const auto& y = ordinate(report->loadings[loading].curve, pressure);
      text += i < y.size() ? fmt::format(",{:.5g}", y[i] / (pressure ? 1e6 : units.displacement_si))
                           : ",";
    }
  }
  return text + '\n';
}

// Published tests as "x,low,high,y" of the panel: stiffness and load give a displacement; without
// bounds the point has no bar. A row without load has no place in a panel.
std::string publishedPoints(const Anatomy& anatomy, Region region, Quantity quantity,
                            double preload, double top_load, bool fit) {
  std::string text;
  for (const DiscTest& test : anatomy.disc_tests) {
    if (test.region != region || test.whole_segment || test.quantity != quantity ||
        test.fit != fit || test.load == 0 || test.load > 1.001 * top_load ||
        test.preload != preload) {
      continue;
    }
    const DiscUnits units = discUnits(quantity);
    if (quantity == Quantity::kPressure) {
      const double low = std::isfinite(test.low) ? test.low : test.value;
      const double high = std::isfinite(test.high) ? test.high : test.value;
      text += fmt::format("{:.5g},{:.5g},{:.5g},{:.5g}\n", test.load, test.value / 1e6, low / 1e6,
                          high / 1e6);
      continue;
    }
    const auto displacement = [&](double stiffness) {
      return test.load / stiffness / units.displacement_si;
    };
    const double low = std::isfinite(test.low) ? test.low : test.value;
    const double high = std::isfinite(test.high) ? test.high : test.value;
    text += fmt::format("{:.5g},{:.5g},{:.5g},{:.5g}\n", displacement(test.value),
                        displacement(high), displacement(low), test.load);
  }
  return text;
}

// One panel: the discs' curves, the range to fit as a thick bar, other publications as dots.
std::string panel(const Anatomy& anatomy, const std::vector<const DiscReport*>& reports,
                  int loading, bool pressure) {
  const DiscLoading& first = reports[0]->loadings[loading];
  const Region region = reports[0]->disc.region;
  const Quantity quantity = pressure ? Quantity::kPressure : first.quantity;
  const DiscUnits units = discUnits(first.quantity);
  const std::string file = fmt::format("{}_{}.csv", regionName(region), discQuantityName(quantity));
  double top = 0;
  for (const DiscReport* report : reports) {
    top = std::max(top, report->loadings[loading].curve.load.back());
  }
  std::string title = discQuantityName(quantity);
  std::replace(title.begin(), title.end(), '_', ' ');
  if (first.preload > 0) title += fmt::format(", {:g} N preload", first.preload);
  std::string text = fmt::format("set title '{}'\n", title);
  text += fmt::format("set xlabel '{}'\nset ylabel '{}'\n",
                      pressure ? "load [N]" : fmt::format("displacement [{}]", units.displacement),
                      pressure ? "nucleus pressure [MPa]" : fmt::format("load [{}]", units.load));
  std::string plots;
  for (std::size_t i = 0; i < reports.size(); i++) {
    plots += fmt::format(
        "{}'{}' skip 1 using {} with lines lw 2 lc palette frac {:.3f} title '{}'",
        plots.empty() ? "" : ", \\\n  ", file,
        pressure ? fmt::format("1:{}", i + 2) : fmt::format("{}:1", i + 2),
        reports.size() > 1 ? static_cast<double>(i) / static_cast<double>(reports.size() - 1) : 0.0,
        reports[i]->disc.name);
  }
  for (const bool fit : {true, false}) {
    const std::string points = publishedPoints(anatomy, region, quantity, first.preload, top, fit);
    if (points.empty()) continue;
    const std::string block = fmt::format("${}_{}_{}", regionName(region),
                                          discQuantityName(quantity), fit ? "range" : "other");
    text += fmt::format("{} << EOD\n{}EOD\n", block, points);
    plots += fmt::format(", \\\n  {} using {} with {} lc rgb '{}' lw {} pt 7 ps {} title '{}'",
                         block, pressure ? "1:2:3:4" : "1:4:2:3",
                         pressure ? "yerrorbars" : "xerrorbars", fit ? "black" : "gray50",
                         fit ? 3 : 1.5, fit ? 1.4 : 1.0, fit ? "range to fit" : "other tests");
  }
  return text + "plot " + plots + "\n";
}

std::string figure(const Anatomy& anatomy, const std::vector<const DiscReport*>& reports) {
  std::string text = fmt::format(
      "\nset output '{0}.png'\nset multiplot layout 2,5 title '{0} discs: lines, ours from below "
      "(dark) to above (light); black, published range to fit; grey, other publications'\n",
      regionName(reports[0]->disc.region));
  for (int i = 0; i < static_cast<int>(reports[0]->loadings.size()); i++) {
    text += panel(anatomy, reports, i, false);
  }
  for (int i = 0; i < static_cast<int>(reports[0]->loadings.size()); i++) {
    if (reports[0]->loadings[i].quantity == Quantity::kCompression) {
      text += panel(anatomy, reports, i, true);
    }
  }
  return text + "unset multiplot\n";
}

}  // namespace

void writeDiscPlots(const std::string& folder, const Anatomy& anatomy,
                    const std::vector<DiscReport>& reports) {
  makeFolder(folder);
  std::string script =
      "# Draws the tables beside it: gnuplot discs.gp\n"
      "set terminal pngcairo size 2200,1000 font 'sans,12'\n"
      "set datafile separator ','\nset palette defined (0 '#1b3a6b', 0.5 '#2a9d8f', 1 '#e9c46a')\n"
      "unset colorbox\nset key right bottom font ',9'\n"
      "set offsets 0,0,graph 0.05,0\nset grid lc rgb 'gray60'\nset xrange [0:*]\nset yrange "
      "[0:*]\n";
  for (Region region : kRegions) {
    const auto chosen = ofRegion(reports, region);
    if (chosen.empty()) continue;
    for (int i = 0; i < static_cast<int>(chosen[0]->loadings.size()); i++) {
      const Quantity quantity = chosen[0]->loadings[i].quantity;
      const std::string stem = folder + "/" + regionName(region) + "_";
      writeFile(stem + discQuantityName(quantity) + ".csv", curveTable(chosen, i, false));
      if (quantity == Quantity::kCompression) {
        writeFile(stem + "pressure.csv", curveTable(chosen, i, true));
      }
    }
    script += figure(anatomy, chosen);
  }
  writeFile(folder + "/discs.gp", script);
}

}  // namespace torso::tools
