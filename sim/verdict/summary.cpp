// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/summary.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "firmware/host/beliefs/findings_json.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "fovea/hal/events.hpp"
#include "sim/truth/truth_text.hpp"

namespace fovea::sim {
namespace {

using nlohmann::ordered_json;

template <typename T>
ordered_json OrNull(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

std::string Figure(const std::optional<double>& value, const char* unit) {
  return value ? fmt::format("{:.3g} {}", *value, unit) : std::string("-");
}

ordered_json ToJson(const TheoryFigures& f) {
  ordered_json poles = ordered_json::array();
  for (const std::complex<double>& pole : f.poles) {
    poles.push_back({pole.real(), pole.imag()});
  }
  return {{"zeta", OrNull(f.zeta)},
          {"omega_n", OrNull(f.omega_n)},
          {"settle_time_s", OrNull(f.settle_time_s)},
          {"e_ss", f.e_ss},
          {"poles", poles}};
}

ordered_json ToJson(const InstructionSpread& spread) {
  return {{"min", spread.min}, {"p50", spread.p50}, {"max", spread.max}};
}

ordered_json ToJson(const BoardTicks& ticks) {
  ordered_json json;
  json["ticks"] = ticks.ticks;
  json["tick"] = ToJson(ticks.tick);
  for (const auto& [stage, spread] : ticks.stages) {
    json["stages"][stage] = ToJson(spread);
  }
  return json;
}

ordered_json ToJson(const BoardSummary& board) {
  ordered_json json;
  json["pace"] = board.by_timer ? "timer" : "lockstep";
  json["instruction_ns"] = board.instruction_ns;
  json["instructions_per_count"] = board.instructions_per_count;
  json["instructions"] = ToJson(board.all);
  for (const BoardTicks& mode : board.modes) {
    json["instructions_by_mode"][mode.mode] = ToJson(mode);
  }
  json["link_instructions"] = ToJson(board.link);
  json["stack_bytes"] = board.stack_bytes;
  json["line"] = {{"damaged_frames", board.line.damaged_frames}, {"late_frames", board.line.late_frames},
                  {"silent_ticks", board.line.silent_ticks},     {"missed_ticks", board.line.missed_ticks},
                  {"lost_bytes", board.line.lost_bytes},         {"unsent_frames", board.line.unsent_frames}};
  json["frames_sent_again"] = board.frames_sent_again;
  json["ticks_without_torque"] = board.ticks_without_torque;
  json["stopped"] = board.stopped.empty() ? ordered_json(nullptr) : ordered_json(board.stopped);
  return json;
}

ordered_json ToJson(const TheoryResult& theory) {
  ordered_json json = ToJson(theory.run);
  json["analytic"] = ToJson(theory.analytic);
  json["residual_rms"] = theory.residual_rms;
  json["residual_max"] = theory.residual_max;
  json["error_max"] = theory.error_max;
  return json;
}

ordered_json ToJson(const std::vector<InjectedFault>& injected) {
  ordered_json json = ordered_json::array();
  for (const InjectedFault& fault : injected) {
    json.push_back(
        {{"name", fault.name}, {"from_s", fault.from_s}, {"to_s", fault.to_s}, {"noticed", fault.noticed}});
  }
  return json;
}

ordered_json ToJson(const std::map<std::string, StandingMotion>& motions) {
  ordered_json json = ordered_json::object();
  for (const auto& [mode, motion] : motions) {
    json[mode] = {{"most_mm", motion.most_mm},
                  {"beyond_stop_mm", motion.beyond_stop_mm},
                  {"most_m_per_s", motion.most_m_per_s},
                  {"gained_m_per_s", motion.gained_m_per_s}};
  }
  return json;
}

ordered_json ToJson(const RunEnd& end) {
  return {{"mode", end.mode},
          {"reason", end.reason},
          {"brakes", end.brakes},
          {"at_rest_since_s", OrNull(end.at_rest_since_s)},
          {"goal_kept_since_s", OrNull(end.goal_kept_since_s)}};
}

std::string Poles(const TheoryFigures& f) {
  std::string text;
  for (const std::complex<double>& pole : f.poles) {
    text += fmt::format("{}{:.3f}{}", text.empty() ? "" : ", ", pole.real(),
                        pole.imag() == 0.0 ? "" : fmt::format("{:+.3f}i", pole.imag()));
  }
  return text.empty() ? "-" : text;
}

// E.g. "232 taken, 3 rejected as outlier". Omits targets not found, which the row of the frames shows.
std::string MeasurementsInWords(const std::map<std::string, std::uint64_t>& measurements) {
  const auto of_taken = measurements.find(hal::Name(hal::Intake::kTaken));
  std::string words = fmt::format("{} taken", of_taken == measurements.end() ? 0 : of_taken->second);
  for (int i = 0; i < hal::kNumIntakes; ++i) {
    const auto intake = static_cast<hal::Intake>(i);
    const auto found = measurements.find(hal::Name(intake));
    if (found != measurements.end() && intake != hal::Intake::kTaken && intake != hal::Intake::kNotFound) {
      words += fmt::format(", {} {}", found->second, hal::Words(intake));
    }
  }
  return words;
}

// E.g. "90, lost 35, target found in 40": the frames that the camera took, those that never reached vision,
// and those with the target.
std::string FramesInWords(const Summary& s) {
  return fmt::format("{}{}, target found in {}", s.frames + s.frames_lost,
                     s.frames_lost > 0 ? fmt::format(", lost {}", s.frames_lost) : "", s.frames_detected);
}

using config::Paint;
using config::PrintedTable;

void AddTheory(const TheoryResult& theory, PrintedTable& table) {
  const auto row = [&](const char* name, const std::string& run, const std::string& analytic) {
    table.Row(name, fmt::format("{:<24}theory {}", run, analytic));
  };
  row("zeta", Figure(theory.run.zeta, ""), Figure(theory.analytic.zeta, ""));
  row("omega_n", Figure(theory.run.omega_n, "rad/s"), Figure(theory.analytic.omega_n, "rad/s"));
  row("poles [1/s]", Poles(theory.run), Poles(theory.analytic));
  row("settled after", Figure(theory.run.settle_time_s, "s"), Figure(theory.analytic.settle_time_s, "s"));
  row("steady-state error", Figure(theory.run.e_ss, "m"), Figure(theory.analytic.e_ss, "m"));
  table.Row("deviation",
            fmt::format("{:.2g} m rms, {:.2g} m at most", theory.residual_rms, theory.residual_max));
  table.Row("largest error", fmt::format("{:.3g} m after the first second", theory.error_max));
}

void AddFindings(const beliefs::Findings& findings, PrintedTable& table) {
  const char* name = "found out";
  for (const std::string& sentence : findings.verdict) {
    table.Row(name, sentence);
    name = "";
  }
  name = "learnt";
  for (const beliefs::Correction& correction : findings.learnt) {
    table.Row(name, correction.text);
    name = "";
  }
}

void AddBoard(const BoardSummary& board, PrintedTable& table) {
  table.Row(
      "servo's processor",
      fmt::format("Cortex-M7: {} to {} instructions per tick, median {}; stack {:.1f} KiB",
                  board.all.tick.min, board.all.tick.max, board.all.tick.p50, board.stack_bytes / 1024.0));
  if (board.by_timer) {
    table.Row("board ticks",
              fmt::format("by its own timer, {} ns per instruction; {} without a state, {} missed",
                          board.instruction_ns, board.line.silent_ticks, board.line.missed_ticks));
    table.Row("line", fmt::format("{} states late, {} ticks without a new torque", board.line.late_frames,
                                  board.ticks_without_torque));
  }
  if (!board.stopped.empty()) {
    table.Row("", board.stopped + ": the brakes were closed", Paint::kBad);
  }
}

}  // namespace

std::string ToJson(const Summary& s) {
  ordered_json faults = ordered_json::array();
  for (const run::FaultEvent& f : s.faults) {
    faults.push_back({{"t_s", f.t_s},
                      {"name", hal::Name(f.fault)},
                      {"key", hal::Key(f.fault)},
                      {"detail", run::JointOf(f)}});
  }
  ordered_json modes = ordered_json::array();
  for (const ModeEvent& m : s.modes) {
    modes.push_back({{"t_s", m.t_s}, {"mode", m.mode}, {"reason", m.reason}});
  }
  ordered_json json;
  run::BeginSummary(json);
  json["scenario"] = s.scenario;
  json["seed"] = s.seed;
  json["pace"] = s.pace;
  json["converged"] = s.converged;
  json["verdict"] = s.verdict;
  json["interrupted"] = s.interrupted;
  json["settle_time_s"] = OrNull(s.settle_time_s);
  json["start_error_px"] = OrNull(s.start_error_px);
  json["final_error_px_rms"] = OrNull(s.final_error_px_rms);
  json["final_error_mm"] = OrNull(s.final_error_mm);
  json["final_error_lateral_mm"] = OrNull(s.final_error_lateral_mm);
  json["final_error_depth_mm"] = OrNull(s.final_error_depth_mm);
  json["final_error_deg"] = OrNull(s.final_error_deg);
  json["error_px_max"] = OrNull(s.error_px_max);
  json["camera_path_m"] = OrNull(s.camera_path_m);
  json["camera_excursion_m"] = OrNull(s.camera_excursion_m);
  json["tracking_error_px_rms"] = OrNull(s.tracking_error_px_rms);
  json["tracking_error_mm_rms"] = OrNull(s.tracking_error_mm_rms);
  json["path_error_mm_rms"] = OrNull(s.path_error_mm_rms);
  json["path_error_mm_max"] = OrNull(s.path_error_mm_max);
  json["home_error_rad"] = OrNull(s.home_error_rad);
  if (s.mcu) {
    json["mcu"] = ToJson(*s.mcu);
  }
  if (s.theory) {
    json["theory"] = ToJson(*s.theory);
  }
  json["limits"] = s.limits;
  json["clearances_m"] = s.clearances_m;
  json["unjudged"] = s.unjudged;
  json["limit_violations"] = s.limit_violations;
  json["violations"] = s.violations;
  json["measurements"] = s.measurements;
  json["limit_ticks"] = s.limit_ticks;
  json["contact_ticks"] = s.contact_ticks;
  json["contacts"] = {{"bench", s.contacts.bench}, {"target", s.contacts.target}, {"self", s.contacts.self}};
  json["unwanted_motion"] = ToJson(s.unwanted_motion);
  json["faults"] = faults;
  json["modes"] = modes;
  json["injected"] = ToJson(s.injected);
  json["truth"] = TruthAsJson(s.truth);
  json["beliefs"] = s.beliefs ? ToJson(*s.beliefs) : ordered_json(nullptr);
  json["end"] = ToJson(s.end);
  json["frames"] = s.frames;
  json["frames_detected"] = s.frames_detected;
  json["frames_failed"] = s.frames_failed;
  json["frame_failure"] = s.frame_failure.empty() ? ordered_json(nullptr) : ordered_json(s.frame_failure);
  json["frames_lost"] = s.frames_lost;
  json["sim_time_s"] = s.sim_time_s;
  json["preparing_s"] = s.preparing_s;
  json["wall_time_s"] = s.wall_time_s;
  json["real_time_factor"] = s.real_time_factor;
  json["renderer"] = s.renderer;
  run::AddFigures(s, json);
  // Replaces invalid UTF-8: a scenario's file name may hold any bytes.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string ToTable(const Summary& s, const config::TextStyle& style) {
  PrintedTable table(style);
  table.Row("scenario", fmt::format("{}, seed {}, {} pace", s.scenario, s.seed, s.pace));
  table.Row("verdict", s.verdict, ReachedItsGoal(s) ? Paint::kGood : Paint::kBad);
  for (const TrueValue& value : s.truth) {
    table.Row(&value == s.truth.data() ? "truth differs" : "", InWords(value));
  }
  if (s.beliefs) {
    AddFindings(*s.beliefs, table);
  }
  if (s.theory) {
    AddTheory(*s.theory, table);
  } else if (s.path_error_mm_max) {
    table.Row("path error", fmt::format("{} rms, {} at most", Figure(s.path_error_mm_rms, "mm"),
                                        Figure(s.path_error_mm_max, "mm")));
  } else if (s.home_error_rad) {
    table.Row("joint error", fmt::format("{:.2g} rad, largest of all joints", *s.home_error_rad));
  } else if (s.tracking_error_px_rms) {
    table.Row("tracking error", fmt::format("{}, {}", Figure(s.tracking_error_px_rms, "px rms"),
                                            Figure(s.tracking_error_mm_rms, "mm rms")));
  } else if (s.final_error_mm) {
    table.Row("image error", fmt::format("{} at the start, {} at the end", Figure(s.start_error_px, "px"),
                                         Figure(s.final_error_px_rms, "px rms")));
    table.Row("position error",
              fmt::format("{} ({} sideways, {} in depth)", Figure(s.final_error_mm, "mm"),
                          Figure(s.final_error_lateral_mm, "mm"), Figure(s.final_error_depth_mm, "mm")));
    table.Row("settled after", Figure(s.settle_time_s, "s"));
  }
  if (s.frames + s.frames_lost > 0) {
    table.Row("frames", FramesInWords(s));
    table.Row("measurements", MeasurementsInWords(s.measurements));
  }
  if (s.frames_failed > 0) {
    table.Row("", fmt::format("vision failed on {}: {}", s.frames_failed, s.frame_failure));
  }
  std::string limits;
  for (const auto& [name, used] : s.limits) {
    limits += fmt::format("{}{} {:.0f} %", limits.empty() ? "" : ", ", name, 100.0 * used);
  }
  table.Row("limits used", limits);
  std::string violations;
  for (const auto& [name, ticks] : s.violations) {
    violations += fmt::format("{}{} {}", violations.empty() ? ": " : ", ", name, ticks);
  }
  table.Row("limit violations", fmt::format("{}{}", s.limit_violations, violations),
            s.limit_violations > 0 ? Paint::kBad : Paint::kPlain);
  if (s.faults.empty()) {
    table.Row("faults", "none");
  }
  for (const run::FaultEvent& f : s.faults) {
    table.Row(&f == s.faults.data() ? "faults" : "", run::InWords(f), Paint::kBad);
  }
  if (s.mcu) {
    AddBoard(*s.mcu, table);
  }
  table.Row(s.mcu ? "tick and line" : "servo tick",
            fmt::format("{:.1f} us median, {:.1f} us p99.9, {:.1f} us max",
                        1e-3 * static_cast<double>(s.tick_ns_p50), 1e-3 * static_cast<double>(s.tick_ns_p999),
                        1e-3 * static_cast<double>(s.tick_ns_max)));
  table.Row("heap calls in the tick",
            s.heap_allocations_in_tick ? fmt::format("{}", *s.heap_allocations_in_tick) : "not measured");
  table.Row("overruns", fmt::format("{} of {} ticks", s.overruns, s.ticks));
  table.Row("speed", fmt::format("{:.1f} s in {:.2f} s: {:.1f} times real time, rendered by {}", s.sim_time_s,
                                 s.wall_time_s, s.real_time_factor, s.renderer));
  table.Row("time taken",
            fmt::format("{:.2f} s to prepare, {:.2f} s to simulate, {:.2f} s to write the files",
                        s.preparing_s, s.wall_time_s, s.writing_s));
  for (const std::string& missing : s.realtime_missing) {
    table.Row("not real-time", missing);
  }
  table.Row("log hash", s.log_hash);
  return table.text();
}

}  // namespace fovea::sim
