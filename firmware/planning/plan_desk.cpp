// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/plan_desk.hpp"

#include <algorithm>
#include <chrono>

#include "firmware/core/trajectory/plan_request.hpp"

namespace fovea::planning {
namespace {

// The servo's thread must not wake another one: that would be a system call. So this one looks for requests.
constexpr std::chrono::milliseconds kLook{1};
// The modelled processor: 5 ms until it looks, 2.5 us for a posture (twice what a PC of 2023 needs).
constexpr std::int64_t kLookNs = 5'000'000;
constexpr std::int64_t kPostureNs = 2'500;

}  // namespace

std::int64_t PlanDesk::ModelledNs(std::int64_t work) noexcept { return kLookNs + work * kPostureNs; }

void PlanDesk::Begin() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Serve(stop); });
}

void PlanDesk::End() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void PlanDesk::Serve(const std::stop_token& stop) noexcept {
  hal::TickRecord record;
  while (!stop.stop_requested()) {
    if (box_.requests.Take(record)) {
      planner_.Compute(trajectory::RequestOf(record), plan_);
      box_.plans.Put(plan_);
    } else {
      std::this_thread::sleep_for(kLook);
    }
  }
}

void PlanDesk::Act(std::int64_t now_ns) noexcept {
  if (hal::TickRecord record; box_.requests.Take(record)) {
    planner_.Compute(trajectory::RequestOf(record), plan_);
    due_ns_ = std::max(now_ns, due_ns_.value_or(now_ns)) + ModelledNs(planner_.effort().work);
  }
  if (due_ns_ && now_ns >= *due_ns_) {
    box_.plans.Put(plan_);
    due_ns_.reset();
  }
}

}  // namespace fovea::planning
