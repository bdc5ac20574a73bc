// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/gains/gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/design/sampled_loop.hpp"
#include "firmware/host/design/second_order.hpp"

namespace fovea {
namespace {

using Complex = std::complex<double>;

constexpr double kMostPeriodsListed = 400.0;  // of delay; the poles of a longer one take more than a second
constexpr std::size_t kMostPolesShown = 6;

// All results, for text and JSON.
struct Design {
  design::SampledLoop loop;
  design::SecondOrder closed;
  std::vector<Complex> open_poles;
  std::vector<Complex> closed_poles;
  std::vector<Complex> discrete_poles;  // empty: not listed
  bool stable = false;
  design::StabilityEdge gain_edge;
  design::StabilityEdge delay_edge;
  std::vector<std::string> notes;
};

void Require(bool met, const char* flag, double value, const std::string& allowed) {
  if (!met || !std::isfinite(value)) {
    throw config::InputError(fmt::format("{} {}: must be {}", flag, value, allowed));
  }
}

void Check(const GainsArguments& arguments) {
  const std::string positive = "a number above 0";
  const std::string not_negative = "a number, 0 or more";
  Require(arguments.mass > 0.0, "--mass", arguments.mass, positive);
  Require(arguments.damping >= 0.0, "--damping", arguments.damping, not_negative);
  Require(arguments.stiffness >= 0.0, "--stiffness", arguments.stiffness, not_negative);
  Require(arguments.closed_loop_stiffness > 0.0, "--closed-loop-stiffness", arguments.closed_loop_stiffness,
          positive);
  Require(arguments.damping_ratio > 0.0, "--damping-ratio", arguments.damping_ratio, positive);
  Require(arguments.rate_hz > 0.0, "--rate-hz", arguments.rate_hz, positive);
  const double most_ms = 1e3 * design::kMostPeriods / arguments.rate_hz;
  Require(arguments.delay_ms >= 0.0 && arguments.delay_ms <= most_ms, "--delay-ms", arguments.delay_ms,
          fmt::format("from 0 to {:g} ({:g} periods of --rate-hz)", most_ms, design::kMostPeriods));
}

// Beyond this range a double has too few digits to separate the poles z.
void CheckRate(const Design& design, double rate_hz) {
  constexpr double kFarthest = 1e6;
  double fastest = 0.0;
  for (const auto& poles : {design.open_poles, design.closed_poles}) {
    for (const Complex& pole : poles) {
      fastest = std::max(fastest, std::abs(pole));
    }
  }
  if (!std::isfinite(fastest)) {
    throw config::InputError(
        "--mass, --damping, --stiffness, --closed-loop-stiffness: magnitudes too different to compute with");
  }
  Require(rate_hz >= fastest / kFarthest && rate_hz <= fastest * kFarthest, "--rate-hz", rate_hz,
          fmt::format("from {:g} to {:g} for poles of {:g} rad/s", fastest / kFarthest, fastest * kFarthest,
                      fastest));
}

std::vector<std::string> Notes(const Design& design) {
  std::vector<std::string> notes;
  if (design.loop.gains.k_v < 0.0) {
    notes.emplace_back(
        "k_v is negative: the plant has more damping than requested, so the regulator reduces it and relies "
        "on b; a higher --damping-ratio or --closed-loop-stiffness avoids this");
  }
  if (design.loop.gains.k_p < 0.0) {
    notes.emplace_back(
        "k_p is negative: the plant is stiffer than requested, so the regulator pushes away from the goal "
        "and relies on k; a --closed-loop-stiffness above --stiffness avoids this");
  }
  if (design.loop.plant.stiffness == 0.0) {
    notes.emplace_back("k = 0: the open loop has no equilibrium position to return to");
  }
  if (design.discrete_poles.empty()) {
    notes.push_back(fmt::format("the discrete poles are not listed: the delay is longer than {:g} periods",
                                kMostPeriodsListed));
  }
  return notes;
}

Design Compute(const GainsArguments& arguments) {
  Design design;
  const design::SecondOrder plant{arguments.mass, arguments.damping, arguments.stiffness};
  const design::PdGains gains =
      design::DesignPd(plant, arguments.closed_loop_stiffness, arguments.damping_ratio);
  design.loop = {plant, gains, arguments.rate_hz, 1e-3 * arguments.delay_ms};
  design.closed = design::CloseLoop(plant, gains);
  const auto list = [](const auto& poles) { return std::vector<Complex>(poles.begin(), poles.end()); };
  design.open_poles = list(design::Poles(plant));
  design.closed_poles = list(design::Poles(design.closed));
  CheckRate(design, arguments.rate_hz);
  if (design.loop.delay_s * design.loop.rate_hz <= kMostPeriodsListed) {
    design.discrete_poles = design::Poles(design.loop);
  }
  design.stable = design::IsStable(design.loop);
  design.gain_edge = design::GainEdge(design.loop);
  design.delay_edge = design::DelayEdge(design.loop);
  design.notes = Notes(design);
  return design;
}

nlohmann::ordered_json Json(const std::vector<Complex>& poles) {
  auto list = nlohmann::ordered_json::array();
  for (const Complex& pole : poles) {
    list.push_back({pole.real(), pole.imag()});
  }
  return list;
}

// Infinity and NaN become null, because JSON has no number for them.
nlohmann::ordered_json Json(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json Json(const std::optional<double>& value, double unit = 1.0) {
  return value ? Json(unit * *value) : nlohmann::ordered_json(nullptr);
}

std::vector<Complex> Equivalent(const std::vector<Complex>& discrete_poles, double rate_hz) {
  std::vector<Complex> poles;
  poles.reserve(discrete_poles.size());
  for (const Complex& z : discrete_poles) {
    poles.push_back(design::EquivalentPole(z, rate_hz));
  }
  return poles;
}

std::string ToJson(const GainsArguments& arguments, const Design& design) {
  const design::SampledLoop& loop = design.loop;
  const bool listed = !design.discrete_poles.empty();
  nlohmann::ordered_json json;
  json["mass"] = arguments.mass;
  json["damping"] = arguments.damping;
  json["stiffness"] = arguments.stiffness;
  json["closed_loop_stiffness"] = arguments.closed_loop_stiffness;
  json["damping_ratio"] = arguments.damping_ratio;
  json["delay_ms"] = arguments.delay_ms;
  json["rate_hz"] = arguments.rate_hz;
  json["open_zeta"] = Json(design::DampingRatio(loop.plant));
  json["open_omega_n"] = design::NaturalFrequency(loop.plant);
  json["open_poles"] = Json(design.open_poles);
  json["k_p"] = loop.gains.k_p;
  json["k_v"] = loop.gains.k_v;
  json["closed_zeta"] = design::DampingRatio(design.closed);
  json["closed_omega_n"] = design::NaturalFrequency(design.closed);
  json["closed_settle_time_s"] = Json(design::SettlingTime(design.closed));
  json["closed_poles"] = Json(design.closed_poles);
  json["stable"] = design.stable;
  json["spectral_radius"] = listed ? Json(std::abs(design.discrete_poles.front())) : Json(std::nullopt);
  json["discrete_poles"] = listed ? Json(design.discrete_poles) : Json(std::nullopt);
  json["discrete_poles_as_s"] =
      listed ? Json(Equivalent(design.discrete_poles, loop.rate_hz)) : Json(std::nullopt);
  json["gain_edge"] = Json(design.gain_edge.at);
  json["gain_searched_to"] = design.gain_edge.searched_to;
  json["delay_edge_ms"] = Json(design.delay_edge.at, 1e3);
  json["delay_searched_to_ms"] = 1e3 * design.delay_edge.searched_to;
  json["notes"] = design.notes;
  return json.dump(2) + "\n";
}

// Conjugate pairs are written once. `digits`: number of significant digits.
std::string ToText(const std::vector<Complex>& poles, int digits) {
  std::string text;
  std::size_t shown = 0;
  std::size_t covered = 0;
  for (const Complex& pole : poles) {
    if (shown == kMostPolesShown) {
      break;
    }
    const bool real = std::fabs(pole.imag()) <= 1e-12 * std::abs(pole);
    ++covered;
    if (!real && pole.imag() < 0.0 && covered > 1 && poles[covered - 2] == std::conj(pole)) {
      continue;
    }
    text += text.empty() ? "" : ", ";
    text += real ? fmt::format("{:.{}g}", pole.real(), digits)
                 : fmt::format("{:.{}g} {} {:.{}g}j", pole.real(), digits,
                               covered < poles.size() && poles[covered] == std::conj(pole) ? "+/-" : "+",
                               pole.imag(), digits);
    ++shown;
  }
  return covered < poles.size() ? fmt::format("{}, and {} smaller", text, poles.size() - covered) : text;
}

void PrintRow(const char* name, const std::string& text) {
  config::PrintedTable table(config::StyleOf(STDOUT_FILENO));
  table.Row(name, text);
  fmt::print("{}", table.text());
}

std::string SystemText(const design::SecondOrder& system) {
  const double zeta = design::DampingRatio(system);
  const double omega_n = design::NaturalFrequency(system);
  return std::isfinite(zeta) ? fmt::format("zeta {:.6g}, omega_n {:.6g} rad/s", zeta, omega_n)
                             : "no zeta, omega_n 0 rad/s";
}

void PrintTable(const Design& design) {
  const design::SampledLoop& loop = design.loop;
  const design::PdGains& gains = loop.gains;
  PrintRow("open loop", SystemText(loop.plant));
  PrintRow("  poles", ToText(design.open_poles, 6) + " 1/s");
  PrintRow("f = -k_p x - k_v x'", fmt::format("k_p {:.6g} N/m, k_v {:.6g} N s/m", gains.k_p, gains.k_v));
  PrintRow("closed loop", SystemText(design.closed));
  PrintRow("  poles", ToText(design.closed_poles, 6) + " 1/s");
  const std::optional<double> settled = design::SettlingTime(design.closed);
  PrintRow("  step settled to 2 %", settled ? fmt::format("after {:.4g} s", *settled) : "never");
  PrintRow("sampled", fmt::format("at {:g} Hz, force {:g} ms after its sample: {}", loop.rate_hz,
                                  1e3 * loop.delay_s, design.stable ? "stable" : "UNSTABLE"));
  if (!design.discrete_poles.empty()) {
    PrintRow("  poles z", ToText(design.discrete_poles, 8));
    PrintRow("  as s", ToText(Equivalent(design.discrete_poles, loop.rate_hz), 5) + " 1/s");
  }
  const auto& [gain, gain_to] = design.gain_edge;
  PrintRow("  gain limit",
           gain ? fmt::format("{} from {:.6g} times both", design.stable ? "unstable" : "stable", *gain)
                : fmt::format("none up to {:g} times both", gain_to));
  const auto& [delay_s, delay_to_s] = design.delay_edge;
  PrintRow("  delay limit", !delay_s         ? fmt::format("none up to {:.6g} ms", 1e3 * delay_to_s)
                            : *delay_s > 0.0 ? fmt::format("unstable from {:.6g} ms", 1e3 * *delay_s)
                                             : "unstable without any delay");
  for (const std::string& note : design.notes) {
    PrintRow("note", note);
  }
}

}  // namespace

CLI::App* AddGains(CLI::App& app, GainsArguments& arguments) {
  CLI::App* gains = app.add_subcommand(
      "gains", "design a PD regulator for m x'' + b x' + k x = f, and report its stability margins");
  const auto number = [&](const char* flag, double& value, const char* meaning) {
    return gains->add_option(flag, value, meaning)->check(CLI::Number);
  };
  number("--mass", arguments.mass, "m > 0 [kg]")->required();
  number("--damping", arguments.damping, "b >= 0 [N s/m]")->required();
  number("--stiffness", arguments.stiffness, "k >= 0 [N/m]")->required();
  number("--closed-loop-stiffness", arguments.closed_loop_stiffness, "k + k_p > 0 [N/m]")->required();
  number("--damping-ratio", arguments.damping_ratio, "zeta > 0 of the closed loop")->capture_default_str();
  number("--delay-ms", arguments.delay_ms, "delay from a sample until its force acts, >= 0 [ms]")
      ->capture_default_str();
  number("--rate-hz", arguments.rate_hz, "sampling rate, > 0 [Hz]")->capture_default_str();
  gains->add_flag("--json", arguments.json, "print every figure by name instead of the table");
  gains->footer(
      "Examples:\n"
      "  fovea gains --mass 16 --damping 16 --stiffness 4 --closed-loop-stiffness 16\n"
      "  fovea gains --mass 2 --damping 0 --stiffness 0 --closed-loop-stiffness 800 --damping-ratio 0.7 "
      "--delay-ms 2.5\n"
      "  fovea gains --mass 1 --damping 4 --stiffness 0 --closed-loop-stiffness 100 --rate-hz 250 --json\n"
      "Exit: 0 done, 1 the sampled loop is unstable with this delay, 2 wrong usage or input.");
  return gains;
}

int Gains(const GainsArguments& arguments) {
  Check(arguments);
  const Design design = Compute(arguments);
  if (arguments.json) {
    fmt::print("{}", ToJson(arguments, design));
  } else {
    PrintTable(design);
  }
  return design.stable ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
