#include "hw_summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "fovea/build_info.hpp"

namespace fovea::hw {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAtGoalPx = 3.0;  // a target seen within this of its goal is there

Json ModesOf(const HwSummary& s) {
  Json modes = Json::array();
  for (const ModeEvent& m : s.modes) {
    modes.push_back({{"t_s", m.t_s},
                     {"mode", hal::Name(m.mode)},
                     {"reason", m.mode == hal::Mode::kHold ? hal::Name(m.reason) : ""}});
  }
  return modes;
}

Json FaultsOf(const HwSummary& s) {
  Json faults = Json::array();
  for (const FaultEvent& f : s.faults) {
    faults.push_back({{"t_s", f.t_s},
                      {"name", hal::Name(f.fault)},
                      {"key", hal::Key(f.fault)},
                      {"detail", f.joint >= 0 ? fmt::format("joint {}", f.joint + 1) : ""}});
  }
  return faults;
}

}  // namespace

void Judge(HwSummary& s) {
  const std::string last = s.seen && s.seen->last_px
                               ? fmt::format("the camera saw it {:.2f} px off its goal", *s.seen->last_px)
                               : "the camera never saw it";
  const hal::HoldReason reason =
      s.mode == hal::Mode::kHold && !s.modes.empty() ? s.modes.back().reason : hal::HoldReason::kNone;
  s.good = false;
  if (s.fault != hal::Fault::kNone) {
    s.verdict = fmt::format("it ended in a fault: {}", hal::Name(s.fault));
  } else if (s.mode == hal::Mode::kTrack || s.mode == hal::Mode::kCoast) {
    s.good = s.mode == hal::Mode::kTrack && s.seen && s.seen->last_px && *s.seen->last_px <= kAtGoalPx;
    s.verdict = fmt::format("it ended while it followed the target; at last {}", last);
  } else if (reason == hal::HoldReason::kNoTarget || reason == hal::HoldReason::kTargetLost ||
             reason == hal::HoldReason::kGoalUnreachable) {
    s.verdict =
        fmt::format("it was to follow the target, and held in the end ({}); {}", hal::Name(reason), last);
  } else {
    s.good = s.loop.ticks > 0;
    s.verdict = s.good ? fmt::format("it ended without a fault, in mode {}", hal::Name(s.mode))
                       : "the servo was never told to begin";
  }
}

std::string ToJson(const HwSummary& s) {
  Json json{
      {"config", s.config},
      {"converged", s.good},
      {"verdict", s.verdict},
      {"mode", hal::Name(s.mode)},
      {"fault", hal::Name(s.fault)},
      {"events", s.events},
      {"modes", ModesOf(s)},
      {"faults", FaultsOf(s)},
      {"ticks", s.loop.ticks},
      {"overruns", s.loop.overruns},
      {"missed_ticks", s.loop.missed_ticks},
      {"records_dropped", s.records_dropped},
      {"heap_allocations_in_tick", s.heap_counted ? Json(s.heap_calls) : Json(nullptr)},
      {"page_faults_in_loop", s.page_faults},
      {"tick_ns",
       {{"p50", s.ticks.Percentile(0.5)},
        {"p99", s.ticks.Percentile(0.99)},
        {"p999", s.ticks.Percentile(0.999)},
        {"max", s.ticks.max_ns()}}},
      {"robot",
       {{"states", s.robot.states},
        {"lost_states", s.robot.lost_states},
        {"late_states", s.robot.late_states},
        {"duplicate_states", s.robot.duplicate_states},
        {"skipped_states", s.robot.skipped_states},
        {"malformed", s.robot.malformed},
        {"foreign", s.robot.foreign},
        {"commands", s.robot.commands},
        {"repeated_commands", s.robot.repeated_commands},
        {"rate_limited", s.robot.rate_limited},
        {"timeouts", s.robot.timeouts},
        {"motions", s.robot.motions},
        {"command_success_rate", s.success_rate}}},
      {"realtime_missing", s.realtime_missing},
      {"log_hash", s.log_hash},
      {"servo", kServoLibraryHash},
      {"git", kGitRevision},
      {"version", kVersion},
  };
  if (s.log) {
    json["log_entries_dropped"] = s.log->ticks_dropped;
    json["log_pictures"] = s.log->pictures;
    json["log_pictures_dropped"] = s.log->pictures_dropped;
    json["film_frames_dropped"] = s.log->film_frames_dropped;
    json["film_errors"] = s.log->film_errors;
  }
  if (s.seen) {
    json["camera"] = {{"frames", s.seen->frames},
                      {"frames_detected", s.seen->frames_detected},
                      {"seen_error_px", s.seen->last_px ? Json(*s.seen->last_px) : Json(nullptr)},
                      {"feature_age_ms",
                       {{"p50", 1e-6 * static_cast<double>(s.feature_ages.Percentile(0.5))},
                        {"max", 1e-6 * static_cast<double>(s.feature_ages.max_ns())}}},
                      {"incomplete", s.camera.incomplete},
                      {"lost", s.camera.lost},
                      {"overtaken", s.camera.overtaken},
                      {"missing_packets", s.camera.missing_packets},
                      {"stamped_by_clock", s.camera.stamped_by_clock},
                      {"clock_refused", s.camera.clock_refused},
                      {"disconnects", s.camera.disconnects},
                      {"reconnects", s.camera.reconnects}};
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea::hw
