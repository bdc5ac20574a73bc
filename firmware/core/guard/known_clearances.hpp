// SPDX-License-Identifier: Apache-2.0
// What earlier proofs of a stop leave to the next: how far the arm may move from some postures.
//
// Obstacles, workspace and the arm's shape do not change while the servo runs. So the clearance that was
// found at a posture stays true, and no point of the arm loses more of it than the joints' way from there
// moves it (levers.hpp). The stop of this tick is nearly that of the tick before: most of its postures lie
// within the clearance of one that is known.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "firmware/core/barriers/levers.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::guard {

class KnownClearances {
 public:
  static constexpr std::size_t kMost = 8;  // a fast arm's stop needs three or four

  struct Posture {
    model::VecN q;            // [num_joints]
    double clearance = -1.0;  // of every bound from its margin [m]; negative: not known
  };

  // The levers of `config`'s arm, which is always the same. Real-time: yes.
  [[nodiscard]] const barriers::PerJoint& LeversOf(const config::ServoConfig& config) noexcept {
    if (!has_levers_) {
      levers_ = barriers::Levers(config.arm, config.guard.hand);
      has_levers_ = true;
    }
    return levers_;
  }

  // The posture that was added or covered another last.
  [[nodiscard]] const Posture& last() const noexcept { return postures_[last_]; }

  // True if all bounds are kept at `q`, because a known posture is near enough. Real-time: yes.
  [[nodiscard]] bool Cover(const model::VecN& q) noexcept {
    for (std::size_t tried = 0; tried < kMost; ++tried) {
      const std::size_t k = (last_ + tried) % kMost;
      const Posture& posture = postures_[k];
      if (posture.clearance > 0.0 && WayOfPoints(q, posture.q) <= posture.clearance) {
        last_ = k;
        return true;
      }
    }
    return false;
  }

  // Takes the place of the oldest. Real-time: yes.
  void Add(const model::VecN& q, double clearance) noexcept {
    postures_[next_] = {q, clearance};
    last_ = next_;
    next_ = (next_ + 1) % kMost;
  }

 private:
  // An upper bound of every point's distance between its places at the postures `a` and `b` [m].
  [[nodiscard]] double WayOfPoints(const model::VecN& a, const model::VecN& b) const noexcept {
    constexpr double kRounding = 1e-12;
    double way = kRounding;
    for (int i = 0; i < a.size(); ++i) {
      way += levers_[static_cast<std::size_t>(i)] * std::fabs(a[i] - b[i]);
    }
    return way;
  }

  std::array<Posture, kMost> postures_{};
  std::size_t last_ = 0;
  std::size_t next_ = 0;
  barriers::PerJoint levers_{};
  bool has_levers_ = false;
};

}  // namespace fovea::guard
