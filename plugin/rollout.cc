// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// torso_rollout and the state vectors that it takes and gives.

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "plugin/last_error.h"
#include "plugin/mujoco_torso.h"

namespace torso::plugin {
namespace {

// Calls visit(array in d, entries, what it is) for the parts of a state vector, in their order.
template <typename Data, typename Visit>
void visitState(const mjModel* m, Data* d, int spec, const Visit& visit) {
  if (spec & TORSO_STATE_PHYSICS) {
    visit(&d->time, 1);
    visit(d->qpos, m->nq);
    visit(d->qvel, m->nv);
    visit(d->act, m->na);
  }
  if (spec & TORSO_STATE_USERDATA) visit(d->userdata, m->nuserdata);
  if (spec & TORSO_STATE_WARMSTART) visit(d->qacc_warmstart, m->nv);
}

int sizeOf(const mjModel* m, int spec) {
  int size = 0;
  if (spec & TORSO_STATE_PHYSICS) size += 1 + m->nq + m->nv + m->na;
  if (spec & TORSO_STATE_USERDATA) size += m->nuserdata;
  if (spec & TORSO_STATE_WARMSTART) size += m->nv;
  return size;
}

void get(const mjModel* m, const mjData* d, mjtNum* state, int spec) {
  visitState(m, d, spec, [&state](const mjtNum* part, int n) {
    mju_copy(state, part, n);
    state += n;
  });
}

void set(const mjModel* m, mjData* d, const mjtNum* state, int spec) {
  visitState(m, d, spec, [&state](mjtNum* part, int n) {
    mju_copy(part, state, n);
    state += n;
  });
}

// mj_resetData for all that mj_step depends on. That one also clears the whole buffer: 4 ms for the
// human, whose constraint tables are large, where a step takes less than 1 ms.
void reset(const mjModel* m, mjData* d) {
  d->pstack = 0;  // not so after an exception
  std::fill(std::begin(d->warning), std::end(d->warning), mjWarningStat{});
  d->time = 0;
  mju_copy(d->qpos, m->qpos0, m->nq);
  mju_zero(d->qvel, m->nv);
  mju_zero(d->act, m->na);
  mju_zero(d->act_dot, m->na);
  mju_zero(d->ctrl, m->nu);
  mju_zero(d->qfrc_applied, m->nv);
  mju_zero(d->xfrc_applied, 6 * m->nbody);
  mju_zero(d->qacc, m->nv);
  mju_zero(d->qacc_warmstart, m->nv);
  mju_zero(d->userdata, m->nuserdata);
  mju_zero(d->sensordata, m->nsensordata);
  for (int i = 0; i < m->nbody; i++) {
    const int mocap = m->body_mocapid[i];
    if (mocap < 0) continue;
    mju_copy3(d->mocap_pos + 3 * mocap, m->body_pos + 3 * i);
    mju_copy4(d->mocap_quat + 4 * mocap, m->body_quat + 4 * i);
  }
}

bool fail(const std::string& message) {
  last_error = message;
  return false;
}

bool checkSpec(int spec, const char* what) {
  if (spec > 0 && spec <= TORSO_STATE_FULL) return true;
  return fail(std::string(what) + " is " + std::to_string(spec) +
              ", it must be an or of TORSO_STATE_PHYSICS, _USERDATA and _WARMSTART");
}

bool checkState(const mjModel* m, const void* d, const void* state, int spec) {
  if (!m) return fail("the model is null");
  if (!d) return fail("the data are null");
  if (!state) return fail("the state is null");
  return checkSpec(spec, "spec");
}

bool checkRollout(const mjModel* m, mjData* const* d, int nthread, const torsoRollout* r) {
  if (!m) return fail("the model is null");
  if (!r) return fail("the rollout is null");
  if (r->ntrajectory < 0 || r->nstep < 0) {
    return fail("ntrajectory is " + std::to_string(r->ntrajectory) + " and nstep " +
                std::to_string(r->nstep) + ", neither may be negative");
  }
  if (nthread < 1) {
    return fail("nthread is " + std::to_string(nthread) + ", it must be at least 1");
  }
  if (!d) return fail("the data are null; give an array of nthread pointers");
  for (int t = 0; t < nthread; t++) {
    const std::string which = "data " + std::to_string(t);
    if (!d[t]) return fail(which + " is null; give one mjData for each of the threads");
    if (std::find(d, d + t, d[t]) != d + t) {
      return fail(which + " is given twice; each thread needs an mjData of its own");
    }
    if (d[t]->nstack != m->nstack) {
      return fail(which + " belongs to another model; make it with mj_makeData of this one");
    }
  }
  if (r->initial_state) {
    if (r->ninitial != 1 && r->ninitial != r->ntrajectory) {
      return fail("ninitial is " + std::to_string(r->ninitial) +
                  ", it must be 1 or ntrajectory, which is " + std::to_string(r->ntrajectory));
    }
    if (!checkSpec(r->initial_spec, "initial_spec")) return false;
  }
  if (r->state && !checkSpec(r->state_spec, "state_spec")) return false;
  if (r->cost && !r->step_cost) return fail("cost is wanted, but step_cost is null");
  char error[500];
  if (torso_info(m, nullptr, error, sizeof error) < 0) return fail(error);
  return true;
}

// As mju_isBad, for arrays: a call for each entry would show in the time of small models' steps.
bool anyBad(const mjtNum* x, int n) {
  bool bad = false;
  for (int i = 0; i < n; i++) bad |= !(x[i] <= mjMAXVAL && x[i] >= -mjMAXVAL);
  return bad;
}

// Row of an array that may be missing.
template <typename T>
T* row(T* array, std::size_t index, std::size_t width) {
  return array ? array + index * width : nullptr;
}

// What the threads share.
struct Batch {
  const mjModel* m;
  const torsoRollout& r;
  const int initial_size, state_size;
  std::atomic<int> next{0};    // trajectory that nobody has begun
  std::atomic<int> failed{0};  // trajectories that did not end as TORSO_OK

