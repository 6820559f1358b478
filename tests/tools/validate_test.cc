// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// `torso validate` as a user runs it.

#include <algorithm>
#include <regex>
#include <set>

#include "tests/tools/command_fixture.h"

namespace torso::tools {
namespace {

using Json = nlohmann::json;

class Validate : public Command {
 protected:
  // First words of the lines of --list: ids, or subcommands of torso.
  std::set<std::string> listed(const std::string& arguments, const std::regex& what) {
    const Result result = run("validate --list " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    std::set<std::string> found;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) {
      std::smatch match;
      if (std::regex_search(line, match, what)) found.insert(match[1]);
    }
    return found;
  }

  // Files that hold results, each of which must be whole.
  std::set<std::string> results(const std::string& folder) {
    std::set<std::string> ids;
    for (const auto& file : std::filesystem::directory_iterator(folder_ / folder)) {
      EXPECT_NE(file.path().filename().string()[0], '.') << file.path();
      if (file.path().extension() != ".json") continue;
      EXPECT_FALSE(Json::parse(readFile(file.path()), nullptr, false).is_discarded());
      ids.insert(file.path().stem());
    }
    return ids;
  }
};

const std::regex kId("^(\\w+)");

TEST_F(Validate, ShortFormIsCompleteSelfContainedAndResumes) {
  const std::set<std::string> ids = listed("--short", kId);
  EXPECT_GE(ids.size(), 9u);
  const Json first = runJson("validate --short -o v --json");
  ASSERT_TRUE(first.contains("sections"));
  EXPECT_EQ(first["sections"].size(), ids.size());
  EXPECT_EQ(results("v"), ids);

  const std::string page = readFile(folder_ / "v/index.html");
  for (const Json& section : first["sections"]) {
    EXPECT_FALSE(section["failed"]) << section["id"] << ": " << section["message"];
    const std::string id = section["id"];
    EXPECT_NE(page.find("<section id=\"" + id + "\">"), std::string::npos) << id;
    EXPECT_NE(page.find("href=\"#" + id + "\""), std::string::npos) << id;
    EXPECT_NE(page.find(section["command"].get<std::string>()), std::string::npos) << id;
  }
  // What is measured is in it: the commands' own figures, rounded.
  const Json model = Json::parse(readFile(folder_ / "v/info.json"))["output"];
  EXPECT_NE(page.find("<td class=\"ours\">" + std::to_string(model["dof"].get<int>()) + "</td>"),
            std::string::npos);
  const Json fall = Json::parse(readFile(folder_ / "v/fall.json"))["output"]["models"][0];
  char head[32];
  std::snprintf(head, sizeof head, "%.3g g", fall["landing"]["head_3ms_g"]["mean"].get<double>());
  EXPECT_NE(page.find(head), std::string::npos) << head;
  for (const char* text :
       {"http:", "https:", "file:", "@import", "url(", "<script", "<link", "NaN"}) {
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  }

  // A browser, where there is one, sees all of it.
  if (std::system("command -v chromium > /dev/null") == 0) {
    const std::string dom = (folder_ / "dom.html").string();
    const std::string browse =
        "timeout 60 chromium --headless --no-sandbox --disable-gpu "
        "--dump-dom file://" +
        (folder_ / "v/index.html").string() + " > " + dom + " 2> /dev/null";
    ASSERT_EQ(std::system(browse.c_str()), 0);
    const std::string seen = readFile(dom);
    for (const std::string& id : ids) {
      EXPECT_NE(seen.find("<section id=\"" + id + "\">"), std::string::npos) << id;
    }
  }

  // Nothing is run again; the page is written anew and the same.
  std::filesystem::remove(folder_ / "v/index.html");
  EXPECT_EQ(runJson("validate --short -o v --json"), first);
  EXPECT_EQ(readFile(folder_ / "v/index.html"), page);
  // Other options: that section is.
  const Json other = runJson("validate --only info,rom --short -o v --json");
  EXPECT_EQ(other["sections"].size(), 2u);
  std::ofstream(folder_ / "v/info.json") << "{\"build\": ";  // not ours, or of another build
  EXPECT_EQ(run("validate --only info --short -o v").status, 0);
  EXPECT_EQ(results("v"), ids);
}

TEST_F(Validate, ShowsAFailedSectionAndSaysSo) {
  std::filesystem::create_directory(folder_ / "swing");
  const std::string command = "validate --short --only info,optimize1 --optimized swing -o v";
  const Result result = run(command);
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, "torso validate: failed sections: optimize1\n");
  EXPECT_NE(result.out.find("failed: cat: "), std::string::npos) << result.out;
  const std::string page = readFile(folder_ / "v/index.html");
  EXPECT_NE(page.find("<div class=\"failed\"><strong>failed</strong>: cat: "), std::string::npos);
  EXPECT_NE(page.find("1 of 2 sections failed"), std::string::npos);
  // It prints what it should not.
  write("swing/result.json", "{\"task\": 3}");
  EXPECT_EQ(run(command).status, 1);
  EXPECT_NE(readFile(folder_ / "v/index.html").find("its figures could not be read"),
            std::string::npos);
  // Mended, it is run again and the page is whole.
  write(
      "swing/result.json",
      R"({"task": "swing", "best_cost": -1.5, "start_cost": 0.5, "simulated_s_per_iteration": 76.8, "iterations": 30,
            "parameters": 60, "settings": {"samples": 64, "horizon_s": 1.2}})");
  EXPECT_EQ(run(command).status, 0);
  EXPECT_NE(readFile(folder_ / "v/index.html").find("<td class=\"ours\">-1.5</td>"),
            std::string::npos);
}

