// Poses of a target that one picture does not tell apart, and the rule by which one of them is believed.
//
// The camera moves, and its poses are known. In the base frame the true pose of a target that stands still is
// one and the same from everywhere, while the others seem to turn as the camera goes. So each hypothesis is
// fitted to all views along the camera's way, and the one that fits best is believed; unless none fits, and
// the target moves.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/core/estimate/views_along_the_way.hpp"

namespace fovea::estimate {

enum class Stillness : std::uint8_t {
  kUnknown,  // one pose fits all views, but they are from too few places to tell
  kStill,    // one pose fits views from different places
  kMoving,   // no pose fits them
};
inline constexpr int kNumStillness = 3;

// All misfits are squared distances in standard deviations [sigma^2].
struct ChoiceRule {
  double switch_margin;  // so much less misfit, and another hypothesis is believed
  double still_most;     // a target that stands still fits no worse than this, per entry of its views
  double still_credit;   // taken off the believed one's misfit before that is judged
  int views_to_tell;     // so many, from different places, before a target counts as one that stands still
  double give_up;        // so much more misfit than the best one's is no chance
};

// A `Hypothesis` has
//   kRule                 its ChoiceRule
//   still_misfit          of the pose that fits all views best
//   MisfitOfMotion()      how badly it explains a target that moves
//   IsSame(other)         whether two hypotheses are one
template <class Hypothesis, std::size_t kMostHypotheses, class View, std::size_t kMostViews>
struct HypothesisSet {
  static constexpr int kMost = static_cast<int>(kMostHypotheses);

  int count = 0;  // 0: nothing is known; more than 1: they are not told apart yet
  int believed = 0;
  Stillness stillness = Stillness::kUnknown;
  std::array<Hypothesis, kMostHypotheses> all;
  ViewsAlongTheWay<View, kMostViews> views;

  [[nodiscard]] const Hypothesis& best() const noexcept { return all[static_cast<std::size_t>(believed)]; }
  [[nodiscard]] Hypothesis& best() noexcept { return all[static_cast<std::size_t>(believed)]; }

  // Chooses by the misfits, which are those of `entries` entries of views in all. True when another
  // hypothesis is believed than before. Those without a chance are given up, and of two that have met the
  // worse one. At least one must be there. Real-time: yes.
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

  // Leaves `chosen` as the believed one, and of the others those that have a chance.
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