  Batch(const mjModel* model, const torsoRollout& rollout)
      : m(model),
        r(rollout),
        initial_size(sizeOf(m, r.initial_spec)),
        state_size(sizeOf(m, r.state_spec)) {}

  bool cancelled() const { return r.cancel && __atomic_load_n(r.cancel, __ATOMIC_RELAXED); }

  void start(mjData* d, int trajectory) const {
    reset(m, d);
    if (!r.initial_state) return;
    set(m, d, row(r.initial_state, r.ninitial == 1 ? 0 : trajectory, initial_size), r.initial_spec);
  }

  // One step and what is wanted of it, in row `at` of the results. Returns a torsoStatus; if it is
  // not TORSO_OK, nothing was written.
  int step(mjData* d, int trajectory, int k, std::size_t at, mjtNum* cost) const {
    if (r.control) mju_copy(d->ctrl, row(r.control, at, m->nu), m->nu);
    if (r.input) r.input(m, d, trajectory, k, r.user);
    mj_step(m, d);
    // MuJoCo has reset d if it warned of a bad number.
    for (int i = 0; i < mjNWARNING; i++) {
      if (d->warning[i].number) return TORSO_WARNING + i;
    }
    if (anyBad(d->qpos, m->nq) || anyBad(d->qvel, m->nv) || anyBad(d->act, m->na)) {
      return TORSO_NOT_FINITE;
    }
    if (r.step_cost) *cost += r.step_cost(m, d, trajectory, k, r.user);
    if (r.state) get(m, d, row(r.state, at, state_size), r.state_spec);
    if (r.sensordata)
      mju_copy(row(r.sensordata, at, m->nsensordata), d->sensordata, m->nsensordata);
    return TORSO_OK;
  }

