// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace torso::tools {

// Counts of positive lengths between 0.1 um and 1 m in bins that are 0.4 % wide, for percentiles
// over more samples than one would keep. Counts only, so that the order of samples and of merges
// does not matter.
class LengthHistogram {
 public:
  // A length below the range counts in the first bin, one above in the last.
  void add(double length) {
    const double bin = kBinsPerLog * std::log(length / kSmallest);
    count_[bin > 0 ? (bin < kBins - 1 ? static_cast<int>(bin) : kBins - 1) : 0]++;
    total_++;
  }

  void merge(const LengthHistogram& other) {
    for (int i = 0; i < kBins; i++) count_[i] += other.count_[i];
    total_ += other.total_;
  }

  // Bins that are not empty, with their counts; and the same way back.
  std::vector<std::pair<int, std::int64_t>> bins() const {
    std::vector<std::pair<int, std::int64_t>> bins;
    for (int i = 0; i < kBins; i++) {
      if (count_[i]) bins.emplace_back(i, count_[i]);
    }
    return bins;
  }
  // False if there is no such bin.
  bool addBin(int bin, std::int64_t count) {
    if (bin < 0 || bin >= kBins || count < 0) return false;
    count_[bin] += count;
    total_ += count;
    return true;
  }

  // Upper edge of the bin that holds the p-quantile, 0 < p <= 1 [m]; 0 without samples.
  double quantile(double p) const {
    std::int64_t below = 0;
    for (int i = 0; i < kBins; i++) {
      below += count_[i];
      if (total_ > 0 && below >= p * total_) return kSmallest * std::exp((i + 1) / kBinsPerLog);
    }
    return 0;
  }

  std::int64_t total() const { return total_; }

 private:
  static constexpr int kBins = 4096;
  static constexpr double kSmallest = 1e-7;                   // [m]
  static constexpr double kBinsPerLog = kBins / 16.11809565;  // 7 decades: ln(1e7)

  std::array<std::int64_t, kBins> count_ = {};
  std::int64_t total_ = 0;
};

}  // namespace torso::tools
