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

// The state of a group: (kHeader + 3 nfree) x 8 doubles. The first six are the pose that the rest
// belongs to, as twice the offset and twice the `rotation` of HalfwayFrame; then the wrench in
// frame M (6), the nucleus' pressure, and 1 if the shape had settled. Zeros are rest.
constexpr int kPoseSize = 6, kWrench = 6, kPressure = 12, kSettled = 13, kHeader = 14;

// Where the endplates move by more than this share of the disc's height relative to each other, a
// full correction can overshoot and is checked, as it is where it is not the last.
constexpr double kLargeStrain = 0.2;
// But for corrections that move no node by more than this share of the height: an overshoot of that
// size does no harm.
constexpr double kSmallChange = 4e-3;
// From this iteration on the present response of the nucleus is used, as it is where that at rest
// led uphill.
constexpr int kExactIteration = 4;
// A change of the pose in one evaluation that moves the endplates by more than this share of the
// height starts from rest: the last shape tells nothing.
constexpr double kTeleport = 0.5;
// Largest displacement that one correction may bring, as a share of the height.
constexpr double kLargestChange = 0.5;
// Corrections of the wrench below this share of what it takes to crush the disc (its bound
// stiffness times its height) are left: rounding errors.
constexpr double kSmallWrench = 1e-6;
// A correction below this share of the disc's height says that the shape has settled: it changes
// the wrench by less than 1e-5 of itself.
constexpr double kSettledChange = 1e-6;

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
  struct DiscData {
    Disc disc;
    DiscElasticity elasticity;
    Vector3d normal;  // upperEndplateAreaVector
    int group, lane;
  };
  struct Group {
    std::vector<int> discs;  // (lane) disc index
    DiscGroup data;
    int state_offset;
  };
  // What one evaluation of a group knows of its lanes.
  struct Lanes {
    alignas(64) float pose_change[kPoseSize * kLanes] = {};
    alignas(64) float keep[kLanes] = {};        // 0 where the last shape is of no use, else 1
    alignas(64) float wrench[6 * kLanes] = {};  // on the upper bone, frame M
    alignas(64) float pressure[kLanes] = {};    // of the nucleus
    alignas(64) float active[kLanes] = {};      // 1 while the lane iterates, else 0
    bool deformed[kLanes] = {};                 // the endplates have moved by kLargeStrain
    bool exact[kLanes] = {};                    // wants the present response of the nucleus
    bool check[kLanes] = {};                    // the last step may have gone too far
    bool settled[kLanes] = {};
  };
  // Arrays of one evaluation, see DiscKernels.
  struct Scratch {
    Scratch(void* memory, int nnode)
        : u(static_cast<float*>(memory)),
          f(u + 3 * kLanes * nnode),
          d(f + 3 * kLanes * nnode),
          w(d + 3 * kLanes * nnode),
          work(w + 3 * kLanes * nnode) {}
    float *u, *f, *d, *w, *work;
  };

  double height(const Group& group, int lane) const {
    return discs[group.discs[lane]].elasticity.height;
  }
  bool attach(const Group& group, const DiscPose* poses, const double* old_state, double* new_state,
              float* u, Lanes* lanes) const;
  void restartAfterTeleport(const Group& group, int lane, const double* new_state,
                            Lanes* lanes) const;
  bool wrongWrench(const Group& group, int lane, const float* wrench, const float* correction,
                   double tolerance) const;
  int iterate(const Group& group, const Options& options, const Scratch& s, Lanes* lanes) const;
  bool shorten(const Group& group, const Scratch& s, const float* before, Lanes* lanes,
               float* factor, float* pressure) const;
  const float* nucleusResponse(const Group& group, const Scratch& s, const Lanes& lanes,
                               int iterations) const;

  std::vector<DiscData> discs;
  std::vector<Group> groups;
  int state_size = 0;
  int largest_nnode = 0;
  std::size_t largest_work = 0;
};

