// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "plugin/registry.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <random>

#include "model/fnv1a.h"
#include "plugin/note.h"

namespace torso::plugin {
namespace {

struct Entry {
  std::uint64_t hash;
  std::unique_ptr<Instance> instance;  // null if the data are damaged
  std::string fault;
};

// Notes are `first + index`, exact in a double. The base is drawn anew by each process and after
// each clear, so that a note that was saved with a model means nothing to the next reader.
constexpr int kMaxEntries = 4096;

struct Registry {
  std::mutex mutex;  // held to add an entry, never to find one
  std::array<std::atomic<Entry*>, kMaxEntries> entries = {};
  std::atomic<int> count{0};
  std::atomic<std::uint64_t> base{0};

  Registry() { renew(); }
  ~Registry() { clear(); }
  void renew() {
    std::random_device device;
    const std::uint64_t clock =
        static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
    base = ((device() ^ clock) & ((std::uint64_t{1} << 39) - 1)) * kMaxEntries + (1ull << 51);
  }
  void clear() {
    const int n = count.exchange(0);
    for (int i = 0; i < n; i++) delete entries[i].exchange(nullptr);
  }
};

Registry& registry() {
  static Registry instance;
  return instance;
}

// The note is read and written by any thread that meets the model first.
mjtNum* noteOf(const mjModel* m, int numeric) {
  return const_cast<mjtNum*>(m->numeric_data) + m->numeric_adr[numeric] + 1;
}
mjtNum loadNote(const mjModel* m, int numeric) {
  mjtNum value;
  __atomic_load(noteOf(m, numeric), &value, __ATOMIC_ACQUIRE);
  return value;
}

// Everything an Instance is made from.
std::uint64_t contentHash(const mjModel* m) {
  Fnv1a hash;
  const auto addInts = [&](const int* data, int n) { hash.add(data, sizeof(int) * n); };
  const auto addNums = [&](const mjtNum* data, int n) { hash.add(data, sizeof(mjtNum) * n); };
  const int sizes[] = {m->nbody,   m->ngeom,  m->nsite, m->neq,      m->ntendon,   m->nu,
                       m->nsensor, m->ntuple, m->ntext, m->nnumeric, m->nuserdata, m->nuser_sensor};
  addInts(sizes, sizeof sizes / sizeof sizes[0]);
  hash.add(m->names, m->nnames);
  hash.add(m->text_data, m->ntextdata);
  const int note = noteNumeric(m);
  const int note_adr = note < 0 ? -1 : m->numeric_adr[note] + 1;
  for (int i = 0; i < m->nnumericdata; i++) {
    if (i != note_adr) addNums(m->numeric_data + i, 1);
  }
  addInts(m->tuple_size, m->ntuple);
  addInts(m->tuple_objtype, m->ntupledata);
  addInts(m->tuple_objid, m->ntupledata);
  addNums(m->tuple_objprm, m->ntupledata);
  addNums(m->site_pos, 3 * m->nsite);
  addNums(m->site_quat, 4 * m->nsite);
  addInts(m->site_bodyid, m->nsite);
  addInts(m->geom_type, m->ngeom);
  addInts(m->geom_bodyid, m->ngeom);
  addInts(m->eq_type, m->neq);
  addInts(m->tendon_adr, m->ntendon);
  addInts(m->tendon_num, m->ntendon);
  addInts(m->wrap_objid, m->nwrap);
  addInts(m->actuator_trntype, m->nu);
  addInts(m->actuator_trnid, 2 * m->nu);
  addInts(m->sensor_type, m->nsensor);
  addInts(m->sensor_objtype, m->nsensor);
  addInts(m->sensor_objid, m->nsensor);
  addInts(m->sensor_dim, m->nsensor);
  addNums(m->sensor_user, m->nuser_sensor * m->nsensor);
  return hash.value();
}

const Entry* addEntry(const mjModel* m, int numeric) {
  Registry& r = registry();
  const std::lock_guard<std::mutex> lock(r.mutex);
  const std::uint64_t hash = contentHash(m);
  int index = 0;
  const int count = r.count.load();
  while (index < count && r.entries[index].load()->hash != hash) index++;
  if (index == count) {
    if (count == kMaxEntries) return nullptr;
    auto entry = std::make_unique<Entry>();
    entry->hash = hash;
    try {
      entry->instance = std::make_unique<Instance>(m);
    } catch (const std::exception& e) {
      entry->fault = e.what();
    }
    r.entries[index].store(entry.release());
    r.count.store(count + 1);
  }
  mjtNum note = static_cast<mjtNum>(r.base.load() + index);
  __atomic_store(noteOf(m, numeric), &note, __ATOMIC_RELEASE);
  return r.entries[index].load();
}

const Entry* findEntry(const mjModel* m) {
  const int numeric = noteNumeric(m);
  if (numeric < 0 || m->numeric_size[numeric] != kNoteSize) {
    // A note of another size cannot be written to; the Instance would refuse it anyway.
    static thread_local Entry misshapen{0, nullptr, ""};
    if (numeric < 0) return nullptr;
    misshapen.fault = "torso data, numeric '" + std::string(kNoteName) + "': it must hold " +
                      std::to_string(kNoteSize) + " numbers";
    return &misshapen;
  }
  Registry& r = registry();
  const mjtNum note = loadNote(m, numeric);
  const std::uint64_t base = r.base.load(std::memory_order_relaxed);
  const mjtNum index = note - static_cast<mjtNum>(base);
  if (index >= 0 && index < r.count.load(std::memory_order_acquire)) {
    return r.entries[static_cast<int>(index)].load(std::memory_order_acquire);
  }
  return addEntry(m, numeric);
}

}  // namespace

const Instance* findInstance(const mjModel* m) {
  const Entry* entry = findEntry(m);
  return entry ? entry->instance.get() : nullptr;
}

const char* instanceFault(const mjModel* m) {
  const Entry* entry = findEntry(m);
  return entry && !entry->instance ? entry->fault.c_str() : nullptr;
}

void clearInstances() {
  Registry& r = registry();
  const std::lock_guard<std::mutex> lock(r.mutex);
  r.clear();
  r.renew();
}

}  // namespace torso::plugin
