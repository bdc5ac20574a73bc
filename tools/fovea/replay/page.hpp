// SPDX-License-Identifier: Apache-2.0
// fovea replay --set: an HTML page that compares the recording with the replay.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/recording/flight/replay.hpp"
#include "firmware/host/report/envelope.hpp"
#include "fovea/tick.pb.h"

namespace fovea {

class ReplayPage {
 public:
  // Adds one tick. ReplayOptions::on_tick provides both.
  void Add(const log::Tick& recorded, const log::Tick& replayed);

  // The complete file. `log`: its path; `settings`: the assignments of --set. std::runtime_error when a part
  // of the page is missing.
  [[nodiscard]] std::string Make(const std::string& log, const std::vector<std::string>& settings,
                                 const flight::ReplayResult& result) const;

 private:
  struct Mode {
    double t_s = 0.0;
    std::string name;
  };
  struct Side {
    report::Envelope lines{0, 0};
    std::vector<Mode> modes;
  };
  void Add(const log::Tick& tick, double t_s, Side& side) const;

  std::int64_t start_ns_ = 0;
  std::size_t joints_ = 0;  // 0: no tick yet
  Side recorded_;
  Side replayed_;
};

}  // namespace fovea
