// fovea replay --set: what was recorded and what would have been, as a page to look at.
#pragma once

#include <string>
#include <vector>

#include "firmware/host/recording/flight/replay.hpp"
#include "firmware/host/report/envelope.hpp"
#include "fovea/tick.pb.h"

namespace fovea {

class ReplayPage {
 public:
  // Takes both from ReplayOptions::on_tick.
  void Add(const log::Tick& recorded, const log::Tick& replayed);

  // The whole file. `log`: its path; `settings`: what was set. std::runtime_error: a part of the page is not
  // there.
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
