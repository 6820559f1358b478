// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// `torso import-bones` on the project's own bones, whose place and parts are known.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/bone_mesh.h"
#include "model/tri_mesh.h"
#include "tests/tools/command_fixture.h"
#include "tools/bone_import.h"
#include "tools/bone_names.h"
#include "tools/bone_pieces.h"
#include "tools/mesh_file.h"

namespace torso::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

const Anatomy& anatomy() {
  static const Anatomy a = Anatomy::load(TORSO_ANATOMY_DIR);
  return a;
}

const TriMesh& bone(const std::string& body) {
  static std::map<std::string, TriMesh> made;
  auto it = made.find(body);
  if (it == made.end()) it = made.emplace(body, boneMesh(anatomy(), body)[0].mesh).first;
  return it->second;
}

// As a file with these units and axes holds it.
TriMesh exported(TriMesh mesh, double per_metre, const std::string& axes) {
  const Matrix3d M = axesMatrix(axes).transpose();
  for (Vector3d& v : mesh.vertices) v = per_metre * (M * v);
  return mesh;
}

std::string toObj(const TriMesh& mesh) {
  std::string text = "# a comment\n";
  for (const Vector3d& v : mesh.vertices) {
    text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  }
  for (const auto& f : mesh.faces) {
    text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  }
  return text;
}

std::string toPly(const TriMesh& mesh) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.faces.size());
  for (const Vector3d& v : mesh.vertices) {
    text += fmt::format("{:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  }
  for (const auto& f : mesh.faces) text += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
  return text;
}

std::string toVtp(const TriMesh& mesh) {
  std::string points, corners, offsets;
  for (const Vector3d& v : mesh.vertices) {
    points += fmt::format("{:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
  }
  int offset = 0;
  for (const auto& f : mesh.faces) {
    corners += fmt::format("{} {} {} ", f[0], f[1], f[2]);
    offsets += fmt::format("{} ", offset += 3);
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfPolys=\"{}\">\n<Points>\n"
      "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n{}</DataArray>\n"
      "</Points>\n<Polys>\n<DataArray Name=\"connectivity\" format=\"ascii\">{}</DataArray>\n"
      "<DataArray Name=\"offsets\" format=\"ascii\">{}</DataArray>\n</Polys>\n</Piece>\n"
      "</PolyData>\n</VTKFile>\n",
      mesh.vertices.size(), mesh.faces.size(), points, corners, offsets);
}

// glTF with its data in a file beside it.
std::pair<std::string, std::string> toGltf(const TriMesh& mesh, const std::string& bin_name) {
  std::string bin;
  Eigen::Vector3f low = mesh.vertices[0].cast<float>(), high = low;
  for (const Vector3d& v : mesh.vertices) {
    const Eigen::Vector3f p = v.cast<float>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    bin.append(reinterpret_cast<const char*>(p.data()), 12);
  }
  const std::size_t split = bin.size();
  for (const auto& f : mesh.faces) {
    for (int i : f) {
      const auto index = static_cast<std::uint32_t>(i);
      bin.append(reinterpret_cast<const char*>(&index), 4);
    }
  }
  const std::string text = fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
"nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}},
"indices": 1}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": {}, "type": "VEC3",
"min": [{}, {}, {}], "max": [{}, {}, {}]}},
{{"bufferView": 1, "componentType": 5125, "count": {}, "type": "SCALAR"}}],
"bufferViews": [{{"buffer": 0, "byteOffset": 0, "byteLength": {}}},
{{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
"buffers": [{{"uri": "{}", "byteLength": {}}}]}})",
      mesh.vertices.size(), low.x(), low.y(), low.z(), high.x(), high.y(), high.z(),
      3 * mesh.faces.size(), split, split, bin.size() - split, bin_name, bin.size());
  return {text, bin};
}

class ImportBones : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    std::filesystem::create_directory(folder_ / "in");
  }

  // STL unless the name says otherwise.
  void put(const std::string& name, const TriMesh& mesh) {
    const std::string ext = std::filesystem::path(name).extension();
    if (ext == ".gltf") {
      const std::string bin = std::filesystem::path(name).stem().string() + ".bin";
      const auto [text, data] = toGltf(mesh, bin);
      write("in/" + name, text);
      write("in/" + bin, data);
      return;
    }
    write("in/" + name, ext == ".obj"   ? toObj(mesh)
                        : ext == ".ply" ? toPly(mesh)
                        : ext == ".vtp" ? toVtp(mesh)
                                        : toStl(mesh));
  }

  ImportedTorso import(const std::string& unit = "", const std::string& axes = "") {
    ImportOptions options;
    options.folder = (folder_ / "in").string();
    options.unit = unit;
    options.axes = axes;
    return importBones(anatomy(), options);
  }

  // The command must fail with a message that holds these, and write nothing.
  void expectRefused(const std::string& arguments, const std::vector<std::string>& words) {
    const Result result = run("import-bones in -o out " + arguments);
    EXPECT_EQ(result.status, 1) << result.err;
    for (const std::string& word : words) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".tmp")));
    }
  }
};

