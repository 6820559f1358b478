// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/motion_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>

#include "model/parallel.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/forget_models.h"
#include "tools/graft_xml.h"
#include "tools/motion_file.h"
#include "tools/posture.h"
#include "tools/retrofit.h"
#include "tools/retrofit_readouts.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Vector3d;

struct ClipFiles {
  std::string name;
  double scale;  // of the performer's trunk to the tables'
};

// What one clip adds to SpineMotions.
struct Samples {
  std::vector<std::array<std::vector<double>, 3>> turns;
  std::vector<std::vector<double>> gaps;
};

// From the marks that retrofitBatch leaves.
std::vector<ClipFiles> doneClips(const std::string& folder) {
  std::vector<ClipFiles> clips;
  if (!fs::is_directory(folder)) throw Error(folder + ": no such folder");
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const auto mark = nlohmann::json::parse(readFile(entry.path().string()), nullptr, false);
    if (!mark.is_object() || !mark.contains("clips")) continue;
    for (const auto& clip : mark["clips"]) clips.push_back({clip["clip"], clip["torso_scale"]});
  }
  if (clips.empty()) {
    throw Error(folder +
                ": no clip in it that `torso retrofit` has done; give the folder that it "
                "wrote into");
  }
  std::sort(clips.begin(), clips.end(),
            [](const ClipFiles& a, const ClipFiles& b) { return a.name < b.name; });
  return clips;
}

// Poses of the disc's two frames, where the model's sites are.
class GapReader {
 public:
  GapReader(const mjModel* m, const Anatomy& anatomy, double scale) : scale_(scale) {
    for (const Disc& disc : anatomy.discs) {
      const int lower = mj_name2id(m, mjOBJ_SITE, (disc.name + "_lower").c_str());
      const int upper = mj_name2id(m, mjOBJ_SITE, (disc.name + "_upper").c_str());
      if (lower < 0 || upper < 0) throw Error("no disc " + disc.name + " in the model");
      sites_.push_back({lower, upper});
    }
  }
  // At the tables' size.
  double read(const mjData* d, const DiscGap& gap, std::size_t level) const {
    Isometry3d upper = pose(d, sites_[level][0]).inverse() * pose(d, sites_[level][1]);
    upper.translation() /= scale_;
    return gap.at(upper);
  }

 private:
  static Isometry3d pose(const mjData* d, int site) {
    Isometry3d X;
    X.linear() =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->site_xmat + 9 * site);
    X.translation() = Eigen::Map<const Vector3d>(d->site_xpos + 3 * site);
    return X;
  }
  double scale_;
  std::vector<std::array<int, 2>> sites_;
};

// every: gaps of each so many frames, the turns of all.
Samples sample(const mjModel* m, const Motion& motion, const Anatomy& anatomy,
               const std::vector<DiscGap>& gaps, double scale, int every) {
  const DataPtr d = makeData(m);
  const Posture posture(m);
  const GapReader reader(m, anatomy, scale);
  Samples samples;
  samples.turns.resize(gaps.size());
  samples.gaps.resize(gaps.size());
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    const auto turns = posture.turns(d.get());
    for (std::size_t level = 0; level < gaps.size(); level++) {
      const Vector3d turn = rotationVector(turns[level]);
      for (int k = 0; k < 3; k++) samples.turns[level][k].push_back(turn[k]);
      if (frame % every != 0) continue;
      samples.gaps[level].push_back(reader.read(d.get(), gaps[level], level));
    }
  }
  return samples;
}

// Where a motion has the bones that a retrofit holds, each `every`-th frame.
HeldMotion heldBones(const mjModel* m, const Motion& motion, const std::string& name, int every) {
  const DataPtr d = makeData(m);
  HeldMotion held;
  held.name = name;
  held.rate = motion.rate / every;
  held.bodies.assign(kHeldBones.begin(), kHeldBones.end());
  held.bodies.push_back("pelvis");
  std::vector<int> ids;
  for (const std::string& body : held.bodies) {
    ids.push_back(mj_name2id(m, mjOBJ_BODY, body.c_str()));
  }
  for (std::size_t frame = 0; frame < motion.frames(); frame += every) {
    mju_copy(d->qpos, motion.qpos.data() + frame * m->nq, m->nq);
    mj_kinematics(m, d.get());
    for (const int id : ids) {
      const mjtNum *p = d->xpos + 3 * id, *q = d->xquat + 4 * id;
      held.positions.push_back({p[0], p[1], p[2]});
      held.quaternions.push_back({q[0], q[1], q[2], q[3]});
    }
  }
  return held;
}

