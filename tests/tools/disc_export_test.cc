// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// What goes on in the discs, as files and in pictures.

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "tests/tools/command_fixture.h"
#include "tests/tools/picture.h"
#include "tools/disc_data.h"
#include "tools/disc_skin.h"
#include "tools/mujoco_support.h"
#include "tools/vtu.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::string kTorso = TORSO_MJCF "/torso_held.xml";
const char kHumanoid[] = "/usr/share/mujoco/model/humanoid/humanoid.xml";

class DiscExport : public Command {
 protected:
  // The held torso under its weight, somewhat bent.
  void SetUp() override {
    Command::SetUp();
    m_ = loadModel(kTorso);
    d_ = makeData(m_.get());
    for (int i = 0; i < m_->nu; i++) d_->ctrl[i] = 0.1 * m_->actuator_ctrlrange[2 * i + 1];
    for (int i = 0; i < 60; i++) mj_step(m_.get(), d_.get());
    mj_forward(m_.get(), d_.get());
  }

  ModelPtr m_;
  DataPtr d_;
};

std::string decode(const std::string& base64) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (char c : base64) {
    if (c == '=') break;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string::npos) continue;  // white space
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    if ((count += 6) >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
  }
  return bytes;
}

struct Array {
  int components = 0;
  std::vector<double> values;
  Eigen::Map<const Vector3d> vector(std::size_t i) const {
    return Eigen::Map<const Vector3d>(&values[3 * i]);
  }
  Eigen::Map<const Matrix3d> matrix(std::size_t i) const {
    return Eigen::Map<const Matrix3d>(&values[9 * i]);
  }
};

template <typename T>
std::vector<double> numbers(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return {values.begin(), values.end()};
}

// A .vtu file as the format's description says, read without our own code.
struct Grid {
  explicit Grid(const std::string& text) {
    tinyxml2::XMLDocument xml;
    EXPECT_EQ(xml.Parse(text.c_str()), tinyxml2::XML_SUCCESS) << xml.ErrorStr();
    const tinyxml2::XMLElement* root = xml.FirstChildElement("VTKFile");
    if (!root) return;
    EXPECT_STREQ(root->Attribute("type"), "UnstructuredGrid");
    EXPECT_STREQ(root->Attribute("byte_order"), "LittleEndian");
    EXPECT_STREQ(root->Attribute("header_type"), "UInt32");
    const auto* piece = root->FirstChildElement("UnstructuredGrid")->FirstChildElement("Piece");
    points = piece->IntAttribute("NumberOfPoints");
    cells = piece->IntAttribute("NumberOfCells");
    for (const char* part : {"PointData", "CellData", "Points", "Cells"}) {
      for (const auto* e = piece->FirstChildElement(part)->FirstChildElement("DataArray"); e;
           e = e->NextSiblingElement("DataArray")) {
        EXPECT_STREQ(e->Attribute("format"), "binary");
        const std::string bytes = decode(e->GetText()), type = e->Attribute("type");
        std::uint32_t size = 0;
        std::memcpy(&size, bytes.data(), sizeof(size));
        EXPECT_EQ(bytes.size(), sizeof(size) + size);
        const std::string content = bytes.substr(sizeof(size));
        Array& array = arrays[e->Attribute("Name")];
        array.components = e->IntAttribute("NumberOfComponents");
        array.values = type == "Float32" ? numbers<float>(content)
                       : type == "Int32" ? numbers<std::int32_t>(content)
                                         : numbers<std::uint8_t>(content);
        const std::string where = part;
        if (std::string(e->Attribute("Name")) == "connectivity") continue;
        const int count = where == "Points" || where == "PointData" ? points : cells;
        EXPECT_EQ(array.values.size(), static_cast<std::size_t>(count) * array.components)
            << e->Attribute("Name");
      }
    }
  }
  const Array& operator[](const char* name) const {
    EXPECT_TRUE(arrays.count(name)) << name;
    return arrays.at(name);
  }

  int points = 0, cells = 0;
  std::map<std::string, Array> arrays;
};

