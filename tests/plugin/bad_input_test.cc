// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Every damage is refused with a message that names the element at fault.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "tests/plugin/fixture.h"

namespace torso {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

using Words = std::vector<std::string>;

class BadInputTest : public PluginTest {
 protected:
  // Value of the attribute `data` of the element that starts like this, word by word.
  static void editData(std::string* text, const std::string& element,
                       const std::function<void(Words*)>& edit) {
    const std::size_t at = text->find(element);
    if (at == std::string::npos) throw std::runtime_error("the model has no " + element);
    const std::size_t start = text->find("data=\"", at) + 6, end = text->find('"', start);
    std::istringstream stream(text->substr(start, end - start));
    Words words{std::istream_iterator<std::string>(stream), {}};
    edit(&words);
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
    text->replace(start, end - start, out);
  }
  // Index of the first number after a key.
  static std::size_t after(const Words& words, const std::string& key) {
    return std::find(words.begin(), words.end(), key) - words.begin() + 1;
  }
  // Message with which MuJoCo refuses to load the text.
  static std::string refusal(const std::string& text) {
    std::string error;
    const ModelPtr m = loadText(text, &error);
    return m ? "it loads" : error;
  }
  std::string refusalOf(const std::string& from, const std::string& to) {
    replaceOnce(&text, from, to);
    return refusal(text);
  }
  std::string refusalOf(const std::string& element, const std::function<void(Words*)>& edit) {
    editData(&text, element, edit);
    return refusal(text);
  }

