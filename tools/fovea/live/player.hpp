// SPDX-License-Identifier: Apache-2.0
// Plays the messages of a log to the viewers of a live page, at the pace that they choose.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "firmware/host/desk/wall_pace.hpp"
#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/mcap_reader.hpp"

namespace fovea {

class LogPlayer {
 public:
  // Borrows server and feed.
  LogPlayer(live::Server& server, live::LiveFeed& feed, double speed)
      : server_(server), feed_(feed), pace_(speed) {}

  // Plays the log from its start, and again after each reset, until a viewer or `interrupted` ends it. At the
  // log's end it waits. Then shows that it has ended. std::runtime_error: the log cannot be read.
  void Play(const std::filesystem::path& log, const std::function<bool()>& interrupted);

 private:
  enum class Next { kGoOn, kAgain, kEnd };

  void PlayOnce(const std::filesystem::path& log, const std::function<bool()>& interrupted);
  // Waits until the message at `stamp_ns` is due, and handles calls meanwhile.
  void WaitFor(std::int64_t stamp_ns, const std::function<bool()>& interrupted);
  void WaitAtTheEnd(const std::function<bool()>& interrupted);
  void TakeCalls();
  void Look(const log::McapMessage& message);
  void ShowState();

  live::Server& server_;
  live::LiveFeed& feed_;
  desk::WallPace pace_;
  Next next_ = Next::kGoOn;
  bool at_the_end_ = false;
  std::int64_t begin_ns_ = -1;  // stamp of the first tick
  std::int64_t now_ns_ = 0;
  std::int64_t next_state_ns_ = 0;  // by the wall clock
  live::State state_;
};

}  // namespace fovea
