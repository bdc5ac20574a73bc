// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/calibrate/from_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>

#include "firmware/core/model/math.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/host/beliefs/run_watch.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/load_keys.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/flight/recorded_settings.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "fovea/tick.pb.h"

namespace fovea {
namespace {

constexpr double kRadPerDeg = model::kPi / 180.0;

beliefs::Configured ConfiguredIn(const flight::RecordedSettings& recorded) {
  config::LoadSettings load;
  double latency_ms = 0.0;
  config::KeyTable keys;
  config::AddLoadKeys(load, keys);
  const std::size_t of_load = keys.keys().size();
  keys.Number("camera.latency_ms", latency_ms, 0.0, 1e4, "", "");
  const std::set<std::string> applied = keys.ApplyRecorded(recorded.keys);
  beliefs::Configured configured;
  if (applied.count("camera.latency_ms") > 0) {
    configured.latency_ms = latency_ms;
  }
  for (std::size_t i = 0; i < of_load; ++i) {
    if (applied.count(keys.keys()[i].name) > 0) {
      configured.load = config::MakeLoad(load);
    }
  }
  return configured;
}

// Beliefs of one key, in the order of its entries.
class Entries {
 public:
  Entries(const std::vector<beliefs::Belief>& beliefs, const std::string& key) {
    for (const beliefs::Belief& belief : beliefs) {
      if (belief.key == key) {
        entries_.push_back(belief);
      }
    }
  }

  [[nodiscard]] bool AreKnown() const {
    for (const beliefs::Belief& belief : entries_) {
      if (!belief.IsKnown()) {
        return false;
      }
    }
    return !entries_.empty();
  }
  [[nodiscard]] double Difference(std::size_t i) const { return entries_.at(i).difference; }
  [[nodiscard]] std::string Sigmas() const {
    std::string text;
    for (const beliefs::Belief& belief : entries_) {
      text += fmt::format("{}{:.2g}", text.empty() ? "" : ", ", belief.sigma);
    }
    return fmt::format("{} {}", text, entries_.front().unit);
  }
  // The names of the unknown ones.
  [[nodiscard]] std::string Unknown() const {
    std::string text;
    for (const beliefs::Belief& belief : entries_) {
      if (!belief.IsKnown()) {
        text += (text.empty() ? "" : ", ") + belief.name;
      }
    }
    return text;
  }

 private:
  std::vector<beliefs::Belief> entries_;
};

// The values of [camera] that follow from what is known.
class Values {
 public:
  explicit Values(LogCalibration& result) : result_(result) {}

  // Adds the values that `make` returns if all of the key's entries are known.
  template <class Make>
  void Add(const std::string& key, const Make& make) {
    const Entries entries(result_.findings.beliefs, key);
    if (!entries.AreKnown()) {
      if (const std::string unknown = entries.Unknown(); !unknown.empty()) {
        result_.unknown.push_back(unknown);
      }
      return;
    }
    for (const config::NewValue& value : make(entries)) {
      result_.values.push_back(value);
    }
    result_.sigmas.push_back(fmt::format("{} +- {}", key, entries.Sigmas()));
  }

 private:
  LogCalibration& result_;
};

}  // namespace

LogCalibration CalibrateFromLog(const std::string& log) {
  using NewValues = std::vector<config::NewValue>;
  const std::filesystem::path path = flight::LogIn(log);
  const flight::RecordedSettings recorded = flight::ReadSettings(path);
  const beliefs::Configured configured = ConfiguredIn(recorded);
  std::optional<config::ServoConfig> servo;
  std::optional<beliefs::RunWatch> watch;
  flight::TickVisitor visitor;
  visitor.on_configuration = [&](const log::ServoConfiguration& message) {
    servo = flight::FromMessage(message);
    watch.emplace(*servo, configured);
  };
  visitor.on_tick = [&](const log::Tick& tick, const hal::FeatureMeasurement& feature) {
    if (watch) {
      watch->Add(log::FromMessage(tick, feature));
    }
  };
  const log::McapEnd end = flight::ReadTicks(path, visitor);
  if (!watch || !recorded.camera) {
    throw config::InputError(fmt::format("{}: holds no run with a camera: its {} is missing{}", path.string(),
                                         watch ? "/camera/calibration" : "/servo/configuration",
                                         end.complete ? "" : "; " + end.why));
  }
  LogCalibration result;
  result.why_incomplete = end.why;
  result.findings = watch->Finish();
  Values values(result);
  values.Add("camera.latency_ms", [&](const Entries& late) -> NewValues {
    if (!configured.latency_ms) {
      return {};
    }
    return {
        {"latency_ms", fmt::format("{:.2f}", std::max(*configured.latency_ms + late.Difference(0), 0.0))}};
  });
  values.Add("camera.mount_xyz", [&](const Entries& shift) -> NewValues {
    const model::Vec3 p =
        servo->X_EC * model::Vec3(shift.Difference(0), shift.Difference(1), shift.Difference(2));
    return {{"mount_xyz", fmt::format("[{:.6f}, {:.6f}, {:.6f}]", p.x(), p.y(), p.z())}};
  });
  values.Add("camera.mount_rpy_deg", [&](const Entries& turn) -> NewValues {
    const model::Mat3 R =
        servo->X_EC.R * model::RotationOf(kRadPerDeg * model::Vec3(turn.Difference(0), turn.Difference(1),
                                                                   turn.Difference(2)));
    const std::array<double, 3> rpy_deg = config::RollPitchYawOf(R);
    return {{"mount_rpy_deg", fmt::format("[{:.5f}, {:.5f}, {:.5f}]", rpy_deg[0], rpy_deg[1], rpy_deg[2])}};
  });
  values.Add("camera.f_u_px", [&](const Entries& focal) -> NewValues {
    const double factor = 1.0 + 0.01 * focal.Difference(0);
    return {{"f_u_px", fmt::format("{:.3f}", factor * recorded.camera->f_u_px)},
            {"f_v_px", fmt::format("{:.3f}", factor * recorded.camera->f_v_px)}};
  });
  return result;
}

}  // namespace fovea