  static constexpr const char* kMesh = "<text name=\"disc:L4/L5\"";
  static constexpr const char* kTopology = "<text name=\"disc_topology\"";
  static constexpr const char* kMaterial = "<numeric name=\"disc:L4/L5\"";
  static constexpr const char* kTuple = "<tuple name=\"disc:L4/L5\">\n            ";
  std::string text = modelText("torso.xml");
};

TEST_F(BadInputTest, MissingFile) {
  char error[500] = "";
  EXPECT_EQ(mj_loadXML("/no/such/torso.xml", nullptr, error, sizeof error), nullptr);
  EXPECT_THAT(error, HasSubstr("/no/such/torso.xml"));
}

TEST_F(BadInputTest, NullModel) {
  char error[500];
  EXPECT_EQ(torso_info(nullptr, nullptr, error, sizeof error), -1);
  EXPECT_STREQ(error, "the model is null");
}

TEST_F(BadInputTest, ModelWithoutTorso) {
  const ModelPtr m = loadText(
      "<mujoco><worldbody><body><freejoint/><geom size='1'/></body>"
      "</worldbody></mujoco>");
  const DataPtr d = makeData(m.get());
  mj_step(m.get(), d.get());
  char error[500] = "x";
  EXPECT_EQ(torso_info(m.get(), nullptr, error, sizeof error), 0);
  EXPECT_STREQ(error, "");
  mjtNum force[3];
  EXPECT_EQ(torso_discWrench(m.get(), d.get(), 0, force, nullptr, nullptr), -1);
  torso_lastError(error, sizeof error);
  EXPECT_STREQ(error, "the model holds no torso (no numeric 'mujoco_torso')");
}

TEST_F(BadInputTest, IntactTextLoads) { EXPECT_EQ(refusal(text), "it loads"); }

TEST_F(BadInputTest, WrongFormatVersion) {
  EXPECT_THAT(
      refusalOf("name=\"mujoco_torso\" data=\"2 0 0\"", "name=\"mujoco_torso\" data=\"1 0 0\""),
      HasSubstr("numeric 'mujoco_torso': format 1 is not known to this version of the "
                "plugin, which reads format 2; make the model anew"));
}

TEST_F(BadInputTest, HeaderOfWrongSize) {
  EXPECT_THAT(
      refusalOf("name=\"mujoco_torso\" data=\"2 0 0\"", "name=\"mujoco_torso\" data=\"2 0\""),
      HasSubstr("numeric 'mujoco_torso': it must hold 3 numbers"));
}

TEST_F(BadInputTest, WrongCountOfCoordinates) {
  EXPECT_THAT(refusalOf(kMesh, [](Words* w) { w->pop_back(); }),
              HasSubstr("text 'disc:L4/L5': positions_mm has 554 numbers, which is not a multiple "
                        "of 3"));
}

TEST_F(BadInputTest, NodeMissing) {
  EXPECT_THAT(refusalOf(kMesh, [](Words* w) { w->resize(w->size() - 3); }),
              HasSubstr("text 'disc:L4/L5': tet"));
  EXPECT_THAT(refusal(text), HasSubstr("node index 184 is out of range (184 nodes)"));
}

TEST_F(BadInputTest, NodeTooMany) {
  EXPECT_THAT(refusalOf(kMesh,
                        [](Words* w) {
                          w->insert(w->end(), {"1", "2", "3"});
                        }),
              HasSubstr("text 'disc:L4/L5': node 185 belongs to no tet"));
}

TEST_F(BadInputTest, PositionIsNotANumber) {
  EXPECT_THAT(refusalOf(kMesh, [](Words* w) { w->at(5) = "nan"; }),
              HasSubstr("text 'disc:L4/L5': number 4 is not finite"));
}

TEST_F(BadInputTest, PositionIsAWord) {
  EXPECT_THAT(refusalOf(kMesh, [](Words* w) { w->at(5) = "wide"; }),
              HasSubstr("text 'disc:L4/L5': unexpected 'wide "));
}

TEST_F(BadInputTest, KeyIsMissing) {
  EXPECT_THAT(refusalOf(kMesh, [](Words* w) { w->at(0) = "positions"; }),
              HasSubstr("text 'disc:L4/L5': 'positions_mm' is missing"));
}

TEST_F(BadInputTest, InvertedTet) {
  // Two corners of the first tet change places.
  EXPECT_THAT(refusalOf(kTopology, [](Words* w) { std::swap(w->at(1), w->at(2)); }),
              HasSubstr("tet 0 is inverted (negative volume)"));
}

TEST_F(BadInputTest, DegenerateTet) {
  EXPECT_THAT(refusalOf(kTopology, [](Words* w) { w->at(1) = w->at(2); }),
              HasSubstr("tet 0 is degenerate (no volume)"));
}

TEST_F(BadInputTest, TetOfThreeNodes) {
  EXPECT_THAT(
      refusalOf(kTopology, [](Words* w) { w->erase(w->begin() + 1); }),
      HasSubstr("text 'disc_topology': tets has 2879 indices, which is not a multiple of 4"));
}

TEST_F(BadInputTest, NegativeNode) {
  EXPECT_THAT(refusalOf(kTopology, [](Words* w) { w->at(1) = "-1"; }),
              HasSubstr("tet 0: node index -1 is out of range (185 nodes)"));
}

TEST_F(BadInputTest, NodeIsNotAnInteger) {
  EXPECT_THAT(refusalOf(kTopology, [](Words* w) { w->at(1) = "1.5"; }),
              HasSubstr("text 'disc_topology': a node index is not an integer"));
}

TEST_F(BadInputTest, NodeAttachedTwice) {
  EXPECT_THAT(
      refusalOf(kTopology, [](Words* w) { w->at(after(*w, "upper")) = w->at(after(*w, "lower")); }),
      HasSubstr("is attached twice"));
}

TEST_F(BadInputTest, NegativeModulus) {
  EXPECT_THAT(refusalOf(kMaterial, [](Words* w) { w->at(0) = "-4e6"; }),
              HasSubstr("numeric 'disc:L4/L5': Young's modulus of the annulus -4e+06 is not in "
                        "(0, 1e+12]"));
}

TEST_F(BadInputTest, PoissonsRatioOfAHalf) {
  EXPECT_THAT(refusalOf(kMaterial, [](Words* w) { w->at(1) = "0.5"; }),
              HasSubstr("numeric 'disc:L4/L5': Poisson's ratio of the annulus 0.5 is not in [0, "
                        "0.5)"));
}

TEST_F(BadInputTest, NegativeRetardationTime) {
  EXPECT_THAT(refusalOf(kMaterial, [](Words* w) { w->at(7) = "-0.02"; }),
              HasSubstr("numeric 'disc:L4/L5': the retardation time is negative"));
}

TEST_F(BadInputTest, MaterialOfSevenNumbers) {
  EXPECT_THAT(refusalOf(kMaterial, [](Words* w) { w->pop_back(); }),
              HasSubstr("numeric 'disc:L4/L5': it holds 7 numbers, it must hold 8"));
}

// MuJoCo's own compiler knows the names.
TEST_F(BadInputTest, UnknownSite) {
  EXPECT_THAT(refusalOf("objname=\"L4/L5_lower\" prm", "objname=\"L4/L6_lower\" prm"),
              HasSubstr("L4/L6_lower"));
}

TEST_F(BadInputTest, UnknownBody) {
  EXPECT_THAT(refusalOf("<weld name=\"L4/L5\" body1=\"L4\"", "<weld name=\"L4/L5\" body1=\"L6\""),
              HasSubstr("L6"));
}

TEST_F(BadInputTest, MissingElementOfATuple) {
  EXPECT_THAT(refusalOf(std::string(kTuple) +
                            "<element objtype=\"site\" objname=\"L4/L5_lower\" prm=\"0\"/>",
                        kTuple),
              HasSubstr("tuple 'disc:L4/L5': element 2 is a equality, it must be a site"));
}

TEST_F(BadInputTest, TupleEndsEarly) {
  EXPECT_THAT(refusalOf("<element objtype=\"geom\" objname=\"L4/L5_left_point3\" prm=\"0\"/>", ""),
              HasSubstr("tuple 'facet:L4/L5_left': it ends where a geom must follow; run `torso "
                        "build` or `torso graft` again"));
}

TEST_F(BadInputTest, BothSitesOnOneBone) {
  EXPECT_THAT(refusalOf("objname=\"L4/L5_lower\" prm", "objname=\"L3/L4_lower\" prm"),
              HasSubstr("tuple 'disc:L4/L5': both sites are on one body; a disc lies between two"));
}

TEST_F(BadInputTest, EqualityIsNoWeld) {
  EXPECT_THAT(refusalOf("<weld name=\"L4/L5\" body1=\"L4\" body2=\"L5\"",
                        "<connect name=\"L4/L5\" body1=\"L4\" body2=\"L5\" anchor=\"0 0 0\"/>\n"
                        "<weld name=\"other\" body1=\"L4\" body2=\"L5\""),
              HasSubstr("tuple 'disc:L4/L5': equality 'L4/L5' must be a weld"));
}

TEST_F(BadInputTest, FacetBandOutOfRange) {
  EXPECT_THAT(refusalOf("objname=\"L4/L5_left_ellipsoid\" prm=\"0.2\"",
                        "objname=\"L4/L5_left_ellipsoid\" prm=\"1\""),
              HasSubstr("tuple 'facet:L4/L5_left': the band (prm of the ellipsoid) must lie "
                        "between 0 and 1"));
}

TEST_F(BadInputTest, FacetPointIsNoSphere) {
  EXPECT_THAT(
      refusalOf("objname=\"L4/L5_left_point2\" prm", "objname=\"L4/L5_left_ellipsoid\" prm"),
      HasSubstr("tuple 'facet:L4/L5_left': geom 'L4/L5_left_ellipsoid' must be a sphere"));
}

TEST_F(BadInputTest, SensorOfWrongDimension) {
  EXPECT_THAT(refusalOf("<user name=\"L4/L5_force\" objtype=\"tuple\" objname=\"disc:L4/L5\" "
                        "datatype=\"real\" needstage=\"acc\" dim=\"3\"",
                        "<user name=\"L4/L5_force\" objtype=\"tuple\" objname=\"disc:L4/L5\" "
                        "datatype=\"real\" needstage=\"acc\" dim=\"2\""),
              HasSubstr("sensor 'L4/L5_force': dim is 2, it must be 3"));
}

TEST_F(BadInputTest, SensorOfUnknownKind) {
  EXPECT_THAT(
      refusalOf("needstage=\"acc\" dim=\"3\" user=\"1\"", "needstage=\"acc\" dim=\"3\" user=\"7\""),
      HasSubstr("user[0] must be 0 force, 1 moment, 2 pressure, 3 ligament, 4 facet "
                "or 5 nucleus pressure"));
}

TEST_F(BadInputTest, UserdataTooSmall) {
  const ModelPtr sound = loadText(text);
  const std::string needed = std::to_string(torsoOf(sound.get()).nuserdata);
  const std::string message = refusalOf("nuserdata=\"20000\"", "nuserdata=\"100\"");
  EXPECT_THAT(message, HasSubstr("nuserdata is 100, the 23 discs need " + needed));
  EXPECT_THAT(message, HasSubstr("<size nuserdata=\"" + needed + "\"/>"));
  // The number that the message asks for is enough, and one less is not.
  replaceOnce(&text, "nuserdata=\"100\"", "nuserdata=\"" + needed + "\"");
  EXPECT_EQ(refusal(text), "it loads");
  replaceOnce(&text, "nuserdata=\"" + needed + "\"",
              "nuserdata=\"" + std::to_string(std::stoi(needed) - 1) + "\"");
  EXPECT_THAT(refusal(text), HasSubstr("nuserdata is"));
}

TEST_F(BadInputTest, NoDiscs) {
  EXPECT_THAT(
      refusal("<mujoco><custom><numeric name='mujoco_torso' data='2 0 0'/></custom></mujoco>"),
      HasSubstr("custom: no tuple 'disc:...' was found"));
}

// A model that does not come from MuJoCo's compiler: it runs without discs, and says so once.
TEST_F(BadInputTest, DamageInMemoryWarnsOnce) {
  const ModelPtr m = loadText(text);
  const int numeric = mj_name2id(m.get(), mjOBJ_NUMERIC, "disc:L4/L5");
  m->numeric_data[m->numeric_adr[numeric]] = std::nan("");
  torso_uninstall();  // forgets the sound model
  torso_install();
  const DataPtr d = makeData(m.get());
  for (int i = 0; i < 3; i++) mj_step(m.get(), d.get());
  EXPECT_EQ(takeWarnings(), "torso data, numeric 'disc:L4/L5': number 0 is not finite\n");
  char error[500];
  EXPECT_EQ(torso_info(m.get(), nullptr, error, sizeof error), -1);
  EXPECT_STREQ(error, "torso data, numeric 'disc:L4/L5': number 0 is not finite");
}

TEST_F(BadInputTest, IndexOutOfRange) {
  const ModelPtr m = loadText(text);
  const DataPtr d = makeData(m.get());
  mj_forward(m.get(), d.get());
  const auto lastError = [] {
    char error[500];
    torso_lastError(error, sizeof error);
    return std::string(error);
  };
  mjtNum force[3];
  EXPECT_EQ(torso_discWrench(m.get(), d.get(), 23, force, nullptr, nullptr), -1);
  EXPECT_EQ(lastError(), "disc 23 does not exist, there are 23");
  EXPECT_EQ(torso_discName(m.get(), -1), nullptr);
  EXPECT_EQ(lastError(), "disc -1 does not exist, there are 23");
  EXPECT_EQ(torso_facetForce(m.get(), d.get(), 74, force), -1);
  EXPECT_EQ(lastError(), "facet 74 does not exist, there are 74");
  EXPECT_EQ(torso_discId(m.get(), "L9/L10"), -1);
  EXPECT_EQ(lastError(), "no disc is called 'L9/L10'");
  EXPECT_EQ(torso_facetId(m.get(), nullptr), -1);
  EXPECT_EQ(lastError(), "no facet is called '(null)'");
  char small[8];
  EXPECT_EQ(torso_lastError(small, sizeof small), static_cast<int>(lastError().size()));
  EXPECT_STREQ(small, "no face");
}

class BadOptionTest : public PluginTest {
 protected:
  // What one forward evaluation of the torso says.
  std::string warningWith(const std::function<void(mjModel*)>& change) {
    const ModelPtr m = loadModel("torso.xml");
    change(m.get());
    const DataPtr d = makeData(m.get());
    mj_forward(m.get(), d.get());
    mj_forward(m.get(), d.get());
    return takeWarnings();
  }
};

TEST_F(BadOptionTest, TimestepOfATenthOfASecond) {
  EXPECT_EQ(warningWith([](mjModel* m) { m->opt.timestep = 0.1; }),
            "torso: a timestep above 0.01 s is too long for the ligaments and facets; use 0.005 s "
            "or less\n");
}

TEST_F(BadOptionTest, Pgs) {
  EXPECT_EQ(warningWith([](mjModel* m) { m->opt.solver = mjSOL_PGS; }),
            "torso: the PGS solver ignores the discs' implicit rows; use Newton or CG\n");
}

TEST_F(BadOptionTest, Noslip) {
  EXPECT_EQ(warningWith([](mjModel* m) { m->opt.noslip_iterations = 3; }),
            "torso: noslip iterations ignore the discs' implicit rows; set noslip_iterations to "
            "0\n");
}

}  // namespace
}  // namespace torso