TEST_F(DiscExport, GridIsTheDiscs) {
  const Grid grid(vtu(m_.get(), d_.get()));
  const Array &x = grid["Points"], &tets = grid["connectivity"];
  ASSERT_EQ(tets.values.size(), 4u * grid.cells);
  int point = 0, cell = 0;
  for (int disc = 0; torso_discName(m_.get(), disc); disc++) {
    int nnode, ntet;
    torso_discSize(m_.get(), disc, &nnode, &ntet);
    std::vector<mjtNum> nodes(3 * nnode);
    std::vector<int> corners(4 * ntet);
    torso_discNodes(m_.get(), d_.get(), disc, nodes.data());
    torso_discTets(m_.get(), disc, corners.data());
    for (int i = 0; i < 3 * nnode; i++) EXPECT_NEAR(x.values[3 * point + i], nodes[i], 1e-6);
    for (int e = 0; e < ntet; e++) {
      for (int k = 0; k < 4; k++) {
        EXPECT_EQ(tets.values[4 * (cell + e) + k], point + corners[4 * e + k]);
      }
      EXPECT_EQ(grid["offsets"].values[cell + e], 4 * (cell + e + 1));
      EXPECT_EQ(grid["types"].values[cell + e], 10);  // tetrahedron
      EXPECT_EQ(grid["disc"].values[cell + e], disc);
    }
    point += nnode;
    cell += ntet;
  }
  EXPECT_EQ(grid.points, point);
  EXPECT_EQ(grid.cells, cell);
  EXPECT_GT(cell, 23 * 300);
}

TEST_F(DiscExport, FieldsFollowFromTheStress) {
  const Grid grid(vtu(m_.get(), d_.get()));
  const Array& stretch = grid["fibre_stretch"];
  EXPECT_EQ(grid["stress"].components, 9);
  EXPECT_EQ(stretch.components, 2);
  int nucleus = 0, taut = 0;
  double most = 0;
  for (int e = 0; e < grid.cells; e++) {
    const Matrix3d s = grid["stress"].matrix(e);
    const double scale = s.norm();
    EXPECT_NEAR(s(0, 1), s(1, 0), 1e-6 * scale);
    EXPECT_NEAR(s(0, 2), s(2, 0), 1e-6 * scale);
    EXPECT_NEAR(grid["pressure"].values[e], -(s(0, 0) + s(1, 1) + s(2, 2)) / 3, 1e-5 * scale);
    const double mises =
        std::sqrt((std::pow(s(0, 0) - s(1, 1), 2) + std::pow(s(1, 1) - s(2, 2), 2) +
                   std::pow(s(2, 2) - s(0, 0), 2)) /
                      2 +
                  3 * (std::pow(s(0, 1), 2) + std::pow(s(1, 2), 2) + std::pow(s(2, 0), 2)));
    EXPECT_NEAR(grid["von_mises"].values[e], mises, 1e-4 * scale);
    most = std::max(most, mises);
    if (grid["region"].values[e] == 0) {
      nucleus++;
      EXPECT_EQ(stretch.values[2 * e], 1);
      EXPECT_EQ(stretch.values[2 * e + 1], 1);
    } else {
      EXPECT_EQ(grid["region"].values[e], 1);
      taut += stretch.values[2 * e] > 1;
    }
  }
  EXPECT_GT(nucleus, grid.cells / 10);
  EXPECT_LT(nucleus, grid.cells / 2);
  EXPECT_GT(taut, 100);
  EXPECT_GT(most, 1e4);
  EXPECT_LT(most, 1e8);
}

// The shape of an undeformed disc moves with the lower bone: without a displacement at its lower
// nodes, and at the others no larger than a disc.
TEST_F(DiscExport, DisplacementIsFromTheLowerBone) {
  const Grid grid(vtu(m_.get(), d_.get()));
  int still = 0;
  double most = 0;
  for (int i = 0; i < grid.points; i++) {
    const double u = grid["displacement"].vector(i).norm();
    still += u < 1e-7;
    most = std::max(most, u);
  }
  // One of the five layers of nodes lies on the lower bone.
  EXPECT_EQ(still, grid.points / 5);
  EXPECT_GT(most, 1e-4);
  EXPECT_LT(most, 2e-2);
}