  void run(mjData* d, int trajectory) {
    int status = TORSO_OK, k = 0;
    mjtNum cost = 0;
    try {
      start(d, trajectory);
      std::size_t at = static_cast<std::size_t>(trajectory) * r.nstep;
      for (; k < r.nstep; k++, at++) {
        status = cancelled() ? TORSO_CANCELLED : step(d, trajectory, k, at, &cost);
        if (status != TORSO_OK) break;
      }
    } catch (...) {
      status = TORSO_ERROR;
    }
    if (status == TORSO_OK && r.final_state) {
      get(m, d, row(r.final_state, trajectory, sizeOf(m, TORSO_STATE_FULL)), TORSO_STATE_FULL);
    }
    if (r.cost) r.cost[trajectory] = cost;
    if (r.status) r.status[trajectory] = status;
    if (r.steps) r.steps[trajectory] = k;
    if (status != TORSO_OK) failed++;
  }

  // One thread's work.
  void work(mjData* d) {
    for (int i = next++; i < r.ntrajectory; i = next++) run(d, i);
  }
};

}  // namespace
}  // namespace torso::plugin

using namespace torso::plugin;

int torso_stateSize(const mjModel* m, int spec) {
  if (!m) fail("the model is null");
  return m && checkSpec(spec, "spec") ? sizeOf(m, spec) : -1;
}

int torso_getState(const mjModel* m, const mjData* d, mjtNum* state, int spec) {
  if (!checkState(m, d, state, spec)) return -1;
  get(m, d, state, spec);
  return 0;
}

int torso_setState(const mjModel* m, mjData* d, const mjtNum* state, int spec) {
  if (!checkState(m, d, state, spec)) return -1;
  set(m, d, state, spec);
  return 0;
}

const char* torso_statusText(int status) {
  switch (status) {
    case TORSO_OK:
      return "done";
    case TORSO_CANCELLED:
      return "cancelled";
    case TORSO_NOT_FINITE:
      return "a step led to a state that is not finite";
    case TORSO_ERROR:
      return "a callback or MuJoCo's error handler threw an exception";
    case TORSO_WARNING + mjWARN_INERTIA:
      return "the inertia matrix is close to singular";
    case TORSO_WARNING + mjWARN_CONTACTFULL:
      return "the contact table is full; increase nconmax";
    case TORSO_WARNING + mjWARN_CNSTRFULL:
      return "the constraint table is full; increase njmax";
    case TORSO_WARNING + mjWARN_VGEOMFULL:
      return "the table of visual geoms is full";
    case TORSO_WARNING + mjWARN_BADQPOS:
      return "a number in qpos is not finite, or huge";
    case TORSO_WARNING + mjWARN_BADQVEL:
      return "a number in qvel is not finite, or huge";
    case TORSO_WARNING + mjWARN_BADQACC:
      return "a number in qacc is not finite, or huge";
    case TORSO_WARNING + mjWARN_BADCTRL:
      return "a number in ctrl is not finite, or huge";
    default:
      return "no torsoStatus";
  }
}

void torso_defaultRollout(torsoRollout* r) {
  *r = {};
  r->initial_spec = TORSO_STATE_FULL;
  r->state_spec = TORSO_STATE_PHYSICS;
}

int torso_rollout(const mjModel* m, mjData* const* d, int nthread, const torsoRollout* r) {
  if (!checkRollout(m, d, nthread, r)) return -1;
  Batch batch(m, *r);
  std::vector<std::thread> others;
  try {
    for (int t = 1; t < std::min(nthread, r->ntrajectory); t++) {
      others.emplace_back(&Batch::work, &batch, d[t]);
    }
  } catch (const std::exception&) {
    // No more threads or memory: those that there are do the work.
  }
  batch.work(d[0]);
  for (std::thread& thread : others) thread.join();
  return batch.failed;
}
