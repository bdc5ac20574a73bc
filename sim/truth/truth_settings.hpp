// SPDX-License-Identifier: Apache-2.0
// The keys of section [truth]: what is true of arm, camera and target, where it is not what the servo
// believes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "firmware/host/config/key_table.hpp"
#include "sim/truth/deviation.hpp"

namespace fovea::sim {

// What may differ, in order of their keys. Random draws depend on the order: a new one comes last.
enum class Quantity : std::uint8_t {
  kMountXyz,
  kMountTurn,
  kFocalLength,
  kAspect,
  kPrincipalPoint,
  kLens,
  kLatency,
  kLatencyJitter,
  kClockDrift,
  kLinkMasses,
  kLinkCentres,
  kViscousFriction,
  kCoulombFriction,
  kLoadMass,
  kLoadCentre,
  kEncoderZeros,
  kTorqueScales,
  kTorqueBiases,
  kBaseTilt,
  kTargetScale,
  kRotorInertias,
  kRowTime,
};
inline constexpr std::size_t kNumQuantities = 22;

struct QuantityInfo {
  const char* key;   // without "truth."
  const char* unit;  // "" if it has none
  double low;        // the smallest true value
  double high;
  const char* meaning;
};
const QuantityInfo& InfoOf(Quantity quantity);

struct TruthSettings {
  std::array<Deviation, kNumQuantities> of;

  [[nodiscard]] bool IsAny() const;
};

// The settings must outlive the table. A form of a deviation has no meaning of its own: see KeysAsMarkdown.
void AddTruthKeys(TruthSettings& settings, config::KeyTable& keys);

// The forms of a deviation, for a terminal and as Markdown.
std::string TruthFormsAsText();
std::string TruthFormsAsMarkdown();

}  // namespace fovea::sim
