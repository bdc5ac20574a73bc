// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/live_session.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "firmware/host/desk/found.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"

namespace fovea::sim {
namespace {

constexpr std::int64_t kStatePeriodNs = 50'000'000;
constexpr std::chrono::milliseconds kLongestWait{5};

std::int64_t WallNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

LiveSession::LiveSession(LivePage& page, run::RunShell& shell, double speed)
    : page_(page), shell_(shell), speed_(speed) {
  page_.ShowLog(shell_.book()->log_path());
  shell_.OnRecord([this](const flight::FlightRecord& flown) {
    if (desk_) {
      desk_->Note(flown.record);
    }
  });
}

LiveSession::~LiveSession() {
  page_.ShowLog({});
  page_.SetResets(end_ == LiveEnd::kReset);
}

void LiveSession::Begin(DeskParts parts, Found found) {
  found_ = std::move(found);
  parts.reports.touch = [this](const std::string& what, const std::string& text) { Record(what, text); };
  parts.reports.parameter = [this](std::size_t parameter, double value) {
    page_.server().SetParameter(parameter, value);
  };
  desk_.emplace(parts, speed_);
  // Viewers may still know another run: its keys, and requests that came after its end.
  const std::vector<live::Parameter>& parameters = desk_->parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    page_.server().SetParameter(i, parameters[i].value);
  }
  page_.server().TakeCalls([](const live::Call&) -> live::Answer {
    return {"the run is only beginning: ask again", "{}"};
  });
}

void LiveSession::Record(const std::string& what, const std::string& text) {
  log::Touch touch;
  touch.set_stamp_ns(desk_->now_ns());
  touch.set_what(what);
  touch.set_text(text);
  shell_.book()->log().Add(log::kOperatorTopic, touch.stamp_ns(), touch);
}

bool LiveSession::WaitForTick(std::int64_t next_ns, const std::function<bool()>& interrupted) {
  live::Server& server = page_.server();
  while (true) {
    server.TakeCalls([this](const live::Call& call) { return desk_->Do(call); });
    end_ = desk_->end();
    const std::int64_t wall_ns = WallNs();
    const bool is_interrupted = interrupted();
    ShowState(wall_ns, is_interrupted);
    if (end_ != LiveEnd::kNone) {
      return false;
    }
    const std::int64_t wait_ns = desk_->pace().WaitNs(next_ns, wall_ns);
    if (wait_ns <= 0 || is_interrupted) {
      desk_->pace().Begin(next_ns, wall_ns);
      break;
    }
    const std::chrono::nanoseconds wait(wait_ns);
    if (wait < std::chrono::milliseconds(1)) {
      std::this_thread::sleep_for(wait);
    } else {
      static_cast<void>(server.WaitForCalls(
          std::min(kLongestWait, std::chrono::duration_cast<std::chrono::milliseconds>(wait))));
    }
  }
  desk_->Act();
  return true;
}

void LiveSession::ShowState(std::int64_t wall_ns, bool ends) {
  if (wall_ns < next_state_ns_ && end_ == LiveEnd::kNone && !ends) {
    return;
  }
  next_state_ns_ = wall_ns + kStatePeriodNs;
  live::State state = desk_->State();
  state.ends = state.ends || ends;
  desk::Fill(found_(), state);
  state.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  if (const auto ticks = shell_.NewTickDurations()) {
    state.tick = {ticks->median_ns, ticks->max_ns};
  }
  if (shell_.book()->log().failed()) {
    state.notice = "The log cannot be written, e.g. because the disk is full: it ends here.";
  }
  page_.server().SetState(state);
}

}  // namespace fovea::sim