// Of two takes, one of which is off by more at the end, and of a clip that failed.
TEST_F(Validate, CountsWhatRetrofitHasWritten) {
  std::filesystem::create_directory(folder_ / "clips");
  write("clips/summary.csv",
        "clip,file,frames,held_median_mm,held_p95_mm,held_median_deg,held_p95_deg,frames_flagged,"
        "frames_within_3mm_1deg,frames_within_10mm_3deg,core_s_per_s,power_above_band_over_input,"
        "largest_jump_deg,error\n"
        "a,a.bvh,100,1,2,0.1,0.2,0,100,100,0.5,0.1,3,\n"
        "b,\"b, c.bvh\",300,2,11,0.1,0.2,10,150,280,0.9,1.5,9,\n"
        ",d.bvh,,,,,,,,,,,,\"no \"\"hips\"\", no legs\"\n");
  ASSERT_EQ(run("validate --only retrofit --clips clips -o v").status, 0);
  const std::string page = readFile(folder_ / "v/index.html");
  for (const std::string row : {"takes that go through</td><td class=\"ours\">2 of 3",
                                "within 10 mm and 3 deg</td><td class=\"ours\">95.0 %",
                                "within 3 mm and 1 deg</td><td class=\"ours\">62.5 %",
                                "frames flagged</td><td class=\"ours\">2.5 %",
                                "medians below 3 mm and 1 deg</td><td class=\"ours\">2 of 2",
                                "below 10 mm and 3 deg</td><td class=\"ours\">1 of 2",
                                "second of motion, median take</td><td class=\"ours\">0.7",
                                "more than the input's</td><td class=\"ours\">1 of 2"}) {
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
  // A table of another kind: said, not guessed.
  write("clips/summary.csv", "clip,error\na,\n");
  EXPECT_EQ(run("validate --only retrofit --clips clips -o v").status, 1);
  EXPECT_NE(readFile(folder_ / "v/index.html").find("its figures could not be read"),
            std::string::npos);
}

// No ctest where it looks for one: a message, not the end of the report.
TEST_F(Validate, GoesOnAfterACommandThatCannotBeStarted) {
  const Result result = run("validate --only tests,info --tests . -o v", "env PATH=/nonexistent");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("failed: ctest: No such file"), std::string::npos) << result.out;
  EXPECT_NE(readFile(folder_ / "v/index.html").find("<section id=\"info\">"), std::string::npos);
}

TEST_F(Validate, InterruptedItLeavesWholeFiles) {
  const Result result = run("validate --short --only info,shoulder,identify -o v",
                            "timeout --foreground --preserve-status -s INT 1");
  EXPECT_NE(result.status, 0);
  EXPECT_NE(result.err.find("the same command goes on"), std::string::npos) << result.err;
  EXPECT_LT(results("v").size(), 3u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "v/index.html"));
}

TEST_F(Validate, RefusesUnknownSections) {
  const Result result = run("validate --only knees");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("--only knees: there is no such section; choose from info, bones"),
            std::string::npos);
  EXPECT_EQ(run("validate --short --only truth").err,
            "torso validate: --only: the short form has none of these sections\n");
}

// Every command that README's validation part gives figures of has its section.
TEST_F(Validate, HasTheCommandsOfTheReadme) {
  const std::string readme = readFile(TORSO_README);
  const std::size_t begin = readme.find("\n## Validation"), end = readme.find("\n## ", begin + 1);
  ASSERT_NE(begin, std::string::npos);
  const std::string part = readme.substr(begin, end - begin);
  std::filesystem::create_directory(folder_ / "x");
  const std::set<std::string> sections =
      listed("--clips x --optimized x --tests x", std::regex("torso ([a-z-]+)"));
  const std::regex command("`torso ([a-z-]+)");
  int found = 0;
  for (std::sregex_iterator i(part.begin(), part.end(), command), last; i != last; ++i) {
    const std::string name = (*i)[1];
    // The report itself, and what writes and measures nothing.
    if (name == "validate" || name == "build" || name == "calibrate-discs") continue;
    // Read from their folders, not run again.
    const bool kept = name == "optimize" || name == "retrofit";
    EXPECT_EQ(sections.count(name), kept ? 0u : 1u) << name;
    found++;
  }
  EXPECT_GT(found, 8);
}

}  // namespace
}  // namespace torso::tools
