// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tools/fovea/faults/table.hpp"

namespace fovea::matrix {
namespace {

using nlohmann::json;

constexpr double kTickS = 1e-3;
constexpr double kRounding = 1e-9;   // a used share of 1 plus this exceeds no limit
constexpr double kGoesOnS = 1.5e-3;  // a mode goes on when it lasts longer by more than this

bool IsLimit(const std::string& what) { return what.rfind("limit_", 0) == 0; }

// "fault_arm_lost" as "arm_lost", "limit_torque" as "limit torque".
std::string InWords(const std::string& what) {
  for (const char* prefix : {"fault_", "mode_"}) {
    if (what.rfind(prefix, 0) == 0) {
      return what.substr(std::string(prefix).size());
    }
  }
  return IsLimit(what) ? "limit " + what.substr(6) : what;
}

const json& InjectedAs(const std::string& name, const json& summary) {
  for (const json& fault : summary.at("injected")) {
    if (fault.at("name") == name) {
      return fault;
    }
  }
  throw std::runtime_error("a run's summary has no fault " + name);
}

// The modes that begin at or after `onset_s`.
std::vector<std::string> ModesSince(double onset_s, const json& summary) {
  std::vector<std::string> modes;
  for (const json& event : summary.at("modes")) {
    if (event.at("t_s").get<double>() >= onset_s - 0.5 * kTickS) {
      const std::string reason = event.at("reason");
      modes.push_back(event.at("mode").get<std::string>() + (reason.empty() ? "" : " (" + reason + ")"));
    }
  }
  return modes;
}

int TicksBetween(double from_s, double to_s) {
  return static_cast<int>(std::lround((to_s - from_s) / kTickS));
}

// Finds what noticed the fault: an event that occurs only in the run with the fault. Limits count only when
// nothing else did. An event that also occurs without the fault does not count, at whatever time.
void FindNotice(const json& with, const json& without, Outcome& outcome) {
  const double from_s = with.at("from_s");
  std::optional<double> first_s;
  for (const bool limits : {false, true}) {
    for (const auto& [what, at_s] : with.at("noticed").items()) {
      if (IsLimit(what) != limits || without.at("noticed").contains(what)) {
        continue;
      }
      if (!first_s || at_s.get<double>() < *first_s) {
        first_s = at_s.get<double>();
        outcome.noticed_by = InWords(what);
      }
    }
    if (first_s) {
      outcome.ticks = TicksBetween(from_s, *first_s);
      return;
    }
  }
  // A fault that keeps the arm from being ready, or the target from being found at all, is visible only in a
  // mode that goes on longer.
  for (const auto& [mode, next] : {std::pair{"boot", "mode_hold"}, {"hold", "mode_track"}}) {
    const json& then = without.at("noticed");
    if (!with.at("noticed").contains(std::string("mode_") + mode) || !then.contains(next)) {
      continue;
    }
    const double leaves_s = then.at(next);
    if (with.at("noticed").value(next, std::numeric_limits<double>::infinity()) > leaves_s + kGoesOnS) {
      outcome.noticed_by = fmt::format("{} goes on", mode);
      outcome.ticks = TicksBetween(from_s, leaves_s);
      return;
    }
  }
}

std::string NewLimits(const json& with, const json& without) {
  std::string names;
  for (const auto& [what, at_s] : with.at("noticed").items()) {
    if (IsLimit(what) && !without.at("noticed").contains(what)) {
      names += (names.empty() ? "limit " : ", ") + what.substr(6);
    }
  }
  return names;
}

// The modes since the fault's start or, when they equal those of the run without it, the new limits.
std::string ReactionOf(const json& run, const json& without_run, const json& with, const json& without) {
  const double onset_s = with.at("from_s");
  const std::vector<std::string> modes = ModesSince(onset_s, run);
  if (modes == ModesSince(onset_s, without_run)) {
    return NewLimits(with, without);
  }
  std::string words;
  for (const std::string& mode : modes) {
    words += (words.empty() ? "" : ", ") + mode;
  }
  return words.empty() ? "stays" : words;
}

// Everything exceeded or touched by the simulator's truth. The arm's own limits are also checked by shares.
std::vector<std::string> ExceededIn(const json& run, const std::map<std::string, double>& limits) {
  std::vector<std::string> exceeded;
  for (const auto& [name, ticks] : run.at("violations").items()) {
    if (ticks.get<std::uint64_t>() > 0) {
      exceeded.push_back(name);
    }
  }
  for (const std::string& limit : PhysicalLimits()) {
    const bool known = std::find(exceeded.begin(), exceeded.end(), limit) != exceeded.end();
    if (!known && !(limits.at(limit) <= 1.0 + kRounding)) {
      exceeded.push_back(limit);
    }
  }
  return exceeded;
}

void JudgeStanding(const std::string& key, const json& run, Outcome& outcome) {
  const bool is_the_eyes = std::any_of(Faults().begin(), Faults().end(), [&](const Fault& fault) {
    return key == fault.key && fault.is_the_eyes;
  });
  const json& motion = run.at("unwanted_motion");
  for (const StandBound& bound : kStandBounds) {
    if (!motion.contains(bound.mode)) {
      continue;
    }
    const json& of_mode = motion.at(bound.mode);
    const Moved moved{of_mode.at("most_mm"), of_mode.at("beyond_stop_mm"), of_mode.at("gained_m_per_s")};
    const double most = is_the_eyes ? bound.gained_by_eye_m_per_s : bound.gained_m_per_s;
    outcome.moved[bound.mode] = moved;
    if (!(moved.beyond_stop_mm <= bound.beyond_stop_mm) || !(moved.gained_m_per_s <= most)) {
      outcome.too_far.push_back(fmt::format("{} {:.0f} mm, {:.0f} mm beyond a stop, {:.2f} m/s faster",
                                            bound.mode, moved.mm, moved.beyond_stop_mm,
                                            moved.gained_m_per_s));
    }
  }
}

void JudgeEnd(const json& run, const json& with, double kept_s, Outcome& outcome) {
  const json& end = run.at("end");
  const std::string mode = end.at("mode");
  const std::string reason = end.at("reason");
  const bool rests = end.at("at_rest_since_s").is_number();
  const json& kept_since_s = end.at("goal_kept_since_s");
  outcome.end_detail = reason.empty() ? mode : mode + " (" + reason + ")";
  if (mode == "fault") {
    outcome.end = end.at("brakes").get<bool>() && rests ? End::kSafeStop : End::kUndefined;
  } else if (kept_since_s.is_number() && mode != "boot" &&
             run.at("sim_time_s").get<double>() - kept_since_s.get<double>() >= kept_s) {
    outcome.end = End::kRecovered;
    outcome.recovered_after_s = std::max(kept_since_s.get<double>() - with.at("to_s").get<double>(), 0.0);
  } else if (mode == "move" && run.at("path_error_mm_max").is_number() &&
             with.at("to_s").get<double>() >= run.at("sim_time_s").get<double>()) {
    outcome.end = End::kGoesOn;
    outcome.off_mm = run.at("path_error_mm_max").get<double>();
  } else {
    outcome.end = mode == "hold" && rests ? End::kHeld : End::kUndefined;
    outcome.is_on_its_way =
        outcome.end == End::kUndefined && with.at("to_s").get<double>() < run.at("sim_time_s").get<double>();
  }
}

}  // namespace

const char* Name(End end) {
  constexpr std::array kNames{"recovered", "safe stop", "held", "goes on", "undefined"};
  return kNames[static_cast<std::size_t>(end)];
}

const std::vector<std::string>& PhysicalLimits() {
  static const std::vector<std::string> names{"joint_position", "joint_velocity", "torque", "torque_rate"};
  return names;
}

Outcome Judge(const std::string& key, const json& run, const json& without_run, double kept_s) {
  try {
    const json& with = InjectedAs(key, run);
    const json& without = InjectedAs("nothing", without_run);
    if (std::fabs(with.at("from_s").get<double>() - without.at("from_s").get<double>()) > 0.5 * kTickS) {
      throw std::runtime_error("the run without the fault is of another stage");
    }
    Outcome outcome;
    FindNotice(with, without, outcome);
    outcome.reaction = ReactionOf(run, without_run, with, without);
    outcome.limits = run.at("limits").get<std::map<std::string, double>>();
    outcome.exceeded = ExceededIn(run, outcome.limits);
    JudgeStanding(key, run, outcome);
    outcome.contact_ticks = run.at("contact_ticks");
    JudgeEnd(run, with, kept_s, outcome);
    return outcome;
  } catch (const json::exception& error) {
    throw std::runtime_error(fmt::format("fault {}: not a summary of a run: {}", key, error.what()));
  } catch (const std::out_of_range&) {
    throw std::runtime_error(fmt::format("fault {}: a summary without the arm's limits", key));
  }
}

}  // namespace fovea::matrix