// Brings the attached nodes to their bones in frame M, and the poses to the state. Returns false if
// no lane has anything to do.
bool DiscBatch::Impl::attach(const Group& group, const DiscPose* poses, const double* old_state,
                             double* new_state, float* u, Lanes* lanes) const {
  const DiscGroupView& view = group.data.view();
  std::fill(u + 3 * kLanes * view.nfree, u + 3 * kLanes * view.nnode, 0.0f);
  for (int k = 0; k < kHeader; ++k) {
    // Lanes without a disc stay at rest.
    std::fill(new_state + kLanes * k + group.discs.size(), new_state + kLanes * (k + 1), 0.0);
  }
  bool any_active = false;
  for (int lane = 0; lane < static_cast<int>(group.discs.size()); ++lane) {
    const HalfwayFrame frame(limited(poses[group.discs[lane]], view.limit[lane]));
    bool moved = false;
    for (int k = 0; k < kPoseSize; ++k) {
      const double value = 2 * (k < 3 ? frame.offset[k] : frame.rotation[k - 3]);
      const double change = value - old_state[kLanes * k + lane];
      moved |= change != 0;
      lanes->pose_change[kLanes * k + lane] = static_cast<float>(change);
      new_state[kLanes * k + lane] = value;
      lanes->wrench[kLanes * k + lane] =
          static_cast<float>(old_state[kLanes * (kWrench + k) + lane]);
    }
    lanes->pressure[lane] = static_cast<float>(old_state[kLanes * kPressure + lane]);
    lanes->settled[lane] = !moved && old_state[kLanes * kSettled + lane] != 0;
    lanes->active[lane] = lanes->settled[lane] ? 0 : 1;
    any_active |= !lanes->settled[lane];
    restartAfterTeleport(group, lane, new_state, lanes);
    const double large = kLargeStrain / 2 * height(group, lane);
    const Matrix3d turn = frame.half - Matrix3d::Identity();
    for (int i = view.nfree; i < view.nnode; ++i) {
      const float* X = view.rest + 3 * kLanes * i + lane;
      const Vector3d rest(X[0], X[kLanes], X[2 * kLanes]);
      Vector3d d;
      if (i < view.nfree + view.nlower) {
        d = turn.transpose() * rest - frame.offset;
      } else {
        d = turn * rest + frame.offset;
      }
      for (int k = 0; k < 3; ++k) u[kLanes * (3 * i + k) + lane] = static_cast<float>(d[k]);
      lanes->deformed[lane] |= d.squaredNorm() > large * large;
    }
  }
  return any_active;
}

// Where the pose has changed by too much since the last evaluation, the last shape counts as rest.
void DiscBatch::Impl::restartAfterTeleport(const Group& group, int lane, const double* new_state,
                                           Lanes* lanes) const {
  const DiscElasticity& elasticity = discs[group.discs[lane]].elasticity;
  double moved = 0;  // by the translation and at the disc's rim by the rotation
  for (int k = 0; k < kPoseSize; ++k) {
    const double change = std::abs(lanes->pose_change[kLanes * k + lane]);
    moved += k < 3 ? change : change * elasticity.size;
  }
  if (moved < kTeleport * elasticity.height) {
    lanes->keep[lane] = 1;
    return;
  }
  for (int k = 0; k < kPoseSize; ++k) {
    lanes->pose_change[kLanes * k + lane] = static_cast<float>(new_state[kLanes * k + lane]);
  }
}

// Where the forces after a step along d point back along it, the energy's minimum along d lies
// before its end: goes back to where a parabola has it; all the way where d leads uphill. before:
// work of the forces at the start along d. Lowers `factor`, the share of d that is kept, and brings
// forces and pressure up to date. Returns false if no lane needed it.
bool DiscBatch::Impl::shorten(const Group& group, const Scratch& s, const float* before,
                              Lanes* lanes, float* factor, float* pressure) const {
  constexpr float kOvershoot = 0.8f;  // force left, relative to that before, that is put up with
  const DiscKernels& kernels = *kernelsInUse().load(std::memory_order_relaxed);
  const DiscGroupView& view = group.data.view();
  alignas(64) float after[kLanes], back[kLanes] = {};
  kernels.slope(view, s.f, s.d, after);
  bool any = false;
  for (int lane = 0; lane < static_cast<int>(group.discs.size()); ++lane) {
    if (!lanes->check[lane]) continue;
    if (before[lane] > 0 && after[lane] >= -kOvershoot * before[lane]) continue;
    const float keep = before[lane] > 0 ? before[lane] / (before[lane] - after[lane]) : 0;
    lanes->exact[lane] |= keep == 0;
    back[lane] = (keep - 1) * factor[lane];
    factor[lane] *= keep;
    any = true;
  }
  if (!any) return false;
  kernels.apply(view, back, s.d, s.u);
  kernels.forces(view, s.u, s.f, pressure, s.work);
  return true;
}

