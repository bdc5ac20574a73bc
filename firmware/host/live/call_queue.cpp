// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/live/call_queue.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace fovea::live {
namespace {

bool IsUrgent(const Request& request) {
  return std::holds_alternative<Hold>(request) || std::holds_alternative<ControlEnded>(request);
}

}  // namespace

bool CallQueue::Add(PendingCall pending) {
  {
    const std::lock_guard lock(mutex_);
    const bool is_drag = std::holds_alternative<HoldTarget>(pending.call.request);
    if (is_drag && !calls_.empty() && calls_.back().from.viewer == pending.from.viewer &&
        std::holds_alternative<HoldTarget>(calls_.back().call.request)) {
      calls_.back() = std::move(pending);
      return true;
    }
    const bool has_same = std::any_of(calls_.begin(), calls_.end(), [&](const PendingCall& waiting) {
      return waiting.from.viewer == pending.from.viewer &&
             waiting.call.request.index() == pending.call.request.index();
    });
    if (calls_.size() >= most_ && (has_same || !IsUrgent(pending.call.request))) {
      return false;
    }
    calls_.push_back(std::move(pending));
  }
  added_.notify_one();
  return true;
}

std::deque<PendingCall> CallQueue::TakeAll() {
  const std::lock_guard lock(mutex_);
  return std::exchange(calls_, {});
}

bool CallQueue::WaitForOne(std::chrono::milliseconds at_most) {
  std::unique_lock lock(mutex_);
  return added_.wait_for(lock, at_most, [this] { return !calls_.empty(); });
}

void CallQueue::AddAnswer(AnsweredCall answered) {
  const std::lock_guard lock(mutex_);
  answers_.push_back(std::move(answered));
}

std::vector<AnsweredCall> CallQueue::TakeAnswers() {
  const std::lock_guard lock(mutex_);
  return std::exchange(answers_, {});
}

}  // namespace fovea::live