TEST(BoneNames, AreWhatPeopleCallThem) {
  EXPECT_THAT(bodiesOfName("lumbar1"), ElementsAre("L1"));
  EXPECT_THAT(bodiesOfName("thoracic10_s"), ElementsAre("T10"));
  EXPECT_THAT(bodiesOfName("cerv3"), ElementsAre("C3"));
  EXPECT_THAT(bodiesOfName("patient7_L3_whole"), ElementsAre("L3"));
  EXPECT_THAT(bodiesOfName("vertebra_T06"), ElementsAre("T6"));
  EXPECT_THAT(bodiesOfName("Vertebra L4"), ElementsAre("L4"));
  EXPECT_THAT(bodiesOfName("ribcage_s"), ElementsAre("ribcage"));
  EXPECT_THAT(bodiesOfName("sacrum"), ElementsAre("pelvis"));
  EXPECT_THAT(bodiesOfName("l_pelvis"), ElementsAre("pelvis"));
  EXPECT_EQ(sideOfName("l_pelvis"), "left");
  EXPECT_THAT(bodiesOfName("r_scapula"), ElementsAre("right_scapula"));
  EXPECT_THAT(bodiesOfName("Clavicle-Left"), ElementsAre("left_clavicle"));
  EXPECT_THAT(bodiesOfName("scapula"), ElementsAre("scapula"));
  EXPECT_THAT(bodiesOfName("L_Shoulder"), ElementsAre("left_clavicle", "left_scapula"));
  EXPECT_THAT(bodiesOfName("hat_skull"), ElementsAre("head"));
  EXPECT_THAT(bodiesOfName("Spine"), ElementsAre("spine"));
  EXPECT_THAT(bodiesOfName("femur_r"), ElementsAre("right_thigh"));
  for (const char* none : {"L3_body", "L3_pedicle_left", "disc_L4_L5", "L6", "T13", "object12"}) {
    EXPECT_TRUE(bodiesOfName(none).empty()) << none;
  }
}

TEST(Axes, LettersSayWhereTheyPoint) {
  const Matrix3d M = axesMatrix("ASR");
  EXPECT_EQ(Vector3d(M * Vector3d(1, 2, 3)), Vector3d(1, -3, 2));
  EXPECT_EQ(axesLetters(M), "ASR");
  EXPECT_EQ(axesMatrix("als"), Matrix3d::Identity());
  EXPECT_ANY_THROW(axesMatrix("APS"));
  EXPECT_ANY_THROW(axesMatrix("AL"));
}

// Whatever the format, unit and axes: guessed, and the vertebrae stand again where they were.
TEST_F(ImportBones, ReadsAllFormatsUnitsAndAxes) {
  const struct {
    const char *extension, *unit, *axes;
    double per_metre;
  } cases[] = {{".stl", "mm", "LPS", 1000},
               {".obj", "cm", "ASR", 100},
               {".ply", "m", "SAL", 1},
               {".vtp", "mm", "RAS", 1000},
               {".gltf", "m", "PSL", 1}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.extension);
    std::filesystem::remove_all(folder_ / "in");
    std::filesystem::create_directory(folder_ / "in");
    for (const char* level : {"L3", "L4"}) {
      put(std::string(level) + c.extension, exported(bone(level), c.per_metre, c.axes));
    }
    const ImportedTorso torso = import();
    EXPECT_THAT(torso.remarks, testing::Contains(HasSubstr(fmt::format("unit: {} ", c.unit))));
    EXPECT_THAT(torso.remarks, testing::Contains(HasSubstr(fmt::format("axes: {} ", c.axes))));
    EXPECT_THAT(torso.imported, ElementsAre("L3", "L4"));
    for (const char* level : {"L3", "L4"}) {
      const TriMesh& mesh = torso.own.meshes.at(level);
      // STL repeats vertices, so corner by corner.
      ASSERT_EQ(mesh.faces.size(), bone(level).faces.size());
      double furthest = 0;
      for (std::size_t i = 0; i < mesh.faces.size(); i++) {
        for (int k = 0; k < 3; k++) {
          furthest = std::max(furthest, (mesh.vertices[mesh.faces[i][k]] -
                                         bone(level).vertices[bone(level).faces[i][k]])
                                            .norm());
        }
      }
      EXPECT_LT(furthest, 4e-3) << level;
      EXPECT_NEAR(torso.anatomy.vertebra(level).pitch, anatomy().vertebra(level).pitch, 0.035);
    }
    EXPECT_NEAR(torso.anatomy.stature(), anatomy().stature(), 0.03);
  }
}

