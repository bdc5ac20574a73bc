// SPDX-License-Identifier: Apache-2.0
// What a run with a camera finds out of its servo's beliefs; without a camera, nothing.
#pragma once

#include <optional>

#include "firmware/host/beliefs/finder.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {

// The functions are those of beliefs::Finder.
class RunBeliefs {
 public:
  // `is_shown`: on a page, while the run goes on. `waits`: lockstep.
  RunBeliefs(const RunDescription& about, bool is_shown, bool waits);

  void Add(const hal::TickRecord& record);
  void Act();
  void UseLoop(task::ServoLoop* loop);
  [[nodiscard]] const beliefs::Findings* now() const { return finder_ ? finder_->now() : nullptr; }
  [[nodiscard]] std::optional<beliefs::Findings> Finish();

 private:
  std::optional<beliefs::Finder> finder_;
};

}  // namespace fovea::sim
