// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// Damaged motion capture files: poses that are finite, or one message. Never a crash or a hang.
// TORSO_FUZZ_SECONDS says for how long to try (a few seconds if it is not set); TORSO_FUZZ_FIRST is
// the first case, to repeat one; TORSO_FUZZ_VERBOSE prints the messages.

#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <chrono>
#include <random>

#include "tests/tools/clip_texts.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"
#include "tools/retarget.h"

// Debian's assimp leaks when it gives a damaged file up; LeakSanitizer is to tell of our own leaks.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

namespace torso::tools {
namespace {

struct Sample {
  std::string path, content;
};

int environment(const char* name, int missing) {
  const char* value = std::getenv(name);
  return value ? std::atoi(value) : missing;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}
  std::string mutate(std::string text) {
    for (int n = 1 + pick(3); n > 0 && !text.empty(); n--) {
      const auto at = static_cast<size_t>(pick(static_cast<int>(text.size())));
      switch (pick(7)) {
        case 0:
          text.resize(at);
          break;
        case 1:
          text.erase(at, 1 + static_cast<size_t>(pick(60)));
          break;
        case 2:
          text[at] = static_cast<char>(pick(256));
          break;
        case 3:
          text.insert(at, text, static_cast<size_t>(pick(static_cast<int>(text.size()))), 80);
          break;
        default:
          number(text, at);
      }
    }
    return text;
  }

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  // The next number becomes another.
  void number(std::string& text, size_t at) {
    static const char* const kValues[] = {"0",      "-1",       "nan", "1e300",
                                          "1e-300", "99999999", "x",   "180"};
    const size_t begin = text.find_first_of("0123456789", at);
    if (begin == std::string::npos) return;
    const size_t end = text.find_first_not_of("0123456789.eE+-", begin);
    text.replace(begin, end == std::string::npos ? end : end - begin, kValues[pick(8)]);
  }
  std::mt19937 random_;
};

std::vector<Sample> samples(const Anatomy& a) {
  const auto joints = testPerson(a);
  const std::string bvh = bvhText(
      joints, 3, [&](size_t j, size_t f) { return testTurn(joints[j].name, f / 3.0); },
      [](size_t) { return Eigen::Vector3d(0, 0, 1); });
  std::vector<Sample> out = {{"a.bvh", bvh}};
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(bvh.data(), bvh.size(), 0, "bvh");
  Assimp::Exporter exporter;
  const aiExportDataBlob* blob = exporter.ExportToBlob(scene, "glb2");
  if (blob) out.push_back({"a.glb", {static_cast<const char*>(blob->data), blob->size}});
  out.push_back({"a.fbx", fbxText()});
  return out;
}

// assimp 5.2 itself crashes or hangs on some files; that is not ours to mend.
bool assimpSurvives(const Sample& sample) {
  if (sample.path == "a.bvh") return true;
  const pid_t child = fork();
  if (child == 0) {
    alarm(10);
    close(1), close(2);
    Assimp::Importer importer;
    importer.SetPropertyBool("IMPORT_FBX_PRESERVE_PIVOTS", false);
    importer.ReadFileFromMemory(sample.content.data(), sample.content.size(), 0,
                                sample.path.c_str() + sample.path.rfind('.') + 1);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(ClipFuzz, NeverCrashes) {
  installHandlers();
  const Anatomy tables = Anatomy::load(TORSO_ANATOMY_DIR);
  const std::vector<Sample> originals = samples(tables);
  const auto start = std::chrono::steady_clock::now();
  const int seconds = environment("TORSO_FUZZ_SECONDS", 4);
  int solved = 0, refused = 0, excluded = 0;
  unsigned seed = static_cast<unsigned>(environment("TORSO_FUZZ_FIRST", 0));
  for (; std::chrono::steady_clock::now() - start < std::chrono::seconds(seconds); seed++) {
    SCOPED_TRACE(fmt::format("TORSO_FUZZ_FIRST={}", seed));
    // Every other case is a BVH, which is all ours.
    Sample sample = originals[seed % 2 ? 0 : (seed / 2) % originals.size()];
    sample.content = Mutator(seed).mutate(sample.content);
    if (!assimpSurvives(sample)) {
      excluded++;
      continue;
    }
    alarm(60);  // ends the test if the reader hangs
    try {
      for (const Clip& clip : parseClips(sample.content, sample.path)) {
        for (const Roles& roles : findRoles(clip, {})) {
          if (clip.frames() > 100) continue;  // a matter of time only
          const Performer p = measurePerformer(tables, clip, roles);
          const Targets targets = makeTargets(inWorld(clip, p), roles, p);
          const Retargeted r = solveMotion(targets, p, clip.name, clip.rate);
          for (const auto& position : r.motion.positions) {
            EXPECT_TRUE(std::isfinite(position[0] + position[1] + position[2]));
          }
        }
      }
      solved++;
    } catch (const Error& e) {
      refused++;
      if (std::getenv("TORSO_FUZZ_VERBOSE")) fmt::print("{}: {}\n", seed, e.what());
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(sample.path), std::string::npos) << e.what();
    }
    alarm(0);
    takeWarnings();
    if (HasFailure()) break;
  }
  fmt::print("{} solved, {} refused, {} on which assimp itself fails\n", solved, refused, excluded);
  EXPECT_GT(solved, 0);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace torso::tools
