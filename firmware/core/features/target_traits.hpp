// SPDX-License-Identifier: Apache-2.0
// The kinds of targets, with all that other modules need to know of each: one line of a table per kind.
//
// Code that draws, detects, logs or steers by a target uses this table only. A new plate with corners needs
// another line here, and its own corners and pictures (firmware/README.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fovea/hal/feature.hpp"

namespace fovea::features {

// The features that the servo can steer by; target_feature.hpp lists them for each target.
enum class FeatureForm : std::uint8_t { kSphere, kCircle, kCorners, kSide, kCornerSide, kPose, kHybrid };
inline constexpr std::array<const char*, 7> kFormNames{"sphere",      "circle", "corners", "side",
                                                       "corner_side", "pose",   "hybrid"};

// Whether the form has, of a flat target, all six degrees of freedom. Otherwise it leaves some open.
[[nodiscard]] constexpr bool TakesWholePose(FeatureForm form) noexcept {
  return form == FeatureForm::kCorners || form == FeatureForm::kPose || form == FeatureForm::kHybrid;
}

// Whether the form consists of the target's picture alone.
[[nodiscard]] constexpr bool IsInImage(FeatureForm form) noexcept {
  return form != FeatureForm::kPose && form != FeatureForm::kHybrid;
}

// The shape of a target: a ball, a flat disc, or a flat plate with corners.
enum class TargetBody : std::uint8_t { kBall, kDisc, kPlate };

struct TargetTraits {
  hal::FeatureKind kind;
  const char* name;  // as in target.kind, logs and commands
  TargetBody body;
  int num_corners;  // of a plate; else 0
  int turns;  // equal-looking orientations in a full turn about O's z: a square's 4; a divisor of num_corners
  FeatureForm form;                  // the default
  std::array<FeatureForm, 5> forms;  // all of its features; `form` fills the rest

  // The first of its features that is in the image.
  [[nodiscard]] constexpr FeatureForm ImageForm() const noexcept {
    for (const FeatureForm one : forms) {
      if (IsInImage(one)) {
        return one;
      }
    }
    return form;
  }
};

// In the order of hal::FeatureKind.
inline constexpr std::array<TargetTraits, 4> kTargets{{
    {hal::FeatureKind::kSphere,
     "sphere",
     TargetBody::kBall,
     0,
     1,
     FeatureForm::kSphere,
     {FeatureForm::kSphere, FeatureForm::kCircle, FeatureForm::kPose, FeatureForm::kHybrid,
      FeatureForm::kSphere}},
    {hal::FeatureKind::kCircle,
     "circle",
     TargetBody::kDisc,
     0,
     1,
     FeatureForm::kCircle,
     {FeatureForm::kCircle, FeatureForm::kPose, FeatureForm::kHybrid, FeatureForm::kCircle,
      FeatureForm::kCircle}},
    {hal::FeatureKind::kSquare,
     "square",
     TargetBody::kPlate,
     4,
     4,
     FeatureForm::kCorners,
     {FeatureForm::kCorners, FeatureForm::kSide, FeatureForm::kCornerSide, FeatureForm::kPose,
      FeatureForm::kHybrid}},
    {hal::FeatureKind::kTriangle,
     "triangle",
     TargetBody::kPlate,
     3,
     1,
     FeatureForm::kPose,
     {FeatureForm::kPose, FeatureForm::kCorners, FeatureForm::kHybrid, FeatureForm::kPose,
      FeatureForm::kPose}},
}};

// `kind` is one of the table. Real-time: yes.
[[nodiscard]] constexpr const TargetTraits& TraitsOf(hal::FeatureKind kind) noexcept {
  return kTargets[static_cast<std::size_t>(kind)];
}

// The target of that name; null if there is none.
[[nodiscard]] constexpr const TargetTraits* FindTraits(std::string_view name) noexcept {
  for (const TargetTraits& target : kTargets) {
    if (name == target.name) {
      return &target;
    }
  }
  return nullptr;
}

inline constexpr std::array<const char*, kTargets.size()> kTargetNames = [] {
  std::array<const char*, kTargets.size()> names{};
  for (std::size_t i = 0; i < kTargets.size(); ++i) {
    names[i] = kTargets[i].name;
  }
  return names;
}();

}  // namespace fovea::features