// The solver's own figure, which goes by another way.
TEST_F(DiscExport, PressureInTheNucleusIsTheSolvers) {
  const auto discs = discData(m_.get(), d_.get());
  ASSERT_EQ(discs.size(), 23u);
  for (std::size_t i = 0; i < discs.size(); i++) {
    double sum = 0;
    int count = 0;
    for (std::size_t e = 0; e < discs[i].tets.size(); e++) {
      if (discs[i].cells[e] >= 0) continue;
      sum -= discs[i].stress[e].trace() / 3;
      count++;
    }
    const double expected = torso_discNucleusPressure(m_.get(), d_.get(), static_cast<int>(i));
    EXPECT_NEAR(sum / count, expected, 0.02 * std::abs(expected) + 3e3) << discs[i].name;
  }
}

TEST_F(DiscExport, CollectionNamesFilesAndTimes) {
  tinyxml2::XMLDocument xml;
  ASSERT_EQ(xml.Parse(pvd({{0, "a.vtu"}, {0.125, "b & c.vtu"}}).c_str()), tinyxml2::XML_SUCCESS);
  const auto* root = xml.FirstChildElement("VTKFile");
  EXPECT_STREQ(root->Attribute("type"), "Collection");
  const auto* a = root->FirstChildElement("Collection")->FirstChildElement("DataSet");
  const auto* b = a->NextSiblingElement("DataSet");
  EXPECT_EQ(a->DoubleAttribute("timestep"), 0);
  EXPECT_STREQ(a->Attribute("file"), "a.vtu");
  EXPECT_EQ(b->DoubleAttribute("timestep"), 0.125);
  EXPECT_STREQ(b->Attribute("file"), "b & c.vtu");
  EXPECT_EQ(b->NextSiblingElement(), nullptr);
}

TEST_F(DiscExport, RunWritesTheInstantsAskedFor) {
  const auto times = [&](const std::string& folder) {
    std::vector<double> result;
    tinyxml2::XMLDocument xml;
    EXPECT_EQ(xml.LoadFile((folder_ / folder / "seed0.pvd").c_str()), tinyxml2::XML_SUCCESS);
    for (const auto* e = xml.FirstChildElement()->FirstChildElement()->FirstChildElement(); e;
         e = e->NextSiblingElement()) {
      result.push_back(e->DoubleAttribute("timestep"));
      EXPECT_EQ(Grid(readFile(folder_ / folder / e->Attribute("file"))).points > 0, true);
    }
    for (const auto& entry : fs::directory_iterator(folder_ / folder)) {
      EXPECT_NE(entry.path().extension(), ".tmp");
    }
    return result;
  };
  const std::string arguments = "run --json --seconds 0.1 " + kTorso;
  const double h = m_->opt.timestep;
  const auto plain = runJson(arguments);
  const auto written = runJson(arguments + " --vtu at --vtu-at 0.1,0,0.05");
  EXPECT_EQ(written["state_hash"], plain["state_hash"]);
  const auto at = times("at");
  ASSERT_EQ(at.size(), 3u);
  EXPECT_EQ(at[0], 0);
  EXPECT_NEAR(at[1], 0.05, h);
  EXPECT_NEAR(at[2], 0.1, h);
  EXPECT_NE(readFile(folder_ / "at/seed0_00000.vtu"), readFile(folder_ / "at/seed0_00002.vtu"));

  EXPECT_EQ(run(arguments + " --vtu every --vtu-every 0.025").status, 0);
  const auto every = times("every");
  ASSERT_EQ(every.size(), 5u);
  for (int i = 0; i < 5; i++) EXPECT_NEAR(every[i], 0.025 * i, h);
}

