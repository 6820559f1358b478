// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// MuJoCo's global hooks: ours, and those that were there before and are called by ours.

#include <mujoco/mujoco.h>

#include <atomic>
#include <cstdio>
#include <mutex>

#include "plugin/facet_collider.h"
#include "plugin/mujoco_torso.h"
#include "plugin/passive.h"
#include "plugin/registry.h"
#include "plugin/sensor.h"

// MuJoCo's compiler sets this thread-local handler while it compiles a model; it is null otherwise.
extern "C" {
typedef void (*torso_ErrorHandler)(const char*);
torso_ErrorHandler _mjPRIVATE__get_tls_error_fn(void) __attribute__((weak));
}

namespace torso::plugin {
namespace {

std::mutex install_mutex;
mjfGeneric previous_passive = nullptr;
mjfSensor previous_sensor = nullptr;
mjfCollision previous_collision = nullptr;

// A damaged torso is refused: while MuJoCo compiles it, loading fails with our message; a model
// that comes from elsewhere (mjb, edited in memory) is left without discs, and says so once.
void refuse(const char* fault) {
  if (_mjPRIVATE__get_tls_error_fn && _mjPRIVATE__get_tls_error_fn()) {
    static thread_local char message[512];
    std::snprintf(message, sizeof message, "%s", fault);
    mju_error(message);  // long jump into the compiler; nothing here needs a destructor
  }
  static std::atomic<const char*> warned{nullptr};
  if (warned.exchange(fault) != fault) mju_warning(fault);
}

// Settings under which the plugin's rows or forces do not do what they should.
void checkOptions(const mjModel* m) {
  static std::atomic<int> warned{0};
  const auto once = [](int bit, const char* message) {
    if (!(warned.fetch_or(bit) & bit)) mju_warning(message);
  };
  if (m->opt.solver == mjSOL_PGS) {
    once(1, "torso: the PGS solver ignores the discs' implicit rows; use Newton or CG");
  }
  if (m->opt.noslip_iterations > 0) {
    once(2, "torso: noslip iterations ignore the discs' implicit rows; set noslip_iterations to 0");
  }
  if (m->opt.timestep > 0.01) {
    once(4,
         "torso: a timestep above 0.01 s is too long for the ligaments and facets; use 0.005 s "
         "or less");
  }
}

void passive(const mjModel* m, mjData* d) {
  if (previous_passive) previous_passive(m, d);
  const Instance* instance = findInstance(m);
  if (!instance) {
    if (const char* fault = instanceFault(m)) refuse(fault);
    return;
  }
  checkOptions(m);
  applyDiscs(m, d, *instance);
  rewriteWelds(m, d, *instance);
  rewriteLimits(m, d, *instance);
}

void sensor(const mjModel* m, mjData* d, int stage) {
  if (previous_sensor) previous_sensor(m, d, stage);
  if (const Instance* instance = findInstance(m)) fillSensors(m, d, *instance, stage);
}

int sphereEllipsoid(const mjModel* m, const mjData* d, mjContact* con, int g1, int g2,
                    mjtNum margin) {
  if (const Instance* instance = findInstance(m)) {
    const int facet = instance->facet_of_geom[g2];
    if (facet >= 0 && facet == instance->facet_of_geom[g1]) {
      return collideFacet(m, d, instance->facets[facet], con, g1);
    }
  }
  return previous_collision ? previous_collision(m, d, con, g1, g2, margin) : 0;
}

mjfCollision& collisionEntry() { return mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_ELLIPSOID]; }

// Loading the library installs it, unloading removes it.
__attribute__((constructor)) void load() { torso_install(); }
__attribute__((destructor)) void unload() { torso_uninstall(); }

}  // namespace
}  // namespace torso::plugin

using namespace torso::plugin;

void torso_install(void) {
  const std::lock_guard<std::mutex> lock(install_mutex);
  if (mjcb_passive != passive) {
    previous_passive = mjcb_passive;
    mjcb_passive = passive;
  }
  if (mjcb_sensor != sensor) {
    previous_sensor = mjcb_sensor;
    mjcb_sensor = sensor;
  }
  if (collisionEntry() != sphereEllipsoid) {
    previous_collision = collisionEntry();
    collisionEntry() = sphereEllipsoid;
  }
}

void torso_uninstall(void) {
  const std::lock_guard<std::mutex> lock(install_mutex);
  if (mjcb_passive == passive) mjcb_passive = previous_passive;
  if (mjcb_sensor == sensor) mjcb_sensor = previous_sensor;
  if (collisionEntry() == sphereEllipsoid) collisionEntry() = previous_collision;
  previous_passive = nullptr;
  previous_sensor = nullptr;
  previous_collision = nullptr;
  clearInstances();
}

int torso_isInstalled(void) {
  const std::lock_guard<std::mutex> lock(install_mutex);
  return mjcb_passive == passive && mjcb_sensor == sensor && collisionEntry() == sphereEllipsoid;
}
