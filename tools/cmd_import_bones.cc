// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <thread>

#include "model/vertebra_landmarks.h"
#include "tools/bone_import.h"
#include "tools/build_models.h"
#include "tools/commands.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"

namespace torso::tools {

void addImportBones(CLI::App& app) {
  struct Command {
    ImportOptions import;
    std::string output, anatomy;
  };
  auto options = std::make_shared<Command>();
  CLI::App* command =
      app.add_subcommand("import-bones", "Write the models with a person's own bones.");
  command->footer(fmt::format(
      "DIR holds meshes (OBJ, STL, PLY, glTF, ...; VTP of OpenSim), one bone each or several in\n"
      "objects of their own, with names as L3, lumbar1, T6, cerv3, sacrum, l_pelvis, ribcage,\n"
      "r_scapula, skull. What is guessed is said on stderr. Bones that are not there are "
      "generated,\n"
      "in proportion to their neighbours. Writes what `torso build` does.\n\n"
      "--map: JSON, file (or file/object) to body; a list names the parts of one object, "
      "vertebrae\n"
      "from below; \"\" leaves a file out:\n"
      "  {{\"scan1.stl\": \"L3\", \"spine.obj\": [\"L5\", \"L4\"], \"skin.obj\": \"\"}}\n"
      "--landmarks: JSON or CSV, in the unit and axes of the files, over what is found:\n"
      "  {{\"L3\": {{\"spinous_tip\": [x, y, z], \"upper_endplate\": {{\"centre\": [x, y, z],\n"
      "    \"normal\": [x, y, z], \"width\": 45, \"height\": 34}}}}}}\n"
      "  level,landmark,x,y,z,normal_x,normal_y,normal_z,width,height\n"
      "width is from side to side; height of an endplate from front to back, of a face along it.\n"
      "Landmarks: {}.\n\n"
      "Examples:\n"
      "  torso import-bones scans -o patient\n"
      "  torso import-bones scans --unit mm --axes LPS --stature 1.82 --mass 80 -o patient",
      fmt::join(landmarkNames(), ", ")));
  command->add_option("DIR", options->import.folder, "Folder of the meshes")->required();
  command->add_option("-o,--output", options->output, "Folder to write into")->required();
  command->add_option("--map", options->import.map, "Which file is which bone");
  command->add_option("--landmarks", options->import.landmarks, "Landmarks of vertebrae");
  command->add_option("--unit", options->import.unit, "mm, cm or m (default: guessed)");
  command->add_option("--axes", options->import.axes,
                      "Where x, y, z point: A P front back, L R, S I up down (default: guessed)");
  command->add_option("--stature", options->import.stature, "Of the person [m]");
  command->add_option("--mass", options->import.mass, "Of the person [kg]");
  command->add_option("--anatomy", options->anatomy, "Folder of the anatomy tables");
  command->callback([options] {
    if (options->anatomy.empty()) options->anatomy = anatomyFolder();
    checkFolder(options->output);
    const ImportedTorso torso = importBones(Anatomy::load(options->anatomy), options->import);
    for (const std::string& remark : torso.remarks) fmt::print(stderr, "{}\n", remark);
    std::map<std::string, std::string> files;
    {
      const ProgressBar bar;
      files = buildModels(
          torso.anatomy, static_cast<int>(std::thread::hardware_concurrency()),
          [&](double share) { bar.show(share); }, &torso.own);
    }
    std::map<std::string, std::string> by_path;
    for (auto& [name, content] : files) by_path[options->output + "/" + name] = content;
    writeFiles(by_path);
    fmt::print(
        "{}: torso.xml, human.xml, human_fixed.xml, human_simple.xml, scene.xml, "
        "torso_held.xml, assets/\n",
        options->output);
    fmt::print("own bones: {}\n", fmt::join(torso.imported, " "));
    fmt::print("body of {:.2f} m and {:.1f} kg\n", torso.anatomy.stature(), torso.anatomy.mass());
  });
}

}  // namespace torso::tools