TEST_F(DiscExport, RunRefusesWhatItCannotWrite) {
  const auto error = [&](const std::string& arguments) {
    const Result result = run("run --seconds 0.1 " + arguments);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  EXPECT_NE(error(std::string("--vtu a ") + kHumanoid).find("the model has no discs"),
            std::string::npos);
  EXPECT_NE(error("--vtu a --vtu-at 0,3 " + kTorso).find("--vtu-at 3: the run ends at 0.1 s"),
            std::string::npos);
  write("file", "");
  EXPECT_NE(error("--vtu file/a " + kTorso).find("file/a: cannot make this folder"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

// Gauss: the volume that the skin encloses is that of all tets.
TEST_F(DiscExport, SkinIsTheClosedSurfaceOfTheDiscs) {
  const auto discs = discData(m_.get(), d_.get());
  double volume = 0;
  for (const DiscData& disc : discs) {
    for (const auto& t : disc.tets) {
      const auto& x = disc.nodes;
      volume += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).dot(x[t[3]] - x[t[0]]) / 6;
    }
  }
  for (const bool cut : {false, true}) {
    DiscColours colours;
    colours.cut = cut;
    colours.range = discRange(m_.get(), {d_.get()}, colours.quantity, cut);
    const DiscSkin skin(m_.get(), d_.get(), colours);
    const mjModel* m = skin.model();
    ASSERT_EQ(m->nskin, m_->nskin + 1);
    EXPECT_EQ(m->skin_group[m_->nskin], 1);
    for (int i = 0; i < m_->nskin; i++) EXPECT_EQ(m->skin_facenum[i], 0);  // the discs' own
    mjvScene scene;
    mjv_defaultScene(&scene);
    mjv_makeScene(m, &scene, 10000);
    mjvOption option;
    mjv_defaultOption(&option);
    mjvCamera camera;
    mjv_defaultFreeCamera(m, &camera);
    mjv_updateScene(m, d_.get(), &option, nullptr, &camera, mjCAT_ALL, &scene);
    skin.place(option, &scene);
    double enclosed = 0, outwards = 1;
    const int adr = m->skin_vertadr[m_->nskin];
    for (int f = 0; f < m->skin_facenum[m_->nskin]; f++) {
      const int* face = m->skin_face + 3 * (m->skin_faceadr[m_->nskin] + f);
      const auto corner = [&](const float* array, int k) {
        const float* v = array + 3 * (adr + face[k]);
        return Vector3d(v[0], v[1], v[2]);
      };
      // About a point near by, for the sake of single precision.
      const Vector3d centre = discs[10].origin;
      const Vector3d a = corner(scene.skinvert, 0) - centre;
      const Vector3d b = corner(scene.skinvert, 1) - centre;
      const Vector3d c = corner(scene.skinvert, 2) - centre;
      enclosed += a.dot(b.cross(c)) / 6;
      const Vector3d normal = (b - a).cross(c - a).normalized();
      for (int k = 0; k < 3; k++) {
        outwards = std::min(outwards, normal.dot(corner(scene.skinnormal, k)));
      }
    }
    EXPECT_NEAR(enclosed, (cut ? 0.5 : 1) * volume, (cut ? 0.03 : 1e-3) * volume);
    EXPECT_GT(outwards, 0.5);
    mjv_freeScene(&scene);
  }
}

TEST_F(DiscExport, RangeHoldsWhatIsDrawn) {
  const auto [low, high] = discRange(m_.get(), {d_.get()}, DiscQuantity::kMises, false);
  EXPECT_EQ(low, 0);
  std::vector<double> values;
  const Grid grid(vtu(m_.get(), d_.get()));
  for (double v : grid["von_mises"].values) values.push_back(v);
  std::sort(values.begin(), values.end());
  EXPECT_GT(high, values[values.size() / 2]);
  EXPECT_LT(high, 1.2 * values.back());
  // Of two states, it holds both.
  const DataPtr rest = makeData(m_.get());
  mj_forward(m_.get(), rest.get());
  const auto both = discRange(m_.get(), {rest.get(), d_.get()}, DiscQuantity::kPressure, false);
  const auto one = discRange(m_.get(), {rest.get()}, DiscQuantity::kPressure, false);
  EXPECT_GT(both[1] - both[0], one[1] - one[0]);
}

// Of pictures 640 wide, the legend is in the right quarter.
constexpr int kLegend = 480;

class DiscPicture : public DiscExport {
 protected:
  Picture render(const std::string& options) {
    const Result result =
        run("render -o a.png --width 640 --height 480 --layers discs --azimuth 180 --elevation 0 "
            "--lookat 0 0 1.1 --distance 0.5 " +
            kTorso + " " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out + result.err, "");
    return readPng(folder_ / "a.png");
  }
};

bool yellow(int r, int g, int b) { return r > 100 && g > 100 && b < r / 2; }
bool purple(int r, int g, int b) { return g < r / 2 && g < b / 2; }

TEST_F(DiscPicture, ColoursFollowTheRange) {
  const Picture plain = render("");
  EXPECT_EQ(plain.count(yellow, kLegend), 0);
  EXPECT_EQ(plain.count(purple, kLegend), 0);
  const Picture above = render("--discs pressure --discs-range=-100:-99");
  const int size = above.count(yellow, kLegend);
  EXPECT_GT(size, 2000);
  EXPECT_EQ(above.count(purple, kLegend), 0);
  const Picture below = render("--discs pressure --discs-range 99:100");
  EXPECT_EQ(below.count(yellow, kLegend), 0);
  EXPECT_NEAR(below.count(purple, kLegend), size, 0.05 * size);
  const Picture cut = render("--discs pressure --discs-range=-100:-99 --discs-cut");
  EXPECT_NEAR(cut.count(yellow, kLegend), size / 2, 0.1 * size);
  EXPECT_EQ(render("--discs pressure --discs-range=-100:-99 --hide discs").count(yellow, kLegend),
            0);
}

TEST_F(DiscPicture, QuantitiesDiffer) {
  const Picture pressure = render("--time 0.2 --discs pressure");
  const Picture mises = render("--time 0.2 --discs mises");
  EXPECT_GT(pressure.colours(), 500u);
  int differ = 0;
  for (int y = 0; y < 480; y++) {
    for (int x = 0; x < kLegend; x++) differ += pressure.at(x, y) != mises.at(x, y);
  }
  EXPECT_GT(differ, 1000);
}

// The legend's bar has the map's first colour at its foot and its last at its head, and grows
// lighter all the way; above it there is black text on white.
TEST_F(DiscPicture, LegendShowsTheMap) {
  const Picture plain = render(""), picture = render("--discs mises --discs-range 0:1");
  const std::array<int, 3> first = {68, 1, 84}, last = {253, 231, 37};
  int column = -1, foot = -1, head = -1;
  for (int x = kLegend; x < 640; x++) {
    for (int y = 479; y >= 0; y--) {
      EXPECT_NE(plain.at(x, y), first);
      if (picture.at(x, y) == first && foot < 0) {
        column = x;
        foot = y;
      }
      if (picture.at(x, y) == last && x == column) head = y;
    }
  }
  ASSERT_GT(foot, head + 100);
  for (int y = head; y < foot; y++) {
    EXPECT_GE(picture.at(column + 1, y)[1], picture.at(column + 1, y + 1)[1]) << y;
  }
  int black = 0;
  for (int y = 0; y < head; y++) {
    for (int x = kLegend; x < 640; x++) black += picture.at(x, y) == std::array<int, 3>{0, 0, 0};
  }
  EXPECT_GT(black, 50);
}

TEST_F(DiscPicture, AModelWithoutDiscsIsRefused) {
  const Result result = run(std::string("render -o a.png --discs mises ") + kHumanoid);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("the model has no discs to colour"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

TEST_F(DiscPicture, FramesOfARunHaveOneRange) {
  const Result result =
      run("run --seconds 0.1 --frames 2 --render f --width 200 --height 150 "
          "--discs pressure " +
          kTorso);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_GT(readPng(folder_ / "f/seed0_000000ms.png").colours(), 100u);
  EXPECT_NE(readFile(folder_ / "f/seed0_000000ms.png"), readFile(folder_ / "f/seed0_000100ms.png"));
}

}  // namespace
}  // namespace torso::tools
