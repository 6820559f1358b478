// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_batch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "model/disc_elasticity.h"
#include "model/disc_group.h"

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

bool supported(const DiscKernels& kernels) {
  if (&kernels == &kDiscKernelsAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
  if (&kernels == &kDiscKernelsAvx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  }
  return true;
}

const DiscKernels* bestKernels() {
  __builtin_cpu_init();
  for (const DiscKernels* k : {&kDiscKernelsAvx512, &kDiscKernelsAvx2}) {
    if (supported(*k)) return k;
  }
  return &kDiscKernelsPortable;
}

std::atomic<const DiscKernels*>& kernelsInUse() {
  static std::atomic<const DiscKernels*> kernels{bestKernels()};
  return kernels;
}

// The state of a group: (6 + 3 nfree) x 8 doubles. The first six are the pose that the rest belongs
// to, as twice the offset and twice the `rotation` of HalfwayFrame; zero is rest.
constexpr int kPoseSize = 6;

// Where the endplates move by more than this share of the disc's height relative to each other, a
// full correction with the rest Hessian can overshoot and its length is chosen by the curvature.
constexpr double kLargeStrain = 0.2;

// The pose with a position no longer than `limit`: beyond it the disc's answer means nothing, but
// must stay finite.
DiscPose limited(const DiscPose& pose, double limit) {
  DiscPose result = pose;
  const double largest = pose.position.cwiseAbs().maxCoeff();
  if (largest > limit) result.position *= limit / largest;
  return result;
}

}  // namespace

struct DiscBatch::Impl {
  struct Group {
    std::vector<int> discs;  // (lane) disc index
    DiscGroup data;
    int state_offset;
  };
  struct DiscData {
    Disc disc;
    DiscElasticity elasticity;
    Vector3d normal;  // upperEndplateAreaVector
    int group, lane;
  };

  std::vector<DiscData> discs;
  std::vector<Group> groups;
  int state_size = 0;
  int largest_nnode = 0;
};

DiscBatch::DiscBatch(const std::vector<Disc>& discs) : impl_(std::make_unique<Impl>()) {
  for (size_t i = 0; i < discs.size(); ++i) {
    try {
      impl_->discs.push_back({discs[i], DiscElasticity(discs[i].mesh, discs[i].material),
                              upperEndplateAreaVector(discs[i].mesh), -1, 0});
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument("disc " + std::to_string(i) + ": " + e.what());
    }
  }
  const auto sameTopology = [](const DiscMesh& a, const DiscMesh& b) {
    return a.tets == b.tets && a.lower_nodes == b.lower_nodes && a.upper_nodes == b.upper_nodes &&
           a.rest_positions.size() == b.rest_positions.size();
  };
  std::vector<std::vector<int>> members;
  for (int i = 0; i < size(); ++i) {
    auto group = std::find_if(members.begin(), members.end(), [&](const std::vector<int>& m) {
      return m.size() < static_cast<size_t>(kLanes) && sameTopology(disc(m[0]).mesh, disc(i).mesh);
    });
    if (group == members.end()) group = members.insert(members.end(), std::vector<int>());
    impl_->discs[i].group = static_cast<int>(group - members.begin());
    impl_->discs[i].lane = static_cast<int>(group->size());
    group->push_back(i);
  }
  for (const auto& m : members) {
    std::vector<const DiscMesh*> meshes;
    std::vector<const DiscElasticity*> elasticities;
    for (int i : m) {
      meshes.push_back(&impl_->discs[i].disc.mesh);
      elasticities.push_back(&impl_->discs[i].elasticity);
    }
    impl_->groups.push_back({m, DiscGroup(meshes, elasticities), impl_->state_size});
    const DiscGroupView& view = impl_->groups.back().data.view();
    impl_->state_size += (kPoseSize + 3 * view.nfree) * kLanes;
    impl_->largest_nnode = std::max(impl_->largest_nnode, view.nnode);
  }
}

DiscBatch::~DiscBatch() = default;

int DiscBatch::size() const { return static_cast<int>(impl_->discs.size()); }
int DiscBatch::stateSize() const { return impl_->state_size; }

std::size_t DiscBatch::scratchSize() const {
  return 2 * sizeof(float) * 3 * kLanes * static_cast<std::size_t>(impl_->largest_nnode);
}

