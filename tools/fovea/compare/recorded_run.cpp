// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"

namespace fovea::compare {
namespace {

using config::InputError;

bool HasState(const log::Tick& tick, std::size_t joints) {
  return static_cast<std::size_t>(tick.arm().q_size()) == joints &&
         static_cast<std::size_t>(tick.arm().dq_size()) == joints && joints > 0;
}

class Reader {
 public:
  flight::TickVisitor Visitor() {
    flight::TickVisitor visitor;
    visitor.on_metadata = [this](const std::string& name, const std::map<std::string, std::string>& entries) {
      if (name == "configuration") {
        run_.keys = entries;
      }
    };
    visitor.on_configuration = [this](const log::ServoConfiguration& message) {
      run_.arm = flight::FromMessage(message).arm;
      run_.has_arm = true;
    };
    visitor.on_tick = [this](const log::Tick& tick, const hal::FeatureMeasurement&) {
      if (!has_state_ && HasState(tick, run_.joints.size())) {
        has_state_ = true;
        run_.start_ns = tick.arm().stamp_ns();
        std::copy(tick.arm().q().begin(), tick.arm().q().end(), run_.q_first.begin());
      }
    };
    visitor.on_other = [this](const log::McapMessage& message) { Take(message); };
    return visitor;
  }

  RecordedRun Finish(const std::string& path, const log::McapEnd& end) {
    if (is_theory_) {
      throw InputError(path +
                       ": is the log of a theory run, whose summary.json compares it with the exact "
                       "response; logs of other runs are allowed");
    }
    if (!end.complete) {
      throw InputError(fmt::format("{}: is cut off: {}; only a complete log is compared", path, end.why));
    }
    if (!has_state_) {
      throw InputError(path + ": holds no states of an arm (/setup and /servo/tick): nothing to compare");
    }
    return std::move(run_);
  }

 private:
  void Take(const log::McapMessage& message) {
    is_theory_ = is_theory_ || message.topic == log::kTheoryTopic;
    log::Setup setup;
    if (message.topic == log::kSetupTopic &&
        setup.ParseFromArray(message.data.data(), static_cast<int>(message.data.size())) &&
        setup.joints_size() <= model::kMaxJoints) {
      for (const log::Joint& joint : setup.joints()) {
        run_.joints.push_back(joint.name());
        run_.slides.push_back(joint.prismatic());
      }
    }
  }

  RecordedRun run_;
  bool is_theory_ = false;
  bool has_state_ = false;
};

}  // namespace

RecordedRun ReadRun(const std::filesystem::path& log) {
  Reader reader;
  const log::McapEnd end = flight::ReadTicks(log, reader.Visitor());
  return reader.Finish(log.string(), end);
}

void ReadMotion(const std::filesystem::path& log, const std::function<void(const hal::TickRecord&)>& take) {
  flight::TickVisitor visitor;
  visitor.on_tick = [&](const log::Tick& tick, const hal::FeatureMeasurement& feature) {
    take(log::FromMessage(tick, feature));
  };
  flight::ReadTicks(log, visitor);
}

}  // namespace fovea::compare
