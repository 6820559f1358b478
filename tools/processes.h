// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace torso::tools {

// The processes of this job, on one machine or several, if mpirun has started it; else this process
// alone. All of them call the same functions in the same order.
class Processes {
 public:
  // Throws Error if mpirun has started several, but this build has no MPI.
  Processes();

  int rank() const { return rank_; }  // 0 .. size - 1
  int size() const { return size_; }

  // On process 0 the texts of all, in the order of their ranks; on the others nothing. Throws Error
  // if a text is too long (2 GB).
  std::vector<std::string> gather(const std::string& text) const;
  // Process 0's text, on all.
  std::string broadcast(const std::string& text) const;
  // The last call, if all goes well. If a process ends without it, mpirun ends the others: that is
  // why no destructor does it.
  void leave() const;

 private:
  int rank_ = 0, size_ = 1;
  void* library_ = nullptr;  // libtorso_mpi.so, null: not under mpirun
};

}  // namespace torso::tools
