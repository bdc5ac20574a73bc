// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/replay.hpp"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <stdexcept>

#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/message_difference.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "fovea/tick.pb.h"

namespace fovea::flight {
namespace {

class Replayer {
 public:
  explicit Replayer(const ReplayOptions& options) : options_(options) {}

  TickVisitor Visitor() {
    TickVisitor visitor;
    visitor.on_metadata = [this](const std::string& name, const std::map<std::string, std::string>& entries) {
      if (name == "build") {
        result_.same_build = Same("servo library", entries) && Same("link library", entries);
      }
    };
    visitor.on_configuration = [this](const log::ServoConfiguration& message) {
      config_ = FromMessage(message);
      if (options_.change) {
        changed_ = options_.change(*config_);
      }
    };
    visitor.on_keyframe = [this](const log::Keyframe& keyframe) {
      keyframes_.erase(keyframes_.begin(), keyframes_.lower_bound(next_tick_));
      keyframes_[keyframe.tick()] = keyframe;
    };
    visitor.on_tick = [this](const log::Tick& tick, const hal::FeatureMeasurement& feature) {
      Take(tick, feature);
    };
    return visitor;
  }

  ReplayResult Finish(const log::McapEnd& end) {
    if (!config_) {
      throw std::runtime_error("holds nothing to replay: it was written without the flight recorder");
    }
    result_.complete = end.complete;
    result_.why_incomplete = end.why;
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool Same(const char* name, const std::map<std::string, std::string>& recorded) const {
    const auto there = recorded.find(name);
    const auto here = options_.build.find(name);
    return there != recorded.end() && here != options_.build.end() && there->second == here->second;
  }

  void Take(const log::Tick& tick, const hal::FeatureMeasurement& feature) {
    if (!started_) {
      started_ = true;
      result_.start_ns = tick.stamp_ns();
    }
    if (!config_ || static_cast<double>(tick.stamp_ns() - result_.start_ns) < 1e9 * options_.from_s) {
      return;
    }
    const bool gap = result_.segments.empty() || tick.tick() != next_tick_;
    if (!result_.segments.empty() && tick.tick() > next_tick_) {
      result_.ticks_lost += tick.tick() - next_tick_;
    }
    next_tick_ = tick.tick() + 1;
    const auto keyframe = keyframes_.find(tick.tick());
    const bool has_keyframe = keyframe != keyframes_.end() && result_.same_build;
    if (options_.from_s > 0.0 && result_.segments.empty() && !has_keyframe) {
      return;
    }
    if (gap || (!runs_ && has_keyframe)) {
      Begin(tick, has_keyframe ? &keyframe->second : nullptr);
    } else if (runs_ && has_keyframe) {
      CompareStates(keyframe->second);
    }
    result_.segments.back().last_tick = tick.tick();
    result_.segments.back().last_ns = tick.stamp_ns();
    if (runs_) {
      Step(tick, feature);
    }
  }

  void Begin(const log::Tick& tick, const log::Keyframe* keyframe) {
    Segment segment;
    segment.first_tick = tick.tick();
    segment.first_ns = tick.stamp_ns();
    segment.from_keyframe = tick.tick() > 0;
    runs_ = tick.tick() == 0 || keyframe != nullptr;
    if (runs_) {
      Start(*config_, keyframe, task_);
      if (changed_) {
        Start(*changed_, keyframe, other_);
      }
    } else {
      segment.not_replayed = result_.same_build ? "no keyframe at its start"
                                                : "a keyframe fits only the build that wrote the log";
    }
    result_.segments.push_back(segment);
  }

  static void Start(const config::ServoConfig& config, const log::Keyframe* keyframe, task::ServoTask& task) {
    if (const hal::Status status = task.Init(config); !status.ok()) {
      throw std::runtime_error(fmt::format("the servo refuses the configuration: {}: {}", status.where(),
                                           hal::ToString(status.code())));
    }
    if (keyframe != nullptr) {
      const auto state = std::make_unique<task::ServoState>(task.state());
      FromMessage(*keyframe, *state);
      task.Restore(*state);
    }
  }

  void Step(const log::Tick& recorded, const hal::FeatureMeasurement& feature) {
    const task::ServoInputs inputs = InputsOf(recorded, feature);
    task_.Step(inputs, outputs_);
    log::ReplayData data;
    if (changed_) {
      other_.Step(inputs, outputs_);
      FollowTheArm();
    }
    // With another configuration or another build's fields, digests cannot be compared.
    if (changed_ || !result_.same_build) {
      data.state_digest = recorded.state_digest();
    } else {
      data.state_digest = link::DigestOf(task_.config(), task_.state(), recorded.has_feature());
    }
    if (!recorded.has_state_digest()) {
      data.state_digest.reset();
    }
    log::ToMessage(outputs_.record, replayed_);
    log::ToMessage(data, replayed_);
    replayed_.set_demand(recorded.demand());
    Compare(recorded);
    if (options_.on_tick) {
      options_.on_tick(recorded, replayed_, outputs_.record);
    }
  }

  // The arm followed the recorded servo's reference.
  void FollowTheArm() {
    if (other_.state().mode.mode == task_.state().mode.mode) {
      *state_ = other_.state();
      state_->reference.q = task_.state().reference.q;
      other_.Restore(*state_);
    }
  }

  void Compare(const log::Tick& recorded) {
    recorded.SerializeToString(&recorded_bytes_);
    replayed_.SerializeToString(&replayed_bytes_);
    if (recorded_bytes_ == replayed_bytes_) {
      return;
    }
    EachDifference(recorded, replayed_, [&](const FieldDifference& difference) {
      Segment& segment = result_.segments.back();
      if (!segment.divergence) {
        segment.divergence = {recorded.tick(), recorded.stamp_ns(), difference.field,
                              difference.a,    difference.b,        {}};
      }
      Note(difference, recorded);
    });
  }

  void Note(const FieldDifference& difference, const log::Tick& at) {
    const auto [known, is_new] = change_of_.try_emplace(difference.field, result_.changes.size());
    if (is_new) {
      result_.changes.push_back({difference.field, 0, at.tick(), at.stamp_ns(), -1.0, 0});
    }
    FieldChange& change = result_.changes[known->second];
    ++change.ticks;
    if (difference.size > change.most) {
      change.most = difference.size;
      change.most_ns = at.stamp_ns();
    }
  }

  // Finds the group of the state that differs after a divergence.
  void CompareStates(const log::Keyframe& keyframe) {
    std::optional<Divergence>& divergence = result_.segments.back().divergence;
    if (!divergence || !divergence->state_group.empty() || changed_) {
      return;
    }
    *state_ = task_.state();
    FromMessage(keyframe, *state_);
    const char* group = link::FirstDifference(*state_, task_.state(), storage_a_, storage_b_);
    divergence->state_group = group == nullptr ? "" : group;
  }

  const ReplayOptions& options_;
  ReplayResult result_;
  std::optional<config::ServoConfig> config_;
  std::optional<config::ServoConfig> changed_;
  std::map<std::uint64_t, log::Keyframe> keyframes_;  // of ticks to come
  std::map<std::string, std::size_t> change_of_;      // by field
  bool started_ = false;
  std::uint64_t next_tick_ = 0;
  bool runs_ = false;  // the current segment is replayed
  task::ServoTask task_;
  task::ServoTask other_;  // with the changed configuration
  task::ServoOutputs outputs_;
  log::Tick replayed_;
  std::string recorded_bytes_;
  std::string replayed_bytes_;
  std::unique_ptr<task::ServoState> state_ = std::make_unique<task::ServoState>();
  std::vector<std::uint8_t> storage_a_ = std::vector<std::uint8_t>(link::kMaxState);
  std::vector<std::uint8_t> storage_b_ = std::vector<std::uint8_t>(link::kMaxState);
};

}  // namespace

bool ReplayResult::Identical() const {
  bool any = false;
  for (const Segment& segment : segments) {
    any = any || segment.not_replayed.empty();
  }
  return any && changes.empty();
}

std::uint64_t ReplayResult::ticks() const {
  std::uint64_t sum = 0;
  for (const Segment& segment : segments) {
    sum += segment.not_replayed.empty() ? segment.ticks() : 0;
  }
  return sum;
}

ReplayResult Replay(const std::filesystem::path& log, const ReplayOptions& options) {
  const auto replayer =
      std::make_unique<Replayer>(options);  // two servos are large, and a stack may be small
  const TickVisitor visitor = replayer->Visitor();
  try {
    return replayer->Finish(ReadTicks(log, visitor));
  } catch (const std::runtime_error& error) {
    const std::string what = error.what();
    throw std::runtime_error(what.starts_with(log.string()) ? what : log.string() + ": " + what);
  }
}

}  // namespace fovea::flight
