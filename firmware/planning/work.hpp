// SPDX-License-Identifier: Apache-2.0
// What a search may still spend, and its random numbers.
#pragma once

#include <cstdint>
#include <random>

#include "firmware/core/model/types.hpp"

namespace fovea::planning {

// Counts postures. A search that finds it used up ends.
class Work {
 public:
  explicit Work(std::int64_t budget) noexcept : left_(budget) {}
  void Spend() noexcept { --left_; }
  // A part of what is left, `most` at most. Join it when it is done.
  [[nodiscard]] Work Part(std::int64_t most) noexcept {
    const std::int64_t part = most < left_ ? most : left_;
    left_ -= part;
    return Work(part);
  }
  void Join(const Work& part) noexcept { left_ += part.left_; }
  [[nodiscard]] bool IsLeft() const noexcept { return left_ > 0; }
  [[nodiscard]] std::int64_t left() const noexcept { return left_; }

 private:
  std::int64_t left_;
};

// The same numbers for the same seed on every computer (std's distributions differ between libraries).
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}

  double Uniform(double low, double high) noexcept {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  // 0 ... size - 1.
  int Index(int size) noexcept { return static_cast<int>(Uniform(0.0, static_cast<double>(size))); }
  model::VecN Between(const model::VecN& low, const model::VecN& high) noexcept {
    model::VecN q(low.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      q[i] = Uniform(low[i], high[i]);
    }
    return q;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fovea::planning