// The nucleus' response to its pressure. That at rest serves, but for lanes in which it led uphill
// and where iterations go on.
const float* DiscBatch::Impl::nucleusResponse(const Group& group, const Scratch& s,
                                              const Lanes& lanes, int iterations) const {
  const DiscKernels& kernels = *kernelsInUse().load(std::memory_order_relaxed);
  const DiscGroupView& view = group.data.view();
  bool exact[kLanes] = {}, any = false;
  for (int lane = 0; lane < kLanes; ++lane) {
    exact[lane] = lanes.exact[lane] || iterations >= kExactIteration;
    any |= exact[lane] && lanes.active[lane] != 0;
  }
  if (!view.nucleus || !any) return view.nucleus_response;
  kernels.gradient(view, s.work, s.w);
  kernels.solve(view, s.w, s.w);
  for (int lane = 0; lane < kLanes; ++lane) {
    if (exact[lane]) continue;
    for (int i = lane; i < 3 * view.nfree * kLanes; i += kLanes) s.w[i] = view.nucleus_response[i];
  }
  return s.w;
}

// True if the correction is a larger share of the wrench than `tolerance`. Moments count by the
// forces at the disc's rim that make them.
bool DiscBatch::Impl::wrongWrench(const Group& group, int lane, const float* wrench,
                                  const float* correction, double tolerance) const {
  const DiscElasticity& elasticity = discs[group.discs[lane]].elasticity;
  double of_wrench = 0, of_correction = 0;
  for (int k = 0; k < 6; ++k) {
    const double arm = k < 3 ? 1 : elasticity.size;
    const double w = wrench[kLanes * k + lane] / arm, c = correction[kLanes * k + lane] / arm;
    of_wrench += w * w;
    of_correction += c * c;
  }
  const double crush = elasticity.bound_stiffness(2, 2) * elasticity.height;
  const double floor = kSmallWrench * crush;
  return of_correction > tolerance * tolerance * of_wrench + floor * floor;
}

// Iterates until no lane asks for more; returns the number of iterations. A lane that is done keeps
// its shape and wrench, so that a disc's answer does not depend on its neighbours in the group.
int DiscBatch::Impl::iterate(const Group& group, const Options& options, const Scratch& s,
                             Lanes* lanes) const {
  constexpr int kMostShortenings = 2;
  const DiscKernels& kernels = *kernelsInUse().load(std::memory_order_relaxed);
  const DiscGroupView& view = group.data.view();
  const int nlane = static_cast<int>(group.discs.size());
  alignas(64) float ends[6 * kLanes], correction[6 * kLanes];
  alignas(64) float pressure[kLanes], pressure_ahead[kLanes], pressure_change[kLanes];
  alignas(64) float work[kLanes], change[kLanes], factor[kLanes];
  kernels.forces(view, s.u, s.f, pressure, s.work);
  for (int iterations = 1;; ++iterations) {
    kernels.wrench(view, s.u, s.f, ends, correction);
    kernels.solve(view, s.f, s.d);
    kernels.nucleus(view, s.work, nucleusResponse(group, s, *lanes, iterations), s.d,
                    pressure_change, change);
    for (int i = 0; i < 6 * kLanes; ++i) {
      correction[i] += pressure_change[i % kLanes] * view.nucleus_wrench[i];
    }
    bool more[kLanes] = {}, again = false, check = false;
    for (int lane = 0; lane < kLanes; ++lane) {
      const double h = height(group, lane < nlane ? lane : 0);
      factor[lane] = lanes->active[lane];
      lanes->check[lane] = false;
      if (lanes->active[lane] == 0) continue;
      if (change[lane] > kLargestChange * h) {
        factor[lane] = static_cast<float>(kLargestChange * h / change[lane]);
      }
      more[lane] = change[lane] > options.tolerance * h ||
                   wrongWrench(group, lane, ends, correction, options.wrench_tolerance);
      again |= more[lane];
      lanes->check[lane] = (lanes->deformed[lane] || more[lane]) && change[lane] > kSmallChange * h;
      check |= lanes->check[lane];
    }
    again &= iterations < options.max_iterations;
    kernels.apply(view, factor, s.d, s.u);
    if (check || again) {
      kernels.slope(view, s.f, s.d, work);
      kernels.forces(view, s.u, s.f, pressure_ahead, s.work);
      for (int i = 0; check && i < kMostShortenings; ++i) {
        if (!shorten(group, s, work, lanes, factor, pressure_ahead)) break;
      }
    }
    for (int lane = 0; lane < nlane; ++lane) {
      if (lanes->active[lane] == 0) continue;
      for (int i = lane; i < 6 * kLanes; i += kLanes) {
        lanes->wrench[i] = ends[i] + factor[lane] * correction[i];
      }
      lanes->pressure[lane] = pressure[lane] + factor[lane] * pressure_change[lane];
      lanes->settled[lane] = change[lane] < kSettledChange * height(group, lane);
      if (!again || !more[lane]) lanes->active[lane] = 0;
    }
    if (!again) return iterations;
    std::copy(pressure_ahead, pressure_ahead + kLanes, pressure);
  }
}

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
    return a.tets == b.tets && a.cells == b.cells && a.lower_nodes == b.lower_nodes &&
           a.upper_nodes == b.upper_nodes && a.rest_positions.size() == b.rest_positions.size();
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
    impl_->groups.push_back(
        {m, DiscGroup(meshes, elasticities, *kernelsInUse().load()), impl_->state_size});
    const DiscGroupView& view = impl_->groups.back().data.view();
    impl_->state_size += (kHeader + 3 * view.nfree) * kLanes;
    impl_->largest_nnode = std::max(impl_->largest_nnode, view.nnode);
    impl_->largest_work = std::max(impl_->largest_work, impl_->groups.back().data.workSize());
  }
}

