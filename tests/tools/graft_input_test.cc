// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Input that cannot be grafted gets one message that says what is wrong, and nothing is written.

#include <fmt/format.h>
#include <unistd.h>

#include "tests/tools/graft_fixture.h"

namespace torso::tools {
namespace {

class GraftInput : public GraftFixture {
 protected:
  // Grafting this text fails with a message that has this part and names the file.
  void refuses(const std::string& text, const std::string& part) const {
    const std::string message = errorOf(options(write("bad.xml", text)));
    EXPECT_NE(message.find("bad.xml: "), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
};

const char kLimb[] =
    "<joint axis='1 0 0'/><joint axis='0 1 0'/><joint axis='0 0 1'/>"
    "<geom size='.05'/><body pos='0 0 -.4'><joint/><geom size='.05'/></body>";

std::string limbs(const std::string& name, double x, double z) {
  return fmt::format(
      "<body name='left_{0}' pos='{1} .1 {2}'>{3}</body>"
      "<body name='right_{0}' pos='{1} -.1 {2}'>{3}</body>",
      name, x, z, kLimb);
}

std::string trunkWith(const std::string& inside, const std::string& joint = "<freejoint/>") {
  return "<mujoco><worldbody><body name='trunk'>" + joint + "<geom size='.1'/>" + inside +
         "</body></worldbody></mujoco>";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t i = text.find(what);
  EXPECT_NE(i, std::string::npos) << what;
  return text.replace(i, what.size(), by);
}

TEST_F(GraftInput, WithoutArmsOrLegs) {
  refuses(trunkWith(limbs("thigh", 0, 0)), "no arms: 'left_thigh' and 'right_thigh'");
  refuses(trunkWith(limbs("thigh", 0, 0)),
          "name 'left_upper_arm' and 'right_upper_arm' in a --map");
  refuses(trunkWith(limbs("upper_arm", 0, 0)), "no thighs: 'left_upper_arm' and");
  refuses(trunkWith(""), "no arms and no legs");
  refuses(trunkWith("<body name='wheel'><joint/><geom size='.1'/></body>"), "no arms and no legs");
  refuses("<mujoco/>", "no bodies");
}

TEST_F(GraftInput, Quadrupeds) {
  refuses(trunkWith(limbs("front_leg", 0.3, 0) + limbs("hind_leg", -0.3, 0)), "no arms");
  refuses(trunkWith(limbs("a", 0.3, 0) + limbs("b", -0.3, 0)), "is it a biped?");
  refuses(trunkWith(limbs("thigh", 0, 0.5) + limbs("upper_arm", 0, 0)), "not below the trunk");
  refuses(trunkWith(limbs("thigh", 0, 0) + limbs("upper_arm", 0, 0)), "where the hips are");
}

TEST_F(GraftInput, SeveralHumanoids) {
  const std::string message = errorOf(options("/usr/share/mujoco/model/humanoid/22_humanoids.xml"));
  EXPECT_NE(message.find("several humanoids"), std::string::npos) << message;
  EXPECT_NE(message.find("'pelvis' of one in a --map"), std::string::npos) << message;
}

// Roots of any kind are replaced by our free one, and the report says so.
TEST_F(GraftInput, AnyRootJointIsGrafted) {
  const std::string body = limbs("thigh", 0, 0) + limbs("upper_arm", 0, 0.5);
  const std::pair<const char*, int> roots[] = {
      {"<freejoint/>", 1},
      {"<joint type='free'/>", 1},
      {"<joint type='slide' axis='1 0 0'/><joint type='ball'/>", 2},
      {"<joint type='hinge'/><joint type='slide' axis='0 0 1'/><joint axis='0 1 0'/>", 3},
      {"", 0}};
  for (const auto& [joints, count] : roots) {
    const GraftReport report = graftTo(write("in.xml", trunkWith(body, joints)));
    int replaced_joints = 0;
    bool was_fixed = false;
    for (const GraftChange& c : report.changes) {
      replaced_joints += c.kind == "joint" && c.action == "replaced";
      was_fixed |= c.detail.find("was fixed to the world") != std::string::npos;
    }
    EXPECT_EQ(replaced_joints, count) << joints;
    EXPECT_EQ(was_fixed, count == 0) << joints;
    const ModelPtr m = loadModel(at("out.xml"));
    const int pelvis = idOf(m.get(), mjOBJ_BODY, "pelvis");
    EXPECT_EQ(m->jnt_type[m->body_jntadr[pelvis]], mjJNT_FREE);
  }
}

// What costs speed is changed or said.
TEST_F(GraftInput, StepAndIntegrator) {
  GraftOptions o = options(write("in.xml", waistDownHumanoid()));  // RK4, 4 ms
  graft(anatomy(), o);
  ModelPtr m = loadModel(at("out.xml"));
  EXPECT_EQ(m->opt.integrator, mjINT_EULER);
  EXPECT_NEAR(m->opt.timestep, 1.0 / 600, 1e-6);
  o.keep_integrator = true;
  o.timestep = 0.002;
  graft(anatomy(), o);
  m = loadModel(at("out.xml"));
  EXPECT_EQ(m->opt.integrator, mjINT_RK4);
  EXPECT_EQ(m->opt.timestep, 0.002);
  const GraftReport fine = graftTo(write("fine.xml", pelvisUpHumanoid()));  // 1 ms
  EXPECT_EQ(loadModel(at("out.xml"))->opt.timestep, 0.001);
  EXPECT_TRUE(std::any_of(fine.changes.begin(), fine.changes.end(), [](const GraftChange& c) {
    return c.action == "kept" && c.name == "timestep";
  }));
}

TEST_F(GraftInput, BrokenFiles) {
  refuses("", "cannot load");
  refuses("not xml at all", "cannot load");
  refuses("<mujoco><worldbody><body><freejont/></body></worldbody></mujoco>", "freejont");
  refuses(replaced(waistDownHumanoid(), "damping=\"0.4\"", "dampin=\"0.4\""), "dampin");
  refuses(replaced(waistDownHumanoid(), "joint=\"left_knee\"", "joint=\"left_kne\""), "left_kne");
  refuses(replaced(waistDownHumanoid(), "</default>", ""), "cannot load");
  refuses(replaced(waistDownHumanoid(), "<compiler ", "<compiler coordinate=\"global\" "),
          "coordinate");
  refuses(waistDownHumanoid().substr(0, 2000), "cannot load");
  refuses(
      "<robot name='r'><link name='l'><inertial><mass value='1'/><inertia ixx='1' iyy='1' "
      "izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>",
      "not MJCF");
}

TEST_F(GraftInput, MissingAndCyclicFiles) {
  EXPECT_NE(errorOf(options(at("none.xml"))).find("none.xml: no such file"), std::string::npos);
  EXPECT_NE(errorOf(options(folder_.string())).find("not a file"), std::string::npos);
  refuses(replaced(waistDownHumanoid(), "<asset>", "<asset><mesh name='m' file='no.stl'/>"),
          "no.stl");
  refuses("<mujoco><include file='absent.xml'/></mujoco>", "absent.xml");
  refuses("<mujoco><include file='bad.xml'/></mujoco>", "bad.xml");
  write("a.xml", "<mujocoinclude><include file='b.xml'/></mujocoinclude>");
  write("b.xml", "<mujocoinclude><include file='a.xml'/></mujocoinclude>");
  refuses("<mujoco><include file='a.xml'/></mujoco>", "a.xml");
}

TEST_F(GraftInput, OutputThatCannotBeWritten) {
  const std::string input = write("in.xml", waistDownHumanoid());
  EXPECT_NE(errorOf(options(input, "no/such/folder/out.xml"))
                .find("out.xml: cannot write: no such folder"),
            std::string::npos);
  write("taken/file", "x");
  EXPECT_NE(errorOf(options(input, "taken")).find("taken: cannot write: this is a folder"),
            std::string::npos);
  // A file where the folder of the meshes should be.
  write("elsewhere/torso_assets", "x");
  EXPECT_NE(errorOf(options(input, "elsewhere/out.xml")).find("torso_assets: cannot"),
            std::string::npos);
  if (geteuid() != 0) {
    std::filesystem::create_directory(folder_ / "locked");
    std::filesystem::permissions(folder_ / "locked", std::filesystem::perms::owner_read |
                                                         std::filesystem::perms::owner_exec);
    EXPECT_NE(errorOf(options(input, "locked/out.xml")).find("locked"), std::string::npos);
  }
}

TEST_F(GraftInput, OutputOntoTheInput) {
  write("body.xml", "<mujocoinclude><statistic extent='2'/></mujocoinclude>");
  const std::string input = write("in.xml", replaced(waistDownHumanoid(), "<worldbody>",
                                                     "<include file='body.xml'/><worldbody>"));
  EXPECT_NE(errorOf(options(input, "in.xml")).find("is the humanoid itself"), std::string::npos);
  EXPECT_NE(errorOf(options(input, "body.xml")).find("is a file of the humanoid"),
            std::string::npos);
  GraftOptions o = options(input);
  o.map = write("map.json", "{}");
  o.output = o.map;
  EXPECT_NE(errorOf(o).find("is the map"), std::string::npos);
}

TEST_F(GraftInput, TorsoThatIsThereAlready) {
  graftTo(write("in.xml", waistDownHumanoid()), "once.xml");
  EXPECT_NE(errorOf(options(at("once.xml"))).find("it has a torso of ours already; give"),
            std::string::npos);
  GraftOptions o = options(at("once.xml"));
  o.prefix = "b_";
  EXPECT_NE(errorOf(o).find("already, and no other humanoid"), std::string::npos);
}

}  // namespace
}  // namespace torso::tools
