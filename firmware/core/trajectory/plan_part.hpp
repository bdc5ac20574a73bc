// SPDX-License-Identifier: Apache-2.0
// A plan in pieces: a tick takes one piece, so that no tick does much more work than the others, and a
// board's line carries the same frames whether a plan comes or not.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/trajectory/plan.hpp"

namespace fovea::trajectory {

struct PlanPart {
  static constexpr int kMostNumbers = 42;  // six control points of seven joints

  PlanHead head;            // in every part
  std::int32_t first = 0;   // place of the first number in Plan::points
  std::int32_t count = -1;  // of numbers; -1: there is no part
  std::array<double, kMostNumbers> numbers{};

  [[nodiscard]] bool IsThere() const noexcept { return count >= 0; }
};

// The part of `plan` that begins at number `first`. A plan without a motion has one part, without numbers.
// Real-time: yes.
[[nodiscard]] PlanPart PartOf(const Plan& plan, int first) noexcept;

// Takes a plan apart.
class PlanSender {
 public:
  // Its parts are next after Begin().
  [[nodiscard]] Plan& plan() noexcept { return plan_; }
  // Real-time: yes.
  void Begin() noexcept { next_ = 0; }
  void Begin(const Plan& plan) noexcept {
    plan_ = plan;
    Begin();
  }
  [[nodiscard]] bool IsDone() const noexcept { return next_ < 0; }
  // None if it is done. Real-time: yes.
  [[nodiscard]] PlanPart Next() noexcept {
    if (IsDone()) {
      return {};
    }
    PlanPart part = PartOf(plan_, next_);
    next_ += part.count;
    next_ = next_ < plan_.NumNumbers() ? next_ : -1;
    return part;
  }

 private:
  Plan plan_;
  std::int32_t next_ = -1;
};

// Puts a plan together again.
class PlanReceiver {
 public:
  // True if `part` completes a sound plan, which is then in plan(). What came before is kept if `part` does
  // not continue it, since a plan is sent again until all of it is there. The first part of a plan of another
  // time begins anew. A part that continues it but is not sound drops all of it. Real-time: yes.
  [[nodiscard]] bool Take(const PlanPart& part) noexcept;
  // All of a sound plan is there.
  [[nodiscard]] bool IsWhole() const noexcept {
    return received_ >= 0 && plan_.IsHeadSound() && received_ == plan_.NumNumbers();
  }
  // Whole only if IsWhole().
  [[nodiscard]] const Plan& plan() const noexcept { return plan_; }
  [[nodiscard]] int received() const noexcept { return received_; }  // numbers
  // For a state that is read back.
  void Restore(const Plan& plan, int received) noexcept {
    plan_ = plan;
    received_ = received;
  }

 private:
  Plan plan_;
  std::int32_t received_ = 0;
};

}  // namespace fovea::trajectory