// The motion with parts left out: that in `path`, if it is of this motion, else solved anew.
// human: of the body.
Motion solveWithout(const SpineParts& parts, const BodyMjcf& body, const mjModel* human,
                    const Motion& motion, const std::string& motion_path, const std::string& path,
                    int every, const std::function<void(double)>& progress) {
  const HeldMotion held = heldBones(human, motion, path, every);
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  if (!error && time >= fs::last_write_time(motion_path)) {
    const Motion done = motionOf(human, readMotion(path), path);
    if (done.rate == held.rate && done.frames() == held.frames()) return done;
  }
  RetrofitOptions options;
  options.steps /= every;
  const RetrofitModels models(body, parts);
  const Motion solved = motionOf(models, retrofit(models, held, options, progress));
  writeFile(path, motionBinary(solved));
  return solved;
}

SpineMotions merge(const Anatomy& anatomy, const std::vector<DiscGap>& gaps,
                   const std::vector<Samples>& clips) {
  SpineMotions all;
  for (std::size_t level = 0; level < gaps.size(); level++) {
    std::array<std::vector<double>, 3> turns;
    std::vector<double> distances;
    for (const Samples& clip : clips) {
      if (clip.turns.empty()) continue;
      for (int k = 0; k < 3; k++) {
        turns[k].insert(turns[k].end(), clip.turns[level][k].begin(), clip.turns[level][k].end());
      }
      distances.insert(distances.end(), clip.gaps[level].begin(), clip.gaps[level].end());
    }
    if (turns[0].empty()) return {};
    all.turns.push_back(turns);
    all.spread.push_back(levelSpread(turns));
    all.gaps.push_back(gapStatistics(anatomy.discs[level].name,
                                     gaps[level].at(Isometry3d::Identity()), distances));
  }
  return all;
}

}  // namespace

MotionStatistics measureMotions(const Anatomy& anatomy, const Skeleton& skeleton,
                                const std::string& folder, const MotionStatisticsOptions& options,
                                const std::function<void(double)>& progress) {
  const std::vector<ClipFiles> clips = doneClips(folder);
  const std::vector<DiscGap> gaps = discGaps(anatomy, skeleton);
  struct Left {
    const char* folder;
    SpineParts parts;
  };
  std::array<Left, 2> kinds = {{{"/without_ligaments", {}}, {"/without_discs", {}}}};
  kinds[0].parts.ligaments = false;
  kinds[1].parts.discs = false;
  std::array<std::vector<Samples>, 3> samples;
  for (auto& of_kind : samples) of_kind.resize(clips.size());

  MotionStatistics result;
  std::mutex mutex;
  std::vector<double> shares(clips.size(), 0);
  const auto work = [&](int i) {
    const std::string path = folder + "/" + clips[i].name;
    const auto show = [&](double share) {
      const std::lock_guard<std::mutex> lock(mutex);
      shares[i] = share;
      double sum = 0;
      for (double s : shares) sum += s;
      progress(sum / static_cast<double>(shares.size()));
    };
    try {
      const BodyMjcf body(path + ".xml");
      const ModelPtr human = body.human();
      const Motion motion = motionOf(human.get(), readMotion(path + ".bin"), path + ".bin");
      std::array<Samples, 3> of_clip;
      of_clip[0] = sample(human.get(), motion, anatomy, gaps, clips[i].scale, options.every);
      for (std::size_t k = 0; k < kinds.size() && options.without; k++) {
        makeFolder(folder + kinds[k].folder);
        const Motion other = solveWithout(
            kinds[k].parts, body, human.get(), motion, path + ".bin",
            folder + kinds[k].folder + "/" + clips[i].name + ".bin", options.every,
            [&](double share) { show((static_cast<double>(k) + share) / kinds.size()); });
        of_clip[k + 1] = sample(human.get(), other, anatomy, gaps, clips[i].scale, 1);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      for (std::size_t k = 0; k < of_clip.size(); k++) samples[k][i] = std::move(of_clip[k]);
      result.seconds += static_cast<double>(motion.frames()) / motion.rate;
    } catch (const std::exception& e) {  // none of the others' business
      const std::lock_guard<std::mutex> lock(mutex);
      result.errors.push_back(e.what());
    }
    show(1);
  };
  // In rounds, as the plugin keeps something of each body.
  const int count = static_cast<int>(clips.size()), round = 8 * options.threads;
  for (int begin = 0; begin < count; begin += round) {
    forEach(std::min(round, count - begin), options.threads, [&](int i) { work(begin + i); });
    forgetModels();
  }
  for (std::size_t i = 0; i < clips.size(); i++) {
    if (!samples[0][i].turns.empty()) result.clips.push_back(clips[i].name);
  }
  result.whole = merge(anatomy, gaps, samples[0]);
  result.without_ligaments = merge(anatomy, gaps, samples[1]);
  result.without_discs = merge(anatomy, gaps, samples[2]);
  return result;
}

}  // namespace torso::tools
