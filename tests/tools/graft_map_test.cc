// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The map file, and how sure recognition is.

#include "tools/graft_map.h"
#include "tests/tools/graft_fixture.h"

namespace torso::tools {
namespace {

class GraftMapTest : public GraftFixture {
 protected:
  GraftOptions withMap(const std::string& text, const std::string& map) const {
    GraftOptions o = options(write("in.xml", text));
    o.map = write("map.json", map);
    return o;
  }
  static RecognisedPart part(const GraftReport& report, const std::string& name) {
    for (const RecognisedPart& p : report.parts) {
      if (p.part == name) return p;
    }
    ADD_FAILURE() << name;
    return {};
  }
};

// Humanoids in a row below one world.
std::string crowd() {
  std::string text = plainHumanoid();
  const std::size_t begin = text.find("<body"), end = text.rfind("</worldbody>");
  std::string other = text.substr(begin, end - begin);
  for (std::size_t i = 0; (i = other.find("name=\"", i)) != std::string::npos; i += 8) {
    other.insert(i + 6, "z_");
  }
  other.replace(other.find("0 0 1.1"), 7, "2 0 1.1");
  return text.insert(end, other);
}

TEST_F(GraftMapTest, WhatIsWrittenGivesTheSame) {
  for (const auto& [name, text] : humanoidForms()) {
    GraftOptions o = options(write("in.xml", text));
    o.write_map = at("map.json");
    graft(anatomy(), o);
    const std::string recognised = readFile(at("out.xml"));
    o = options(at("in.xml"));
    o.map = at("map.json");
    const GraftReport report = graft(anatomy(), o);
    EXPECT_EQ(readFile(at("out.xml")), recognised) << name;
    for (const RecognisedPart& p : report.parts) EXPECT_EQ(p.sureness, "given") << p.part;
  }
}

TEST_F(GraftMapTest, SaysHowSureItIs) {
  const GraftReport named = graftTo(write("a.xml", pelvisUpHumanoid()));
  for (const RecognisedPart& p : named.parts) EXPECT_EQ(p.sureness, "sure") << p.part;
  const GraftReport plain = graftTo(write("b.xml", plainHumanoid()));
  for (const char* limb : {"left_thigh", "right_upper_arm"}) {
    EXPECT_EQ(part(plain, limb).sureness, "likely");
    EXPECT_NE(part(plain, limb).reason.find("mass"), std::string::npos);
  }
  // Two bodies without a name above the shoulders: which is the head?
  std::string horns = plainHumanoid();
  horns.insert(horns.find("<body name=\"a1\""),
               "<body pos='0 0 .4'><geom size='.08'/></body>"
               "<body pos='.1 0 .45'><geom size='.02'/></body>");
  EXPECT_EQ(part(graftTo(write("c.xml", horns)), "head").sureness, "unsure");
}

// Left and right changed, the head among the neck: the map is believed.
TEST_F(GraftMapTest, OverridesWhatWouldBeRecognised) {
  const GraftReport report = graft(
      anatomy(), withMap(pelvisUpHumanoid(),
                         R"({"head": "Neck", "neck": null, "left_clavicle": ["L_Clavicle"]})"));
  EXPECT_EQ(part(report, "head").bodies, std::vector<std::string>{"Neck"});
  EXPECT_EQ(part(report, "head").sureness, "given");
  EXPECT_EQ(part(report, "chest").sureness, "sure");
  for (const GraftChange& c : report.changes) {
    if (c.kind == "body" && c.name == "Neck") {
      EXPECT_NE(c.detail.find("by 'head'"), std::string::npos);
    }
  }
}

TEST_F(GraftMapTest, ChoosesOneOfSeveral) {
  EXPECT_NE(errorOf(options(write("in.xml", crowd()))).find("several humanoids"),
            std::string::npos);
  const GraftReport report = graft(anatomy(), withMap(crowd(), R"({"pelvis": "z_base"})"));
  EXPECT_EQ(part(report, "left_thigh").bodies, std::vector<std::string>{"z_a1"});
}

TEST_F(GraftMapTest, BadMapsGetAMessage) {
  const auto has = [&](const std::string& map, const std::string& message) {
    const std::string error = errorOf(withMap(pelvisUpHumanoid(), map));
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_NE(error.find("map.json: "), std::string::npos) << error;
  };
  has("", "not JSON");
  has("{\"pelvis\": ", "not JSON");
  has("[1, 2]", "not a map");
  has("{\"hip\": \"Hips\"}", "no part is called 'hip'; known are pelvis, waist, chest");
  has("{\"pelvis\": 3}", "'pelvis': give the name of one body");
  has("{\"pelvis\": null}", "'pelvis': give the name of one body");
  has("{\"chest\": [\"Chest\"]}", "'chest': give the name of one body");
  has("{\"waist\": [\"Spine1\", 2]}", "'waist': not a list of names");
  has("{\"pelvis\": \"Pelvis\"}", "'pelvis': ");
  has("{\"pelvis\": \"Pelvis\"}", "has no body 'Pelvis'");
  has("{\"pelvis\": \"L_Calf\"}", "body 'L_Calf' of the trunk is part of the limb 'L_Thigh'");
  has("{\"chest\": \"Head\"}", "'chest': 'Head' does not carry");
  has("{\"head\": \"L_Calf\"}", "body 'L_Calf' of the trunk is part of the limb 'L_Thigh'");
  has("{\"left_thigh\": \"L_Thigh\"}", "give both of 'left_thigh' and 'right_thigh'");
  has("{\"left_thigh\": \"L_Thigh\", \"right_thigh\": \"L_Calf\"}", "are not two limbs");
  has(R"({"left_thigh": "L_Thigh", "right_thigh": "R_Thigh", "left_upper_arm": "L_Calf",
          "right_upper_arm": "R_Calf"})",
      "thighs and upper arms are parts of each other");
  GraftOptions o = options(at("in.xml"));
  o.map = at("missing.json");
  EXPECT_NE(errorOf(o).find("missing.json: cannot read this map"), std::string::npos);
}

}  // namespace
}  // namespace torso::tools
