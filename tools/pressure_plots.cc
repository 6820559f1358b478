// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/pressure_plots.h"

#include <fmt/format.h>

#include "tools/files.h"
#include "tools/renderer.h"

namespace torso::tools {

void writePressurePlot(const std::string& folder, const std::string& disc,
                       const std::vector<ActivityLoads>& all) {
  makeFolder(folder);
  std::string table = "activity,measured_mpa,servos_mpa,muscles_mpa,muscles_our_disc_mpa\n";
  bool muscles = false, smaller = false;  // than the measured man's disc
  for (const ActivityLoads& loads : all) {
    const auto mpa = [](double pascal) { return fmt::format("{:.4f}", pascal / 1e6); };
    table += fmt::format("{},{},{}", loads.activity.title, mpa(loads.activity.pressure),
                         mpa(loads.servos.at(disc).pressureOnSubjectsArea()));
    if (!loads.muscles.discs.empty()) {
      muscles = true;
      const DiscLoad& with = loads.muscles.at(disc);
      table += "," + mpa(with.pressureOnSubjectsArea()) + "," + mpa(with.nucleus_pressure);
      smaller = with.area < 0.99 * kSubjectsArea;
    } else {
      table += ",,";
    }
    table += "\n";
  }
  writeFile(folder + "/pressure.csv", table);
  std::string script = fmt::format(
      "# Draws the table beside it: gnuplot pressure.gp\n"
      "set terminal pngcairo size 1300,750 font 'sans,12'\nset output 'pressure.png'\n"
      "set datafile separator ','\nset title 'Pressure in the nucleus of {}; in vivo: Wilke et al. "
      "1999, 2001, one man; ours: on a disc of his area'\n"
      "set style data histogram\nset style histogram clustered gap 1\nset style fill solid 0.9 "
      "noborder\nset boxwidth 0.9\n"
      "set ylabel 'pressure [MPa]'\nset yrange [0:*]\nset grid ytics lc rgb 'gray60'\n"
      "set xtics rotate by -25\nset key left top\nset rmargin 16\n"
      "plot 'pressure.csv' skip 1 using 2:xtic(1) lc rgb '#c0392b' title 'in vivo', \\\n"
      "  '' skip 1 using 3 lc rgb '#a9c4e4' title 'ours, servos only'",
      disc);
  if (muscles) {
    script += ", \\\n  '' skip 1 using 4 lc rgb '#1b3a6b' title 'ours, muscles'";
  }
  if (smaller) {
    script +=
        ", \\\n  '' skip 1 using 5 lc rgb '#d9e3f0' title 'ours, muscles, on our smaller disc'";
  }
  writeFile(folder + "/pressure.gp", script + "\n");
}

void writePosture(const std::string& path, PosedBody& body) {
  constexpr int kWidth = 700, kHeight = 900;
  mjvOption option;
  mjv_defaultOption(&option);
  setVisible(option, "ligaments", false);
  const mjvCamera camera = frameBodies(body.model(), {body.data()}, option, 115, -6,
                                       static_cast<double>(kWidth) / kHeight);
  Renderer renderer(body.model(), kWidth, kHeight);
  writeFile(path, renderer.png(body.data(), option, camera));
}

}  // namespace torso::tools
