// SPDX-License-Identifier: Apache-2.0
// Poses of a target that one picture cannot tell apart, and the rule that selects the believed one.
//
// The camera moves, and its poses are known. In the base frame the true pose of a target at rest is the same
// in all views; the others seem to turn as the camera moves. Each hypothesis is fitted to all views along the
// camera's path, and the best fit is believed. If none fits, the target moves.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/core/estimate/views_along_the_way.hpp"

namespace fovea::estimate {

enum class Stillness : std::uint8_t {
  kUnknown,  // one pose fits all views, but they come from too few places
  kStill,    // one pose fits views from different places
  kMoving,   // no pose fits them
};
inline constexpr int kNumStillness = 3;

// All misfits are squared distances in standard deviations [sigma^2].
struct ChoiceRule {
  double switch_margin;  // another hypothesis is believed if its misfit is smaller by this
  double still_most;     // largest misfit of a target at rest, per entry of its views
  double still_credit;   // subtracted from the believed one's misfit before that test
  int views_to_tell;     // views from different places before a target counts as at rest
  double give_up;        // a hypothesis whose misfit exceeds the best one's by this is dropped
};

// A `Hypothesis` has
//   kRule                 its ChoiceRule
//   still_misfit          of the pose that fits all views best
//   MisfitOfMotion()      its misfit for a target that moves
//   IsSame(other)         whether two hypotheses are the same
template <class Hypothesis, std::size_t kMostHypotheses, class View, std::size_t kMostViews>
struct HypothesisSet {
  static constexpr int kMost = static_cast<int>(kMostHypotheses);

  int count = 0;  // 0: nothing is known; more than 1: not yet told apart
  int believed = 0;
  Stillness stillness = Stillness::kUnknown;
  std::array<Hypothesis, kMostHypotheses> all;
  ViewsAlongTheWay<View, kMostViews> views;

  [[nodiscard]] const Hypothesis& best() const noexcept { return all[static_cast<std::size_t>(believed)]; }
  [[nodiscard]] Hypothesis& best() noexcept { return all[static_cast<std::size_t>(believed)]; }

  // Selects a hypothesis by the misfits, which are sums over `entries` entries of views. True if another one
  // is believed than before. Drops hypotheses with a too large misfit, and the worse one of two that have
  // become the same. At least one must exist. Real-time: yes.
  [[nodiscard]] bool Choose(double entries) noexcept {
    stillness = Judge(entries);
    const std::size_t before = static_cast<std::size_t>(believed);
    const std::size_t best = BestFit();
    const bool changed = MisfitOf(before) > MisfitOf(best) + Hypothesis::kRule.switch_margin;
    GiveUp(best, changed ? best : before);
    return changed;
  }

 private:
  [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(count); }

  [[nodiscard]] Stillness Judge(double entries) const noexcept {
    constexpr const ChoiceRule& kRule = Hypothesis::kRule;
    const auto misfit = [&](std::size_t i) {
      const bool has_credit = i == static_cast<std::size_t>(believed);
      return all[i].still_misfit - (has_credit ? kRule.still_credit : 0.0);
    };
    double least = misfit(0);
    for (std::size_t i = 1; i < size(); ++i) {
      least = std::min(least, misfit(i));
    }
    if (!(least <= kRule.still_most * entries)) {
      return Stillness::kMoving;
    }
    return views.count >= kRule.views_to_tell ? Stillness::kStill : Stillness::kUnknown;
  }

  [[nodiscard]] double MisfitOf(std::size_t i) const noexcept {
    return stillness == Stillness::kMoving ? all[i].MisfitOfMotion() : all[i].still_misfit;
  }

  [[nodiscard]] std::size_t BestFit() const noexcept {
    std::size_t best = 0;
    for (std::size_t i = 1; i < size(); ++i) {
      best = MisfitOf(i) < MisfitOf(best) ? i : best;
    }
    return best;
  }

  // Keeps `chosen` as the believed one, and the others that are not to be dropped.
  void GiveUp(std::size_t best, std::size_t chosen) noexcept {
    std::array<bool, kMostHypotheses> stays{};
    for (std::size_t i = 0; i < size(); ++i) {
      stays[i] = i == chosen || MisfitOf(i) <= MisfitOf(best) + Hypothesis::kRule.give_up;
    }
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < size(); ++j) {
        const bool better = j == chosen || (i != chosen && MisfitOf(j) < MisfitOf(i));
        if (i != j && stays[i] && stays[j] && better && all[i].IsSame(all[j])) {
          stays[i] = false;
        }
      }
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (!stays[i]) {
        continue;
      }
      if (i == chosen) {
        believed = static_cast<int>(kept);
      }
      if (kept != i) {
        all[kept] = all[i];
      }
      ++kept;
    }
    count = static_cast<int>(kept);
  }
};

}  // namespace fovea::estimate
