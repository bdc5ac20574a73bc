// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/edges.hpp"

#include <cmath>

namespace fovea::planning {
namespace {

constexpr double kLeastProgress = 0.05;  // as a share of a step

}  // namespace

bool IsEdgeFree(const PostureSpace& space, const model::VecN& from, const model::VecN& to,
                Work& work) noexcept {
  const double length = space.Distance(from, to);
  const int parts = 1 + static_cast<int>(length / kEdgeResolution);
  for (int k = parts; k > 0; --k) {
    if (!work.IsLeft() || !space.IsFree(from + static_cast<double>(k) / parts * (to - from), work)) {
      return false;
    }
  }
  return true;
}

Progress StepTowards(const PostureSpace& space, const model::VecN& from, const model::VecN& to, Work& work,
                     model::VecN& q) noexcept {
  const double left = space.Distance(from, to);
  if (left <= kStep) {
    q = to;
    return IsEdgeFree(space, from, to, work) ? Progress::kThere : Progress::kBarred;
  }
  q = space.range().Clamped(from + kStep / left * (to - from));
  Posture posture;
  if (!space.PullIntoView(q, work, posture) || !space.Judge(posture).is_free) {
    return Progress::kBarred;
  }
  const double done = space.Distance(from, q);
  const bool nearer = space.Distance(q, to) < left - kLeastProgress * kStep;
  if (!nearer || done > 2.0 * kStep) {
    return Progress::kBarred;
  }
  const int parts = 1 + static_cast<int>(done / kEdgeResolution);
  for (int k = 1; k < parts; ++k) {
    if (!space.IsFree(from + static_cast<double>(k) / parts * (q - from), work)) {
      return Progress::kBarred;
    }
  }
  return Progress::kNearer;
}

}  // namespace fovea::planning
