// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Grafted humanoids and the torso in scenes: several torsos, files in other folders.

#include "model/tri_mesh.h"
#include "tests/tools/graft_fixture.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;

class GraftScene : public GraftFixture {
 protected:
  static void stepWithoutWarning(const mjModel* m, int steps) {
    const DataPtr d = makeData(m);
    for (int i = 0; i < steps; i++) mj_step(m, d.get());
    EXPECT_EQ(firstWarning(d.get()), "");
  }
};

// Two plain humanoids in one file, one after the other: a map says which is the first.
TEST_F(GraftScene, TwoTorsosInOneScene) {
  std::string text = plainHumanoid();
  const std::size_t begin = text.find("<body"), end = text.rfind("</worldbody>");
  std::string other = text.substr(begin, end - begin);
  for (std::size_t i = 0; (i = other.find("name=\"", i)) != std::string::npos; i += 8) {
    other.insert(i + 6, "z_");
  }
  other.replace(other.find("0 0 1.1"), 7, "0 2 1.1");
  GraftOptions o = options(write("in.xml", text.insert(end, other)), "one.xml");
  o.map = write("map.json", R"({"pelvis": "base"})");
  graft(anatomy(), o);
  o = options(at("one.xml"), "two.xml");
  o.prefix = "b_";
  graft(anatomy(), o);

  const ModelPtr one = loadModel(at("one.xml")), two = loadModel(at("two.xml"));
  torsoInfo info;
  ASSERT_EQ(torso_info(two.get(), &info, nullptr, 0), 1);
  EXPECT_EQ(info.ntorso, 2);
  EXPECT_EQ(info.ndisc, 46);
  EXPECT_EQ(two->nuserdata, 2 * one->nuserdata);
  // Each has its own place in userdata: what one does does not change what the other does.
  stepWithoutWarning(two.get(), 100);
  const DataPtr alone = makeData(one.get()), both = makeData(two.get());
  for (int i = 0; i < 60; i++) {
    mj_step(one.get(), alone.get());
    mj_step(two.get(), both.get());
  }
  const int a = idOf(one.get(), mjOBJ_BODY, "T6"), b = idOf(two.get(), mjOBJ_BODY, "T6");
  for (int k = 0; k < 3; k++) {
    EXPECT_NEAR(both->xpos[3 * b + k], alone->xpos[3 * a + k], 1e-4);
  }
  const int c = idOf(two.get(), mjOBJ_BODY, "b_T6");
  EXPECT_NEAR(both->xpos[3 * c + 2], both->xpos[3 * b + 2], 1e-4);
  EXPECT_NEAR(both->xpos[3 * c + 1], both->xpos[3 * b + 1] + 2, 1e-4);
}

// Humanoid, its parts, its meshes and textures in folders of their own, the output in another one.
TEST_F(GraftScene, FilesAreFoundFromTheOutputsFolder) {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {.02, 0, 0}, {0, .02, 0}, {0, 0, .02}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  write("a/shapes/badge.stl", toStl(mesh));
  const int size[2] = {1, 1};
  write("a/paint/red.bin",
        std::string(reinterpret_cast<const char*>(size), sizeof size) + std::string("\xff\0\0", 3));
  write("a/model/parts/paint.xml",
        "<mujocoinclude><asset><texture name='red' type='2d' file='red.bin'/>"
        "<material name='red' texture='red'/></asset></mujocoinclude>");
  std::string text = waistDownHumanoid();
  const auto insert = [&](const std::string& before, const std::string& what) {
    text.insert(text.find(before), what);
  };
  insert("<option",
         "<compiler meshdir='../shapes' texturedir='../paint/'/>"
         "<include file='parts/paint.xml'/>");
  insert("<material", "<mesh name='badge' file='badge.stl'/>");
  insert("<geom name=\"left_shin\"", "<geom type='mesh' mesh='badge' material='red'/>");
  write("a/model/in.xml", text);
  fs::create_directories(folder_ / "b/c");
  fs::create_directory_symlink(folder_ / "b/c", folder_ / "link");
  for (const char* output : {"a/model/out.xml", "b/c/out.xml", "a/out.xml", "link/out2.xml"}) {
    graftTo(at("a/model/in.xml"), output);
    const ModelPtr m = loadModel(at(output));
    EXPECT_GE(mj_name2id(m.get(), mjOBJ_MESH, "badge"), 0);
    EXPECT_GE(mj_name2id(m.get(), mjOBJ_MESH, "ribcage"), 0);
    EXPECT_EQ(m->ntex, 1);
  }
  // The whole tree elsewhere: the paths are relative.
  fs::create_directory(folder_ / "moved");
  fs::copy(folder_ / "a", folder_ / "moved/a", fs::copy_options::recursive);
  fs::remove_all(folder_ / "a");
  loadModel(at("moved/a/out.xml"));
  fs::rename(folder_ / "moved/a", folder_ / "a");
  // Without folders in file names.
  insert("<option", "<compiler strippath='true'/>");
  text.replace(text.find("file='badge.stl'"), 16, "file='x/y/badge.stl'");
  write("a/model/in.xml", text);
  graftTo(at("a/model/in.xml"), "b/c/out.xml");
  loadModel(at("b/c/out.xml"));
}

// As README says for a scene in any folder.
TEST_F(GraftScene, TorsoIsIncludedFromAnotherFolder) {
  const std::string mjcf = fs::relative(mjcfFolder(), fs::canonical(folder_)).string();
  write("scene.xml", "<mujoco><compiler meshdir='" + mjcf + "'/><include file='" + mjcf +
                         "/torso.xml'/><worldbody><geom name='floor' type='plane' size='1 1 1'/>"
                         "</worldbody></mujoco>");
  const ModelPtr m = loadModel(at("scene.xml"));
  EXPECT_EQ(torso_info(m.get(), nullptr, nullptr, 0), 1);
  stepWithoutWarning(m.get(), 10);
}

// README's list of names that users may rely on, in a grafted humanoid with a prefix.
TEST_F(GraftScene, NamesToRelyOn) {
  GraftOptions o = options(write("in.xml", plainHumanoid()));
  o.prefix = "p_";
  graft(anatomy(), o);
  const ModelPtr m = loadModel(at("out.xml"));
  for (const char* body : {"pelvis", "L5", "T12", "T1", "C7", "C3", "ribcage", "head",
                           "left_clavicle", "right_scapula"}) {
    idOf(m.get(), mjOBJ_BODY, std::string("p_") + body);
  }
  for (const char* joint :
       {"pelvis", "L5", "ribcage", "head", "left_sternoclavicular", "right_acromioclavicular"}) {
    idOf(m.get(), mjOBJ_JOINT, std::string("p_") + joint);
  }
  for (const char* servo : {"L5/S1_flexion", "T7/T8_lateral_bending", "C3/C4_axial_rotation",
                            "head_flexion", "left_sternoclavicular_elevation"}) {
    idOf(m.get(), mjOBJ_ACTUATOR, std::string("p_") + servo);
  }
  for (const char* sensor :
       {"L4/L5_force", "L4/L5_moment", "L4/L5_pressure", "L4/L5_nucleus_pressure",
        "L4/L5_ligament_tension", "L4/L5_facet_force"}) {
    idOf(m.get(), mjOBJ_SENSOR, std::string("p_") + sensor);
  }
  idOf(m.get(), mjOBJ_TENDON, "p_ALL_mid_L4/L5");
  for (const char* camera : {"front", "side", "back"}) {
    idOf(m.get(), mjOBJ_CAMERA, std::string("p_") + camera);
  }
}

}  // namespace
}  // namespace torso::tools
