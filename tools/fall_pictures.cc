// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/fall_pictures.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/files.h"
#include "tools/gnuplot.h"
#include "tools/renderer.h"

namespace torso::tools {
namespace {

constexpr int kWidth = 230, kHeight = 400;  // of one picture [pixels]
constexpr double kAzimuth = 120, kElevation = -6;

}  // namespace

std::string fallStrip(std::vector<FallenModel>& models, const std::vector<double>& times) {
  mjvOption option;
  mjv_defaultOption(&option);
  setVisible(option, "ligaments", false);
  const int columns = static_cast<int>(times.size());
  std::vector<unsigned char> rgb(3 * static_cast<std::size_t>(kWidth) * columns * kHeight *
                                 models.size());
  for (std::size_t row = 0; row < models.size(); row++) {
    FallenModel& model = models[row];
    Renderer renderer(model.m.get(), kWidth, kHeight);
    int column = 0;
    for (const DataPtr& d : model.falls[0].frames) {
      const mjvCamera camera = frameBodies(model.m.get(), {d.get()}, option, kAzimuth, kElevation,
                                           static_cast<double>(kWidth) / kHeight);
      const std::vector<unsigned char> cell = renderer.pixels(d.get(), option, camera);
      // Rows of pixels count from below.
      const std::size_t first = (models.size() - 1 - row) * kHeight;
      for (int y = 0; y < kHeight; y++) {
        std::copy_n(cell.begin() + 3 * y * kWidth, 3 * kWidth,
                    rgb.begin() + 3 * ((first + y) * columns * kWidth + column * kWidth));
      }
      column++;
    }
  }
  return encodePng(rgb, kWidth * columns, kHeight * static_cast<int>(models.size()));
}

void writeFallPlot(const std::string& folder, const std::vector<FallenModel>& models,
                   double limit) {
  makeFolder(folder);
  std::string table = "time_after_touch_s";
  for (const FallenModel& model : models) {
    table += fmt::format(",{0}_floor_force_bw,{0}_head_g", model.name);
  }
  table += '\n';
  const Fall& first = models[0].falls[0];
  for (std::size_t i = 0; i < first.head_acceleration.size(); i++) {
    table += fmt::format("{:.5f}", static_cast<double>(i) * first.interval - first.touch);
    for (const FallenModel& model : models) {
      const Fall& fall = model.falls[0];
      table += fmt::format(",{:.4g},{:.4g}", fall.floor_force[i].norm() / fall.weight,
                           fall.head_acceleration[i]);
    }
    table += '\n';
  }
  writeFile(folder + "/fall.csv", table);
  const char* colours[] = {"#1b3a6b", "#6f9bd1", "#8a8a8a"};
  std::string script =
      "# Draws the table beside it: gnuplot fall.gp\n"
      "set terminal pngcairo size 1300,900 font 'sans,12'\nset output 'fall.png'\n"
      "set datafile separator ','\nset multiplot layout 2,2\nset grid lc rgb 'gray75'\n"
      "set key top right\n";
  for (const auto& [column, label] :
       {std::pair{2, "force of the floor [body weights]"}, {3, "acceleration of the head [g]"}}) {
    for (const auto& [range, title] :
         {std::pair{"[-0.01:0.1]", "landing"}, {"[-0.1:1.8]", "all the fall"}}) {
      script += fmt::format(
          "set yrange [0:{}]\nset title '{}'\nset xlabel 'time after the first touch [s]'\nset "
          "ylabel '{}'\n"
          "set xrange {}\nplot ",
          column == 2 ? "*" : fmt::format("{}<*", 1.15 * limit), title, label, range);
      for (std::size_t k = 0; k < models.size(); k++) {
        script += fmt::format(
            "'fall.csv' skip 1 using 1:{} with lines lw 1.6 lc rgb '{}' title "
            "'{} torso', ",
            column + 2 * k, colours[k], models[k].name);
      }
      script += column == 3 ? fmt::format(
                                  "{} with lines dt 2 lc rgb '#c0392b' title '{:g} g, limit "
                                  "for 3 ms of UN R94'\n",
                                  limit, limit)
                            : "0 notitle\n";
    }
  }
  writeFile(folder + "/fall.gp", script + "unset multiplot\n");
  runGnuplot("fall", folder, "fall.gp");
}

}  // namespace torso::tools
