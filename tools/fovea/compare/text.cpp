// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace fovea::compare {
namespace {

using nlohmann::ordered_json;

constexpr double kLeastShare = 0.1;  // of a cause that is named

constexpr std::array<const char*, kCauses> kNames{"friction", "rotor inertia", "torque bias", "load",
                                                  "torque delay"};
constexpr std::array<const char*, kCauses> kKeys{"friction", "rotor_inertia", "torque_bias", "load",
                                                 "torque_delay"};

std::string Value(const Comparison& c, std::size_t i, Cause cause) {
  const JointCauses& joint = c.causes.joints[i];
  const char* force = c.joints[i].slides ? "N" : "Nm";
  switch (cause) {
    case Cause::kFriction:
      return fmt::format("{:+.2g} {}, {:+.2g} {}", joint.coulomb, force, joint.viscous,
                         c.joints[i].slides ? "N s/m" : "Nm s/rad");
    case Cause::kRotor: return fmt::format("{:+.2g} {}", joint.rotor, c.joints[i].slides ? "kg" : "kg m^2");
    case Cause::kBias: return fmt::format("{:+.2g} {}", joint.bias, force);
    case Cause::kLoad: return fmt::format("{:+.2g} kg", c.causes.mass);
    case Cause::kDelay: break;
  }
  return fmt::format("{:+.2g} ms", 1e3 * c.causes.delay_s);
}

ordered_json ToJson(const Spread& spread) {
  return {{"rms", spread.rms}, {"worst", spread.worst}, {"worst_s", spread.worst_s}};
}

}  // namespace

std::string LikelyCauses(const Comparison& comparison, std::size_t i) {
  const std::array<double, kCauses>& share = comparison.causes.joints[i].share;
  std::array<int, kCauses> order{0, 1, 2, 3, 4};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return share[static_cast<std::size_t>(a)] > share[static_cast<std::size_t>(b)];
  });
  std::string text;
  for (const int cause : order) {
    const auto c = static_cast<std::size_t>(cause);
    if (share[c] >= kLeastShare) {
      text += fmt::format("{}{} {:.0f} % ({})", text.empty() ? "" : ", ", kNames[c], 100.0 * share[c],
                          Value(comparison, i, static_cast<Cause>(cause)));
    }
  }
  return text.empty() ? "-" : text;
}

std::string ToText(const std::string& log, const Comparison& comparison) {
  std::size_t width = 5;
  for (const JointFigures& joint : comparison.joints) {
    width = std::max(width, joint.name.size());
  }
  std::string text = fmt::format("{}: {} ticks, played into the simulated arm in windows of {} ms\n", log,
                                 comparison.ticks, comparison.window_ms);
  const bool all_turn = std::none_of(comparison.joints.begin(), comparison.joints.end(),
                                     [](const JointFigures& joint) { return joint.slides; });
  text += fmt::format("  {:<{}} {:>18} {:>26}\n", "", width, all_turn ? "position [mrad]" : "[mrad or mm]",
                      all_turn ? "missing torque [Nm]" : "[Nm or N]");
  text += fmt::format("  {:<{}} {:>8} {:>9} {:>9} {:>8} {:>7}  {}\n", "joint", width, "rms", "worst", "rms",
                      "worst", "at s", "likely cause: share, recorded less simulated");
  for (std::size_t i = 0; i < comparison.joints.size(); ++i) {
    const JointFigures& joint = comparison.joints[i];
    text += fmt::format("  {:<{}} {:>8.2g} {:>9.2g} {:>9.2g} {:>8.2g} {:>7.3f}  {}\n", joint.name, width,
                        1e3 * joint.q.rms, 1e3 * joint.q.worst, joint.torque.rms, joint.torque.worst,
                        joint.torque.worst_s, LikelyCauses(comparison, i));
  }
  return text;
}

std::string ToJson(const std::string& log, const Comparison& comparison,
                   const std::vector<std::string>& settings) {
  ordered_json json{{"log", log},
                    {"settings", settings},
                    {"window_ms", comparison.window_ms},
                    {"ticks", comparison.ticks},
                    {"windows", comparison.windows.size()},
                    {"load_mass", comparison.causes.mass},
                    {"torque_delay_ms", 1e3 * comparison.causes.delay_s},
                    {"joints", ordered_json::array()}};
  for (std::size_t i = 0; i < comparison.joints.size(); ++i) {
    const JointFigures& joint = comparison.joints[i];
    const JointCauses& causes = comparison.causes.joints[i];
    ordered_json shares;
    for (std::size_t c = 0; c < kCauses; ++c) {
      shares[kKeys[c]] = causes.share[c];
    }
    json["joints"].push_back({{"name", joint.name},
                              {"slides", joint.slides},
                              {"position", ToJson(joint.q)},
                              {"velocity", ToJson(joint.dq)},
                              {"acceleration", ToJson(joint.ddq)},
                              {"missing_torque", ToJson(joint.torque)},
                              {"shares", shares},
                              {"coulomb", causes.coulomb},
                              {"viscous", causes.viscous},
                              {"rotor_inertia", causes.rotor},
                              {"torque_bias", causes.bias},
                              {"likely_cause", LikelyCauses(comparison, i)}});
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea::compare
