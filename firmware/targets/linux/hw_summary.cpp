// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "firmware/host/beliefs/findings_json.hpp"
#include "firmware/host/run/in_words.hpp"

namespace fovea::hw {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAtGoalPx = 3.0;  // within this image error the target counts as at its goal
constexpr const char* kUnknown =
    "the camera's true distance from its goal, above all in depth, is unknown: a wrong focal length, mount "
    "or target size does not show in the camera's own picture";

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
  for (const run::FaultEvent& f : s.faults) {
    faults.push_back({{"t_s", f.t_s},
                      {"name", hal::Name(f.fault)},
                      {"key", hal::Key(f.fault)},
                      {"detail", run::JointOf(f)}});
  }
  return faults;
}

std::string LastSeen(const std::optional<SeenError>& seen) {
  if (seen && seen->last_px) {
    return fmt::format("the camera saw the target {:.2f} px off its goal", *seen->last_px);
  }
  if (seen && seen->frames > 0 && seen->failures.frames == seen->frames) {
    return fmt::format("none of the camera's {} pictures could be processed ({})", seen->frames,
                       seen->failures.first);
  }
  return "the camera never saw the target";
}

Json GravityOf(const HwSummary& s) {
  if (!s.gravity) {
    return nullptr;
  }
  return {{"torque_off_nm", s.gravity->worst_nm},
          {"joint", s.gravity->joint + 1},
          {"unknown_mass_kg", s.gravity->unknown_mass_kg}};
}

Json WordsOf(const HwSummary& s) {
  Json words = Json::array();
  for (const WordEvent& w : s.words) {
    Json t_s = nullptr;
    if (s.start_ns) {
      t_s = 1e-9 * static_cast<double>(w.stamp_ns - *s.start_ns);
    }
    words.push_back({{"t_s", t_s}, {"word", w.word}});
  }
  return words;
}

bool HasTracked(const HwSummary& s) {
  return std::any_of(s.modes.begin(), s.modes.end(), [](const ModeEvent& m) {
    return m.mode == hal::Mode::kTrack || m.mode == hal::Mode::kCoast;
  });
}

// Whether the final Hold began because the camera was doubted. The end itself, or an operator's word, may
// have replaced the reason since.
bool EndedInDoubt(const HwSummary& s) {
  for (auto m = s.modes.rbegin(); m != s.modes.rend() && m->mode == hal::Mode::kHold; ++m) {
    if (m->reason == hal::HoldReason::kEyeDoubted) {
      return true;
    }
  }
  return false;
}

// The faults that the run recovered from.
std::string RecoveredFrom(const HwSummary& s) {
  const std::size_t left = s.fault != hal::Fault::kNone && !s.faults.empty() ? 1 : 0;
  std::map<hal::Fault, int> counts;
  for (std::size_t k = 0; k + left < s.faults.size(); ++k) {
    ++counts[s.faults[k].fault];
  }
  std::vector<std::string> words;
  words.reserve(counts.size());
  for (const auto& [fault, count] : counts) {
    words.push_back(run::InWords(fault) + (count > 1 ? fmt::format(", {} times", count) : ""));
  }
  return fmt::format("{}", fmt::join(words, "; "));
}

