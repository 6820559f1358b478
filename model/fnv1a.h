// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace torso {

// 64-bit FNV-1a (Fowler, Noll, Vo), fed piece by piece. Tells data apart that differ by chance, not
// by intent; the same on every machine of the same byte order.
class Fnv1a {
 public:
  void add(const void* data, std::size_t size) {  // size in bytes
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; i++) value_ = (value_ ^ bytes[i]) * 0x100000001b3;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace torso
