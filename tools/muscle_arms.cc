// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/muscle_arms.h"

#include <map>
#include <set>

#include "model/csv.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"

namespace torso::tools {

std::vector<MuscleArm> measureArms(const Anatomy& anatomy, const std::string& folder,
                                   const mjModel* m, const mjData* d,
                                   const MuscleMoments& moments) {
  static const std::set<std::string> kErectors = {"longissimus_thoracis", "iliocostalis_lumborum",
                                                  "spinalis_thoracis", "multifidus",
                                                  "multifidus_thoracis"};
  std::map<std::string, std::string> groups;  // by actuator on the left
  for (const Muscle& muscle : anatomy.muscles) {
    groups[muscle.name + "_left"] = kErectors.count(muscle.group) ? "erector_spinae" : muscle.group;
  }
  const Eigen::MatrixXd arms = moments.arms(d);
  const Eigen::VectorXd sections = moments.sections();
  const CsvTable table(folder + "/muscle_arms.csv");
  std::vector<MuscleArm> result;
  for (int row = 0; row < table.rows(); row++) {
    const auto mm = [&](const char* column) { return 1e-3 * table.number(row, column); };
    MuscleArm arm{table.text(row, "muscle"),
                  table.text(row, "disc"),
                  0,
                  0,
                  mm("behind_low_mm"),
                  mm("behind_high_mm"),
                  mm("beside_low_mm"),
                  mm("beside_high_mm")};
    double sum = 0;
    for (std::size_t c = 0; c < moments.cuts().size(); c++) {
      if (moments.cuts()[c].disc != arm.disc) continue;
      for (std::size_t i = 0; i < moments.muscles().size(); i++) {
        const auto group = groups.find(nameOf(m, mjOBJ_ACTUATOR, moments.muscles()[i]));
        const Eigen::Vector3d moment = arms.block<3, 1>(3 * c, i);
        if (group == groups.end() || group->second != arm.muscle || moment.isZero(0)) continue;
        // A pull at the left bends to the left, about -x; one behind extends, about -y.
        arm.behind -= sections[i] * moment.y();
        arm.beside -= sections[i] * moment.x();
        sum += sections[i];
      }
    }
    if (sum == 0) throw Error(arm.muscle + " does not pass " + arm.disc);
    arm.behind /= sum;
    arm.beside /= sum;
    result.push_back(arm);
  }
  return result;
}

}  // namespace torso::tools