int DiscBatch::evaluate(const DiscPose* poses, const double* state_in, double* state_out,
                        DiscWrench* wrenches, void* scratch, const Options& options) const {
  const DiscKernels& kernels = *kernelsInUse().load(std::memory_order_relaxed);
  float* const u = static_cast<float*>(scratch);
  float* const f = u + 3 * kLanes * impl_->largest_nnode;
  int most_iterations = 0;
  for (const Impl::Group& group : impl_->groups) {
    const DiscGroupView& view = group.data.view();
    const double* const old_pose = state_in + group.state_offset;
    double* const new_pose = state_out + group.state_offset;

    // Poses to frame M, and the attached nodes with them.
    alignas(64) float pose_change[kPoseSize * kLanes] = {};
    alignas(64) float active[kLanes] = {};
    alignas(64) float largest[kLanes] = {};
    alignas(64) float threshold[kLanes] = {};
    alignas(64) float w[6 * kLanes], w_ends[6 * kLanes], w_response[6 * kLanes], change[kLanes];
    alignas(64) float work[kLanes], extra[kLanes], factor[kLanes];
    std::fill(u + 3 * kLanes * view.nfree, u + 3 * kLanes * view.nnode, 0.0f);
    bool deformed[kLanes] = {};
    const int nlane = static_cast<int>(group.discs.size());
    for (int lane = 0; lane < kLanes; ++lane) {
      if (lane >= nlane) {
        for (int k = 0; k < kPoseSize; ++k) new_pose[kLanes * k + lane] = 0;
        continue;
      }
      const Impl::DiscData& disc = impl_->discs[group.discs[lane]];
      const DiscPose pose = limited(poses[group.discs[lane]], view.limit[lane]);
      const HalfwayFrame frame(pose);
      for (int k = 0; k < kPoseSize; ++k) {
        const double value = 2 * (k < 3 ? frame.offset[k] : frame.rotation[k - 3]);
        pose_change[kLanes * k + lane] = static_cast<float>(value - old_pose[kLanes * k + lane]);
        new_pose[kLanes * k + lane] = value;
      }
      const double large = kLargeStrain / 2 * disc.elasticity.height;
      const Matrix3d up = frame.half - Matrix3d::Identity();
      for (int i = view.nfree; i < view.nnode; ++i) {
        const bool lower = i < view.nfree + view.nlower;
        const float* X = view.rest + 3 * kLanes * (i - view.nfree) + lane;
        const Vector3d rest(X[0], X[kLanes], X[2 * kLanes]);
        const Vector3d d =
            lower ? Vector3d(up.transpose() * rest - frame.offset) : up * rest + frame.offset;
        for (int k = 0; k < 3; ++k) u[kLanes * (3 * i + k) + lane] = static_cast<float>(d[k]);
        deformed[lane] |= d.squaredNorm() > large * large;
      }
      active[lane] = 1;
      largest[lane] = static_cast<float>(0.5 * disc.elasticity.height);
      threshold[lane] = static_cast<float>(options.tolerance * disc.elasticity.height);
    }

    kernels.predict(view, old_pose + kPoseSize * kLanes, pose_change, u);
    int iterations = 0;
    for (bool again = true; again; ++iterations) {
      kernels.forces(view, u, f);
      kernels.wrench(view, u, f, w_ends, w_response);
      kernels.solve(view, f, work, change);
      for (int lane = 0; lane < kLanes; ++lane) factor[lane] = active[lane];
      if (std::any_of(deformed, deformed + nlane, [](bool b) { return b; })) {
        std::fill(f + 3 * kLanes * view.nfree, f + 3 * kLanes * view.nnode, 0.0f);
        kernels.stiffening(view, u, f, extra);
        for (int lane = 0; lane < nlane; ++lane) {
          if (deformed[lane] && extra[lane] > 0)
            factor[lane] *= work[lane] / (work[lane] + extra[lane]);
        }
      }
      kernels.apply(view, factor, largest, f, u);
      again = false;
      for (int lane = 0; lane < nlane; ++lane) {
        if (active[lane] == 0) continue;
        for (int k = lane; k < 6 * kLanes; k += kLanes) {
          w[k] = w_ends[k] + factor[lane] * w_response[k];
        }
        if (change[lane] > threshold[lane] && iterations + 1 < options.max_iterations) {
          again = true;
        } else {
          active[lane] = 0;  // a disc's answer does not depend on its neighbours in the group
        }
      }
    }
    kernels.store(view, u, new_pose + kPoseSize * kLanes);
    most_iterations = std::max(most_iterations, iterations);

    for (int lane = 0; lane < nlane; ++lane) {
      const int i = group.discs[lane];
      Vector6d in_m;
      for (int k = 0; k < 6; ++k) in_m[k] = w[kLanes * k + lane];
      wrenches[i] =
          HalfwayFrame(limited(poses[i], view.limit[lane])).wrench(in_m, impl_->discs[i].normal);
    }
  }
  return most_iterations;
}

void DiscBatch::positions(int i, const DiscPose& pose, const double* state, double* xpos) const {
  const Impl::DiscData& disc = impl_->discs[i];
  const Impl::Group& group = impl_->groups[disc.group];
  const DiscGroupView& view = group.data.view();
  const double* u = state + group.state_offset + kPoseSize * kLanes + disc.lane;
  const HalfwayFrame frame(pose);
  const auto& rest = disc.disc.mesh.rest_positions;
  for (size_t node = 0; node < rest.size(); ++node) {
    const int n = group.data.number()[node];
    Vector3d x;
    if (n < view.nfree) {
      const Vector3d d(u[kLanes * 3 * n], u[kLanes * (3 * n + 1)], u[kLanes * (3 * n + 2)]);
      x = frame.half * (rest[node] + d) + frame.origin;
    } else if (n < view.nfree + view.nlower) {
      x = rest[node];
    } else {
      x = frame.full * rest[node] + pose.position;
    }
    for (int k = 0; k < 3; ++k) xpos[3 * node + k] = x[k];
  }
}

const Eigen::Matrix<double, 6, 6>& DiscBatch::restStiffness(int i) const {
  return impl_->discs[i].elasticity.rest_stiffness;
}

const DiscBatch::Disc& DiscBatch::disc(int i) const { return impl_->discs[i].disc; }

const char* DiscBatch::instructionSet() { return kernelsInUse().load()->name; }

bool DiscBatch::setInstructionSet(const std::string& name) {
  for (const DiscKernels* k : {&kDiscKernelsPortable, &kDiscKernelsAvx2, &kDiscKernelsAvx512}) {
    if (name == k->name && supported(*k)) {
      kernelsInUse() = k;
      return true;
    }
  }
  return false;
}

}  // namespace torso
