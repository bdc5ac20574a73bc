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
#include <cstdint>

#include "firmware/core/barriers/levers.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::guard {

// An upper bound of every point's distance between its places at the postures `a` and `b` [m]. Real-time:
// yes.
[[nodiscard]] inline double WayOfPoints(const barriers::PerJoint& levers, const model::VecN& a,
                                        const model::VecN& b) noexcept {
  constexpr double kRounding = 1e-12;  // [m]
  double way = kRounding;
  for (int i = 0; i < a.size(); ++i) {
    way += levers[static_cast<std::size_t>(i)] * std::fabs(a[i] - b[i]);
  }
  return way;
}

class KnownClearances {
 public:
  static constexpr int kMost = 8;  // a fast arm's stop needs three or four

  struct Posture {
    model::VecN q;            // [num_joints]
    double clearance = -1.0;  // of every bound from its margin [m]; negative: not known
  };

  // The posture that covered the last one asked for.
  [[nodiscard]] const Posture& last() const noexcept { return postures_[last_]; }

  // True if all bounds are kept at `q`, because a known posture is near enough. Real-time: yes.
  [[nodiscard]] bool Cover(const barriers::PerJoint& levers, const model::VecN& q) noexcept {
    for (std::size_t tried = 0; tried < postures_.size(); ++tried) {
      const std::size_t k = (last_ + tried) % postures_.size();
      const Posture& posture = postures_[k];
      if (posture.clearance > 0.0 && WayOfPoints(levers, q, posture.q) <= posture.clearance) {
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
    next_ = (next_ + 1) % postures_.size();
  }

 private:
  std::array<Posture, kMost> postures_{};
  std::size_t last_ = 0;
  std::size_t next_ = 0;
};

}  // namespace fovea::guard