TEST_F(ImportBones, SplitsASpineInOneObject) {
  TriMesh spine;
  for (const char* level : {"L3", "L1", "L5", "L2", "L4"}) append(spine, bone(level));
  put("spine.ply", exported(spine, 100, "ASR"));
  const ImportedTorso torso = import();
  EXPECT_THAT(torso.imported, ElementsAre("L1", "L2", "L3", "L4", "L5"));
  EXPECT_THAT(torso.remarks, testing::Contains(HasSubstr("five vertebrae")));
  for (const char* level : {"L1", "L5"}) {
    EXPECT_EQ(torso.own.meshes.at(level).faces.size(), bone(level).faces.size());
  }
}

TEST_F(ImportBones, TellsLeftFromRightAndMirrorsTheMissingOne) {
  put("L3.stl", bone("L3"));
  put("scapula.stl", bone("right_scapula"));
  const ImportedTorso torso = import("m", "ALS");
  EXPECT_THAT(torso.remarks, testing::Contains(HasSubstr("it is the right one")));
  EXPECT_THAT(torso.imported, ElementsAre("L3", "left_scapula", "right_scapula"));
  Vector3d left = Vector3d::Zero(), right = Vector3d::Zero(), truth = Vector3d::Zero();
  for (const auto& v : torso.own.meshes.at("left_scapula").vertices) left += v;
  for (const auto& v : torso.own.meshes.at("right_scapula").vertices) right += v;
  for (const auto& v : bone("right_scapula").vertices) truth += v;
  const double n = static_cast<double>(bone("right_scapula").vertices.size());
  EXPECT_LT((left - mirror(right)).norm() / n, 1e-9);
  EXPECT_LT((right - truth).norm() / n, 8e-3);
}

// In the unit and axes of the files; JSON and CSV alike.
TEST_F(ImportBones, TakesLandmarksFromAFile) {
  put("L3.stl", exported(bone("L3"), 1000, "LPS"));
  const double span = import().anatomy.vertebra("L3").transverse_process_span;
  const Vertebra& v = anatomy().vertebra("L3");
  const Vector3d tip = v.frame() * Vector3d(-0.03, v.transverse_process_span / 2 + 0.01, 0);
  const Vector3d p = 1000 * (axesMatrix("LPS").transpose() * tip);
  write("a.json",
        fmt::format(R"({{"L3": {{"left_transverse_tip": [{}, {}, {}]}}}})", p.x(), p.y(), p.z()));
  write("a.csv", fmt::format("level,landmark,x,y,z,normal_x,normal_y,normal_z,width,height\n"
                             "L3,left_transverse_tip,{},{},{},,,,,\n",
                             p.x(), p.y(), p.z()));
  for (const char* file : {"a.json", "a.csv"}) {
    for (const char* axes : {"", "LPS"}) {
      ImportOptions options;
      options.folder = (folder_ / "in").string();
      options.landmarks = (folder_ / file).string();
      options.axes = axes;
      const Anatomy a = importBones(anatomy(), options).anatomy;
      EXPECT_NEAR(a.vertebra("L3").transverse_process_span, span + 0.01, 1e-3) << file << axes;
    }
  }
}

// Once through the whole command: the models load and run.
TEST_F(ImportBones, WritesModelsThatSimulate) {
  for (const char* level : {"L2", "L3", "L4"}) {
    put(std::string(level) + ".vtp", exported(bone(level), 1, "ASR"));
  }
  const Result result = run("import-bones in -o out");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("unit: m (guessed"));
  EXPECT_THAT(result.err, HasSubstr("axes: ASR (guessed"));
  EXPECT_THAT(result.out, HasSubstr("own bones: L2 L3 L4"));
  for (const char* file : {"torso.xml", "human.xml", "human_fixed.xml", "human_simple.xml",
                           "scene.xml", "torso_held.xml", "assets/L3.stl", "assets/ribcage.stl"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / file)) << file;
  }
  EXPECT_EQ(run("run out/torso_held.xml --seconds 0.3").status, 0);
  const Result drop = run("run out/human.xml --drop 0.1 --seconds 0.3");
  EXPECT_EQ(drop.status, 0) << drop.err;
  EXPECT_THAT(drop.out, HasSubstr("0 failed, 0 warnings"));
}

TEST_F(ImportBones, RefusesOpenMeshes) {
  TriMesh mesh = bone("L3");
  mesh.faces.resize(mesh.faces.size() / 2);
  put("L3.stl", mesh);
  expectRefused("", {"in/L3.stl", "open", "close"});
}

