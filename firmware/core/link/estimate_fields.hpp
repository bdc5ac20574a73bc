// SPDX-License-Identifier: Apache-2.0
// The fields of the target's filters that a tick takes from the previous tick: part of state_fields.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>

#include "firmware/core/estimate/pose_hypotheses.hpp"
#include "firmware/core/link/fields.hpp"
#include "firmware/core/link/tick_fields.hpp"

namespace fovea::link {

// Entries of a size that is set at run time, up to the capacity.
template <class Archive, class Matrix>
void SizedEntries(Archive& a, Matrix& m) noexcept {
  auto rows = static_cast<std::int32_t>(m.rows());
  auto cols = static_cast<std::int32_t>(m.cols());
  a.Count(rows, Matrix::MaxRowsAtCompileTime);
  if constexpr (Matrix::ColsAtCompileTime == Eigen::Dynamic) {
    a.Count(cols, Matrix::MaxColsAtCompileTime);
  }
  if constexpr (!std::is_const_v<Matrix>) {
    m.resize(rows, cols);
  }
  Row(a, m.data(), static_cast<std::size_t>(m.size()));
}

// The first `count` of `values`; the others are never used.
template <class Array>
auto FirstOf(Array& values, int count) noexcept {
  const int size = static_cast<int>(values.size());
  return std::span(values).first(static_cast<std::size_t>(std::clamp(count, 0, size)));
}

template <class Archive, class T>
void TargetFilterFields(Archive& a, T& f) noexcept {
  a.Int(f.accepted);
  a.Int(f.rejected_in_row);
  a(f.stamp_ns);
  for (auto& x : f.x) {
    Entries(a, x);
  }
  for (auto& row : f.P) {
    for (auto& block : row) {
      Entries(a, block);
    }
  }
  a(f.late);
  a(f.P_late);
  for (auto& covariance : f.P_x_late) {
    Entries(a, covariance);
  }
}

template <class Archive, class T>
void DiscViewFields(Archive& a, T& view) noexcept {
  for (auto& normal : view.normal_B) {
    Entries(a, normal);
  }
  Entries(a, view.ray_B);
  a(view.weight);
}

template <class Archive, class T>
void PlateViewFields(Archive& a, T& view) noexcept {
  PoseFields(a, view.X_CB);
  SizedEntries(a, view.xy);
  a(view.variance);
  a.Int(view.frames);
  a(view.late);
  Entries(a, view.V_BC_C);
}

template <class Archive, class T>
void PlatePoseFields(Archive& a, T& pose) noexcept {
  a(pose.filter.stamp_ns);
  PoseFields(a, pose.filter.X_BO);
  Entries(a, pose.filter.v_BO_B);
  Entries(a, pose.filter.a_BO_B);
  Entries(a, pose.filter.w_BO_B);
  a(pose.filter.late);
  Entries(a, pose.filter.P);
  PoseFields(a, pose.X_BO_still);
  a(pose.motion_misfit);
  a(pose.still_misfit);
}

template <class Archive, class Set>
void HypothesisSetFields(Archive& a, Set& set) noexcept {
  a.Count(set.count, Set::kMost);
  a.Count(set.believed, Set::kMost - 1);
  a.Choice(set.stillness, estimate::kNumStillness);
  a.Count(set.views.count, decltype(set.views)::kMost);
  a(set.views.step);
}

template <class Archive, class T>
void PlateComparisonFields(Archive& a, T& c) noexcept {
  a(c.runs);
  a(c.ended);
  if (!c.runs) {
    return;
  }
  a.Count(c.pose, hal::kMaxPoses - 1);
  a.Count(c.next, decltype(estimate::PoseHypotheses::plate.views)::kMost + 1);
  estimate::PlateFit::Sums(c.fit, [&a](auto& sum) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(sum)>, bool>) {
      a(sum);
    } else {
      Entries(a, sum);
    }
  });
  PlateViewFields(a, c.newest);
  a(c.late_sigma);
}

// Without a disc's misfits to the still pose, which are computed before use.
template <class Archive, class T>
void PoseHypothesesFields(Archive& a, T& h) noexcept {
  HypothesisSetFields(a, h.disc);
  for (auto& view : FirstOf(h.disc.views.views, h.disc.views.count)) {
    DiscViewFields(a, view);
  }
  for (auto& normal : FirstOf(h.disc.all, h.disc.count)) {
    Entries(a, normal.normal_B);
  }
  HypothesisSetFields(a, h.plate);
  for (auto& view : FirstOf(h.plate.views.views, h.plate.views.count)) {
    PlateViewFields(a, view);
  }
  for (auto& pose : FirstOf(h.plate.all, h.plate.count)) {
    PlatePoseFields(a, pose);
  }
  PlateViewFields(a, h.plate_mean);
  PlateComparisonFields(a, h.comparison);
  a(h.slipped);
  a.Int(h.accepted);
  a.Int(h.rejected_in_row);
  a(h.stamp_ns);
}

}  // namespace fovea::link
