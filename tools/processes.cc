// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/processes.h"

#include <dlfcn.h>

#include <climits>
#include <cstdlib>
#include <filesystem>

#include "tools/error.h"
#include "tools/mpi_module.h"
#include "tools/paths.h"

namespace torso::tools {
namespace {

// How many processes mpirun (OpenMPI's or another that speaks PMI) has started; 1 without it.
int startedByMpirun() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (const char* size = std::getenv(name)) return std::atoi(size);
  }
  return 1;
}

template <typename Function>
Function* function(void* library, const char* name) {
  auto* found = reinterpret_cast<Function*>(dlsym(library, name));
  if (!found) throw Error(std::string("libtorso_mpi.so: no ") + name + "; install the build again");
  return found;
}

#define TORSO_MPI(name) function<decltype(name)>(library_, #name)

}  // namespace

Processes::Processes() {
  if (startedByMpirun() < 2) return;
  const std::string path =
      (std::filesystem::path(pluginLibrary()).parent_path() / "libtorso_mpi.so").string();
  // Global, because MPI opens libraries of its own that look for MPI's symbols.
  library_ = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (!library_) {
    throw Error(path + ": mpirun has started several processes, but this build has no MPI (" +
                dlerror() + "); install libopenmpi-dev and build again");
  }
  TORSO_MPI(torso_mpiStart)(&rank_, &size_);
}

std::vector<std::string> Processes::gather(const std::string& text) const {
  if (text.size() > INT_MAX) throw Error("results beyond 2 GB; run fewer seeds");
  if (!library_) return {text};
  if (rank_ > 0) {
    TORSO_MPI(torso_mpiSend)(0, text.data(), static_cast<int>(text.size()));
    return {};
  }
  std::vector<std::string> texts = {text};
  for (int from = 1; from < size_; from++) {
    std::string incoming(TORSO_MPI(torso_mpiIncoming)(from), '\0');
    TORSO_MPI(torso_mpiReceive)(from, incoming.data(), static_cast<int>(incoming.size()));
    texts.push_back(incoming);
  }
  return texts;
}

std::string Processes::broadcast(const std::string& text) const {
  if (text.size() > INT_MAX) throw Error("results beyond 2 GB; run fewer seeds");
  if (!library_) return text;
  if (rank_ == 0) {
    for (int to = 1; to < size_; to++) {
      TORSO_MPI(torso_mpiSend)(to, text.data(), static_cast<int>(text.size()));
    }
    return text;
  }
  std::string incoming(TORSO_MPI(torso_mpiIncoming)(0), '\0');
  TORSO_MPI(torso_mpiReceive)(0, incoming.data(), static_cast<int>(incoming.size()));
  return incoming;
}

void Processes::leave() const {
  if (library_) TORSO_MPI(torso_mpiStop)();
}

}  // namespace torso::tools