void JudgeEnd(HwSummary& s) {
  const std::string last = LastSeen(s.seen);
  const hal::HoldReason reason = s.hold_reason;
  s.converged = false;
  if (s.fault != hal::Fault::kNone) {
    s.verdict = fmt::format("the run ended in a fault: {}", run::InWords(s.fault));
  } else if (!s.refusal.empty()) {
    s.verdict = s.refusal;
  } else if (s.ticks == 0) {
    s.verdict = "the servo was never started";
  } else if (s.robot_silent) {
    s.verdict =
        fmt::format("the robot sent no new state at the end; the run ended in mode {}", hal::Name(s.mode));
  } else if (s.mode == hal::Mode::kBoot) {
    s.verdict = "the servo never left mode boot: the arm's states were invalid, or the arm was not at rest";
  } else if (s.seen && s.seen->frames_detected == 0) {
    s.verdict =
        fmt::format("{}, in {} frames; the run ended in mode {}", last, s.seen->frames, hal::Name(s.mode));
  } else if (!s.allow_motion) {
    s.converged = std::nullopt;
    s.verdict =
        fmt::format("nothing was commanded; the run ended without a fault, in mode {}", hal::Name(s.mode));
  } else if (s.mode == hal::Mode::kTrack || s.mode == hal::Mode::kCoast) {
    s.converged = s.mode == hal::Mode::kTrack && s.seen && s.seen->last_px && *s.seen->last_px <= kAtGoalPx;
    s.verdict = fmt::format("the run ended while the servo followed the target; at the end {}", last);
  } else if (reason == hal::HoldReason::kNoTarget || reason == hal::HoldReason::kTargetLost ||
             reason == hal::HoldReason::kGoalUnreachable) {
    s.verdict = fmt::format("the servo should follow the target, but held at the end because {}; {}",
                            run::InWords(reason), last);
  } else if (s.mode == hal::Mode::kHold && EndedInDoubt(s)) {
    s.verdict = fmt::format("the servo should follow the target, but held at the end because {}; {}",
                            run::InWords(hal::HoldReason::kEyeDoubted), last);
  } else if (s.operator_silent && HasTracked(s)) {
    s.verdict =
        fmt::format("the servo should follow the target, but held because the operator was silent; {}", last);
  } else {
    s.converged = std::nullopt;
    s.verdict = fmt::format("the run ended without a fault, in mode {}", hal::Name(s.mode));
  }
}

Json RobotOf(const RobotFigures& robot) {
  Json json{{"states", robot.states}, {"lost_states", robot.lost_states}, {"commands", robot.commands}};
  for (const auto& [name, count] : robot.counters) {
    json[name] = count;
  }
  json["command_success_rate"] = robot.command_success_rate;
  return json;
}

}  // namespace

void Judge(HwSummary& s) {
  JudgeEnd(s);
  if (const std::string recovered = RecoveredFrom(s); !recovered.empty()) {
    s.verdict += "; recovered from: " + recovered;
  }
  if (s.converged == true) {
    s.verdict += fmt::format("; {}", kUnknown);
  }
}

std::string ToJson(const HwSummary& s) {
  Json json;
  run::BeginSummary(json);
  json.update(Json{
      {"config", s.config},
      {"converged", s.converged ? Json(*s.converged) : Json(nullptr)},
      {"verdict", s.verdict},
      {"final_error_px_rms", nullptr},
      {"final_error_mm", nullptr},
      {"final_error_lateral_mm", nullptr},
      {"final_error_depth_mm", nullptr},
      {"final_error_deg", nullptr},
      {"unknown",
       {{"final_error_px_rms", kUnknown}, {"final_error_mm", kUnknown}, {"final_error_deg", kUnknown}}},
      {"mode", hal::Name(s.mode)},
      {"fault", hal::Name(s.fault)},
      {"events", s.events},
      {"start_ns", s.start_ns ? Json(*s.start_ns) : Json(nullptr)},
      {"finish_t_s", s.finish_t_s ? Json(*s.finish_t_s) : Json(nullptr)},
      {"modes", ModesOf(s)},
      {"faults", FaultsOf(s)},
      {"faults_recovered", s.faults.size() - (s.fault != hal::Fault::kNone && !s.faults.empty() ? 1U : 0U)},
      {"gravity", GravityOf(s)},
      {"words", WordsOf(s)},
      {"dead_man_holds", s.dead_man_holds},
      {"lines_unsaid", s.lines_unsaid},
      {"robot", RobotOf(s.robot)},
  });
  run::AddFigures(s, json);
  json["beliefs"] = s.beliefs ? beliefs::ToJson(*s.beliefs) : Json(nullptr);
  if (s.seen) {
    json["camera"] = {
        {"frames", s.seen->frames},
        {"frames_detected", s.seen->frames_detected},
        {"frames_failed", s.seen->failures.frames},
        {"frame_failure", s.seen->failures.frames > 0 ? Json(s.seen->failures.first) : Json(nullptr)},
        {"seen_error_px", s.seen->last_px ? Json(*s.seen->last_px) : Json(nullptr)},
        {"measurements", s.measurements},
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