DiscBatch::~DiscBatch() = default;

int DiscBatch::size() const { return static_cast<int>(impl_->discs.size()); }
int DiscBatch::stateSize() const { return impl_->state_size; }

std::size_t DiscBatch::scratchSize() const {
  return sizeof(float) *
         (4 * 3 * kLanes * static_cast<std::size_t>(impl_->largest_nnode) + impl_->largest_work);
}

int DiscBatch::evaluate(const DiscPose* poses, const double* state_in, double* state_out,
                        DiscWrench* wrenches, void* scratch, const Options& options) const {
  const DiscKernels& kernels = *kernelsInUse().load(std::memory_order_relaxed);
  const Impl::Scratch arrays(scratch, impl_->largest_nnode);
  int most_iterations = 0;
  for (const Impl::Group& group : impl_->groups) {
    const DiscGroupView& view = group.data.view();
    const double* const old_state = state_in + group.state_offset;
    double* const new_state = state_out + group.state_offset;
    const int size = (kHeader + 3 * view.nfree) * kLanes;
    Impl::Lanes lanes;
    const bool active = impl_->attach(group, poses, old_state, new_state, arrays.u, &lanes);
    if (active) {
      kernels.predict(view, old_state + kHeader * kLanes, lanes.keep, lanes.pose_change, arrays.u);
      most_iterations = std::max(most_iterations, impl_->iterate(group, options, arrays, &lanes));
      kernels.store(view, arrays.u, new_state + kHeader * kLanes);
    } else if (new_state != old_state) {
      std::copy(old_state + kHeader * kLanes, old_state + size, new_state + kHeader * kLanes);
    }
    for (size_t lane = 0; lane < group.discs.size(); ++lane) {
      const int i = group.discs[lane];
      Vector6d in_m;
      for (int k = 0; k < 6; ++k) {
        in_m[k] = lanes.wrench[kLanes * k + lane];
        new_state[kLanes * (kWrench + k) + lane] = in_m[k];
      }
      new_state[kLanes * kPressure + lane] = lanes.pressure[lane];
      new_state[kLanes * kSettled + lane] = lanes.settled[lane] ? 1 : 0;
      wrenches[i] =
          HalfwayFrame(limited(poses[i], view.limit[lane])).wrench(in_m, impl_->discs[i].normal);
      wrenches[i].nucleus_pressure = lanes.pressure[lane];
    }
  }
  return most_iterations;
}

void DiscBatch::positions(int i, const DiscPose& pose, const double* state, double* xpos) const {
  const Impl::DiscData& disc = impl_->discs[i];
  const Impl::Group& group = impl_->groups[disc.group];
  const DiscGroupView& view = group.data.view();
  const double* u = state + group.state_offset + kHeader * kLanes + disc.lane;
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

const Eigen::Matrix<double, 6, 6>& DiscBatch::boundStiffness(int i) const {
  return impl_->discs[i].elasticity.bound_stiffness;
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
