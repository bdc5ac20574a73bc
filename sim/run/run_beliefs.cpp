// SPDX-License-Identifier: Apache-2.0
#include "sim/run/run_beliefs.hpp"

namespace fovea::sim {

RunBeliefs::RunBeliefs(const RunDescription& about, bool is_shown, bool waits) {
  const Scenario& s = about.scenario;
  if (!s.camera.enabled) {
    return;
  }
  const config::LearntQuantities learnt = config::LearntOf(s.servo);
  const beliefs::Configured configured{s.camera.latency_ms, config::MakeLoad(s.arm.load)};
  const beliefs::FinderConfig finder{{learnt.latency, learnt.payload}, is_shown, waits};
  finder_.emplace(about.servo, configured, finder);
}

void RunBeliefs::Add(const hal::TickRecord& record) {
  if (finder_) {
    finder_->Add(record);
  }
}

void RunBeliefs::Act() {
  if (finder_) {
    finder_->Act();
  }
}

void RunBeliefs::UseLoop(task::ServoLoop* loop) {
  if (finder_) {
    finder_->UseLoop(loop);
  }
}

std::optional<beliefs::Findings> RunBeliefs::Finish() {
  return finder_ ? std::optional(finder_->Finish()) : std::nullopt;
}

}  // namespace fovea::sim
