// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/live/player.hpp"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <variant>

#include "firmware/host/recording/log/topics.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/tick.pb.h"

namespace fovea {
namespace {

constexpr std::int64_t kStatePeriodNs = 50'000'000;
constexpr std::chrono::milliseconds kLongestWait{20};

// Ends the reading of a log from within its visitor.
struct Stopped {};

std::int64_t WallNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

void LogPlayer::Play(const std::filesystem::path& log, const std::function<bool()>& interrupted) {
  while (next_ != Next::kEnd && !interrupted()) {
    next_ = Next::kGoOn;
    PlayOnce(log, interrupted);
    if (next_ == Next::kGoOn) {
      WaitAtTheEnd(interrupted);
    }
  }
  state_.ends = true;
  next_state_ns_ = 0;
  ShowState();
}

void LogPlayer::PlayOnce(const std::filesystem::path& log, const std::function<bool()>& interrupted) {
  begin_ns_ = -1;
  at_the_end_ = false;
  pace_.Resume();
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& message) {
    if (message.topic == log::kTickTopic) {
      WaitFor(message.time_ns, interrupted);
      Look(message);
    }
    const auto* type = google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(
        std::string(message.schema));
    if (type != nullptr) {
      feed_.Take(message.topic, *type, message.time_ns, message.data);
    }
  };
  try {
    static_cast<void>(log::ReadMcap(log, visitor));
  } catch (const Stopped&) {
  }
}

void LogPlayer::WaitFor(std::int64_t stamp_ns, const std::function<bool()>& interrupted) {
  begin_ns_ = begin_ns_ < 0 ? stamp_ns : begin_ns_;
  while (true) {
    TakeCalls();
    if (next_ != Next::kGoOn || interrupted()) {
      throw Stopped{};
    }
    ShowState();
    const std::int64_t wall_ns = WallNs();
    const std::int64_t wait_ns = pace_.WaitNs(stamp_ns, wall_ns);
    if (wait_ns <= 0) {
      pace_.Begin(stamp_ns, wall_ns);
      now_ns_ = stamp_ns;
      return;
    }
    const auto wait =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::nanoseconds(wait_ns)) +
        std::chrono::milliseconds(1);
    static_cast<void>(server_.WaitForCalls(std::min(kLongestWait, wait)));
  }
}

void LogPlayer::WaitAtTheEnd(const std::function<bool()>& interrupted) {
  at_the_end_ = true;
  state_.notice = "this is the end of the log";
  while (next_ == Next::kGoOn && !interrupted()) {
    ShowState();
    static_cast<void>(server_.WaitForCalls(kLongestWait));
    TakeCalls();
  }
  state_.notice = "";
}

void LogPlayer::TakeCalls() {
  server_.TakeCalls([this](const live::Call& call) {
    if (const auto* pause = std::get_if<live::Pause>(&call.request)) {
      pause->paused ? pace_.Pause() : pace_.Resume();
    } else if (const auto* step = std::get_if<live::Step>(&call.request)) {
      if (!pace_.paused()) {
        return live::Answer{"the log is not paused", "{}"};
      }
      pace_.Step(step->ticks);
    } else if (const auto* speed = std::get_if<live::Speed>(&call.request)) {
      pace_.SetSpeed(speed->factor);
    } else if (std::holds_alternative<live::Reset>(call.request)) {
      next_ = Next::kAgain;
    } else if (std::holds_alternative<live::End>(call.request)) {
      next_ = Next::kEnd;
    }
    return live::Answer{};
  });
}

// The state of the servo in this tick.
void LogPlayer::Look(const log::McapMessage& message) {
  log::Tick tick;
  if (!tick.ParseFromArray(message.data.data(), static_cast<int>(message.data.size()))) {
    return;
  }
  const auto mode = static_cast<hal::Mode>(tick.mode());
  const auto reason = static_cast<hal::HoldReason>(tick.hold_reason());
  const auto fault = static_cast<hal::Fault>(tick.fault());
  const bool holds = reason != hal::HoldReason::kNone;
  const bool failed = fault != hal::Fault::kNone;
  state_.mode = hal::Name(mode);
  state_.hold_reason = holds ? hal::Name(reason) : "";
  state_.hold_reason_words = holds ? hal::Words(reason) : "";
  state_.fault = failed ? hal::Name(fault) : "";
  state_.fault_words = failed ? hal::Words(fault) : "";
}

void LogPlayer::ShowState() {
  const std::int64_t wall_ns = WallNs();
  if (wall_ns < next_state_ns_) {
    return;
  }
  next_state_ns_ = wall_ns + kStatePeriodNs;
  state_.stamp_s = begin_ns_ < 0 ? 0.0 : static_cast<double>(now_ns_ - begin_ns_) * 1e-9;
  state_.paused = pace_.paused() || at_the_end_;
  state_.speed = pace_.speed();
  state_.real_time_factor = at_the_end_ ? 0.0 : pace_.achieved();
  server_.SetState(state_);
}

}  // namespace fovea
