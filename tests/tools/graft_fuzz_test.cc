// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Damaged humanoids: the graft gives a model that loads, or one message and no file. It never
// crashes or hangs. TORSO_FUZZ_SECONDS says for how long to try (a few seconds if it is not set);
// TORSO_FUZZ_FIRST is the first case, to repeat one; TORSO_FUZZ_VERBOSE prints the messages.

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>

#include "model/bone_mesh.h"
#include "tests/tools/graft_fixture.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

// Changes a humanoid's text; the same for the same seed on any machine.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string mutate(std::string text) {
    for (int n = 1 + pick(2); n > 0; n--) {
      XMLDocument document;
      // Bytes seldom: most such files do not even parse.
      if (pick(10) == 0 || document.Parse(text.c_str()) != tinyxml2::XML_SUCCESS) {
        text = mutateBytes(text);
      } else {
        mutateTree(document);
        tinyxml2::XMLPrinter printer;
        document.Print(&printer);
        text = printer.CStr();
      }
    }
    return text;
  }
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

 private:
  std::string mutateBytes(std::string text) {
    if (text.empty()) return text;
    const auto at = static_cast<std::size_t>(pick(static_cast<int>(text.size())));
    switch (pick(4)) {
      case 0:
        return text.substr(0, at);
      case 1:
        return text.erase(at, 1 + static_cast<std::size_t>(pick(40)));
      case 2:
        text[at] = static_cast<char>(pick(256));
        return text;
      default:
        return text.insert(at, text, static_cast<std::size_t>(pick(static_cast<int>(text.size()))),
                           60);
    }
  }

  void mutateTree(XMLDocument& document) {
    std::vector<XMLElement*> all;
    list(document.RootElement(), all);
    if (all.empty()) return;
    XMLElement* e = all[pick(static_cast<int>(all.size()))];
    XMLElement* other = all[pick(static_cast<int>(all.size()))];
    switch (pick(16)) {  // most changes of the tree are against the schema
      case 0:
        e->Parent()->DeleteChild(e);
        break;
      case 1:
        e->Parent()->InsertAfterChild(e, e->DeepClone(&document));
        break;
      case 2:
        other->InsertEndChild(e->DeepClone(&document));
        break;
      case 3:
        e->SetName(other->Name());
        break;
      default:
        mutateAttribute(e, other);
    }
  }

  void mutateAttribute(XMLElement* e, const XMLElement* other) {
    std::vector<std::string> names;
    for (const auto* a = e->FirstAttribute(); a; a = a->Next()) names.push_back(a->Name());
    const auto* foreign = other->FirstAttribute();
    if (names.empty() || pick(6) == 0) {
      if (foreign) e->SetAttribute(foreign->Name(), foreign->Value());
      return;
    }
    const std::string name = names[pick(static_cast<int>(names.size()))];
    static const char* const kValues[] = {"",        "0",         "-1",    "nan", "inf",
                                          "1e300",   "1e-300",    "true",  "x y", "0 0 0",
                                          "1 2 3 4", "-0 1e9 -1", "pelvis"};
    switch (pick(6)) {
      case 0:
        e->DeleteAttribute(name.c_str());
        break;
      case 1:
      case 2:
      case 3: {  // numbers by a factor, with the same count: most of these load
        std::istringstream in(e->Attribute(name.c_str()));
        static const double kFactors[] = {-1, 0, 0.01, 0.5, 2, 100};
        const double factor = kFactors[pick(std::size(kFactors))];
        std::string scaled;
        for (double x; in >> x;) scaled += fmt::format("{:g} ", factor * x);
        e->SetAttribute(name.c_str(), scaled.c_str());
        break;
      }
      case 4:
        e->SetAttribute(name.c_str(), foreign ? foreign->Value() : "");
        break;
      default:
        e->SetAttribute(name.c_str(), kValues[pick(std::size(kValues))]);
    }
  }

  static void list(XMLElement* parent, std::vector<XMLElement*>& all) {
    for (XMLElement* e = parent ? parent->FirstChildElement() : nullptr; e;
         e = e->NextSiblingElement()) {
      all.push_back(e);
      list(e, all);
    }
  }

  std::mt19937 random_;
};

class GraftFuzz : public GraftFixture {
 protected:
  // Bone meshes of four triangles: the shipped ones take most of the time of a graft.
  std::string smallMeshes() const {
    const std::vector<Eigen::Vector3d> p = {{0, 0, 0}, {.02, 0, 0}, {0, .02, 0}, {0, 0, .02}};
    TriMesh mesh;
    mesh.vertices = p;
    mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    for (const std::string& body : mjcfBodies(anatomy(), MjcfOptions())) {
      for (const Tissue tissue : boneTissues(anatomy(), body)) {
        write("meshes/" + boneMeshName(body, tissue) + ".stl", toStl(mesh));
      }
    }
    return at("meshes");
  }

  // MuJoCo 2.2.2 itself crashes or aborts on some files; that is not ours to mend.
  static bool mujocoSurvives(const std::string& path) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(20);
      try {
        loadModel(path);
      } catch (const Error&) {
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
};

int environment(const char* name, int missing) {
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : missing;
}

TEST_F(GraftFuzz, NeverCrashesOrHalfWrites) {
  const auto start = std::chrono::steady_clock::now();
  const int seconds = environment("TORSO_FUZZ_SECONDS", 4);
  const std::string texts[] = {waistDownHumanoid(), pelvisUpHumanoid(), plainHumanoid()};
  const std::string meshes = smallMeshes();
  int grafted = 0, refused = 0, excluded = 0;
  unsigned seed = static_cast<unsigned>(environment("TORSO_FUZZ_FIRST", 0));
  for (; std::chrono::steady_clock::now() - start < std::chrono::seconds(seconds); seed++) {
    SCOPED_TRACE(fmt::format("TORSO_FUZZ_FIRST={}", seed));
    Mutator mutator(seed);
    const std::string input = write("in.xml", mutator.mutate(texts[seed % 3]));
    if (!mujocoSurvives(input)) {
      excluded++;
      continue;
    }
    alarm(120);  // ends the test if the graft hangs
    GraftOptions o = options(input, "out/out.xml");
    o.meshes = meshes;
    o.groups = mutator.pick(2) != 0;
    o.prefix = mutator.pick(2) ? "p_" : "";
    std::filesystem::create_directory(folder_ / "out");
    try {
      graft(anatomy(), o);
      grafted++;
      loadModel(o.output);
    } catch (const Error& e) {
      refused++;
      if (std::getenv("TORSO_FUZZ_VERBOSE")) fmt::print("{}: {}\n", seed, e.what());
      EXPECT_NE(std::string(e.what()), "");
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      EXPECT_TRUE(std::filesystem::is_empty(folder_ / "out")) << e.what();
    }
    alarm(0);
    std::filesystem::remove_all(folder_ / "out");
    takeWarnings();
    if (HasFailure()) break;
  }
  fmt::print("{} grafted, {} refused, {} on which MuJoCo itself crashes\n", grafted, refused,
             excluded);
  EXPECT_GT(grafted + refused, 0);
}

}  // namespace
}  // namespace torso::tools
