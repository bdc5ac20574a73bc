// SPDX-License-Identifier: Apache-2.0
// The live page of a simulated scenario. It outlives a reset: the viewers stay connected while the run begins
// anew.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "firmware/host/live/live_feed.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/log_tap.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {

class LivePage {
 public:
  // Begins to listen. `config`: without page and report. Throws like live::Server.
  LivePage(live::ServerConfig config, const RunDescription& about);

  [[nodiscard]] live::Server& server() { return *server_; }
  // For the log of the run, which feeds the page.
  [[nodiscard]] log::LogTap tap() { return std::bind_front(&live::LiveFeed::Take, feed_.get()); }
  // How the last run ended.
  void SetResets(bool resets) { resets_ = resets; }
  [[nodiscard]] bool resets() const { return resets_; }
  // Where the log of the present run is written, for the report of the run so far; empty: nowhere.
  void ShowLog(const std::filesystem::path& log);

 private:
  [[nodiscard]] std::string Report();

  bool resets_ = false;
  std::mutex mutex_;
  std::filesystem::path log_;
  std::unique_ptr<live::Server> server_;
  std::unique_ptr<live::LiveFeed> feed_;
};

}  // namespace fovea::sim