TEST_F(ImportBones, RefusesBranchingSurfaces) {
  // Walls from every other face's edge to the middle of the body.
  TriMesh mesh = bone("L3");
  const int n = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(anatomy().vertebra("L3").position);
  for (std::size_t i = 0; i < mesh.faces.size(); i += 2) {
    mesh.faces.push_back({mesh.faces[i][0], mesh.faces[i][1], n});
  }
  put("L3.obj", mesh);
  expectRefused("", {"in/L3.obj", "not manifold", "inner walls"});
}

TEST_F(ImportBones, RefusesWrongUnits) {
  put("L3.stl", exported(bone("L3"), 1000, "ALS"));
  expectRefused("--unit m", {"in/L3.stl", "L3 would be", "--unit"});
  expectRefused("--unit inch", {"--unit inch", "mm, cm or m"});
  put("L3.stl", exported(bone("L3"), 22, "ALS"));  // 2 m long
  expectRefused("", {"in/L3.stl", "times the tables'", "--unit"});
}

TEST_F(ImportBones, RefusesMirroredMeshes) {
  TriMesh mesh = bone("L3");
  for (Vector3d& v : mesh.vertices) v.x() = -v.x();
  put("L3.stl", mesh);
  expectRefused("", {"in/L3.stl", "inside out", "mirror"});
  std::filesystem::remove(folder_ / "in" / "L3.stl");
  put("left_scapula.stl", bone("right_scapula"));
  expectRefused("--unit m --axes ALS", {"in/left_scapula.stl", "mirrored", "wrong side"});
}

TEST_F(ImportBones, RefusesDamagedFiles) {
  const std::string stl = toStl(bone("L3"));
  write("in/L3.stl", stl.substr(0, stl.size() / 2));
  expectRefused("", {"in/L3.stl", "cut short"});
  write("in/L3.stl", "solid nothing\n");
  expectRefused("", {"in/L3.stl"});
  std::filesystem::remove(folder_ / "in" / "L3.stl");

  const std::string vtp = toVtp(bone("L3"));
  write("in/L3.vtp", vtp.substr(0, vtp.size() / 2));
  expectRefused("", {"in/L3.vtp", "line"});
  std::string few = vtp;
  few.replace(few.find("NumberOfPoints=\"") + 16, 1, "9");
  write("in/L3.vtp", few);
  expectRefused("", {"in/L3.vtp", "Points"});
  std::filesystem::remove(folder_ / "in" / "L3.vtp");

  TriMesh broken = bone("L3");
  broken.vertices[17].y() = std::nan("");
  put("L3.vtp", broken);
  expectRefused("", {"in/L3.vtp", "vertex 17", "finite"});
  std::filesystem::remove(folder_ / "in" / "L3.vtp");

  write("in/L3.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  expectRefused("", {"in/L3.ply"});
}

TEST_F(ImportBones, RefusesWhatItCannotName) {
  expectRefused("", {"in", "no mesh files"});
  put("object1.stl", bone("L3"));
  expectRefused("", {"in", "--map"});
  write("map.json", R"({"object1.stl": "L9"})");
  expectRefused("--map map.json", {"map.json", "object1.stl", "L9"});
  write("map.json", R"({"object2.stl": "L3"})");
  expectRefused("--map map.json", {"map.json", "object2.stl", "no such file"});
  write("map.json", "{");
  expectRefused("--map map.json", {"map.json", "not JSON"});
  put("L3.stl", bone("L3"));
  write("map.json", R"({"object1.stl": "L3"})");
  expectRefused("--map map.json", {"object1.stl", "L3.stl"});
  EXPECT_EQ(run("import-bones nowhere -o out").status, 1);
}

TEST_F(ImportBones, RefusesMissingLevels) {
  TriMesh spine = bone("L3");
  append(spine, bone("L4"));
  put("lumbar.stl", spine);
  expectRefused("", {"in/lumbar.stl", "2 vertebrae", "--map"});
  write("landmarks.json", R"({"L2": {"spinous_tip": [0, 0, 0]}})");
  write("map.json", R"({"lumbar.stl": ["L4", "L3"]})");
  expectRefused("--map map.json --landmarks landmarks.json", {"landmarks.json", "L2", "no mesh"});
  write("landmarks.json", R"({"L3": {"nose": [0, 0, 0]}})");
  expectRefused("--map map.json --landmarks landmarks.json",
                {"landmarks.json", "L3", "nose", "spinous_tip"});
  write("landmarks.csv", "level,landmark,x,y,z\nL3,spinous_tip,0,zero,0\n");
  expectRefused("--map map.json --landmarks landmarks.csv", {"landmarks.csv:2", "y"});
}

TEST_F(ImportBones, NamesTheLandmarkToGive) {
  put("L3.stl", bone("left_clavicle"));
  expectRefused("--unit m", {"in/L3.stl", "upper_endplate", "spinous_tip", "--landmarks"});
}

}  // namespace
}  // namespace torso::tools
