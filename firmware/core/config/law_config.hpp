// SPDX-License-Identifier: Apache-2.0
// [servo] the visual law: how the arm moves to reduce the feature's error.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/core/config/fields.hpp"
#include "firmware/core/features/target_traits.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::config {

// The visual laws; core/control/visual_laws.hpp has what each computes.
enum class Law : std::uint8_t { kIbvs, kPbvs, kHybrid, kMean, kDesired, kSecondOrder, kPredictive };

struct LawTraits {
  const char* name;
  // The feature of a law that is not on the target's picture alone. The others take any in the image.
  std::optional<features::FeatureForm> form = std::nullopt;
};

// In the order of Law.
inline constexpr std::array<LawTraits, 7> kLaws{{{"ibvs"},
                                                 {"pbvs", features::FeatureForm::kPose},
                                                 {"hybrid", features::FeatureForm::kHybrid},
                                                 {"mean"},
                                                 {"desired"},
                                                 {"second_order"},
                                                 {"predictive"}}};

inline constexpr std::array<const char*, kLaws.size()> kLawNames = [] {
  std::array<const char*, kLaws.size()> names{};
  for (std::size_t i = 0; i < kLaws.size(); ++i) {
    names[i] = kLaws[i].name;
  }
  return names;
}();

[[nodiscard]] constexpr const LawTraits& TraitsOf(Law law) noexcept {
  return kLaws[static_cast<std::size_t>(law)];
}

// The law of a feature if none is named.
[[nodiscard]] constexpr Law LawOf(features::FeatureForm form) noexcept {
  for (std::size_t i = 0; i < kLaws.size(); ++i) {
    if (kLaws[i].form == form) {
      return static_cast<Law>(i);
    }
  }
  return Law::kIbvs;
}

struct LawConfig {
  double lambda = 2.0;
  double lambda_near = 0.0;
  double lambda_slope = 30.0;
  Law law = Law::kIbvs;
  double smooth_start_s = 0.25;
  double damping = 0.05;
  double posture_gain = 0.6;
  double joint_limit_gain = 0.0;
  double manipulability_gain = 0.0;
  double free_speed = 0.3;
  hal::JointArray q_posture{};
  double unreachable_s = 1.0;
  double unreachable_progress = 0.05;
  bool plans = true;
};

template <class Visitor, Struct<LawConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Number({"servo.lambda", "1/s", "gain: the error decays like exp(-lambda t)", kInMotion<0>}, c.lambda, 0.0,
           20.0);
  v.Number(
      {"servo.lambda_near", "1/s",
       "gain near the goal; servo.lambda applies to large errors; 0: servo.lambda everywhere", kInMotion<1>},
      c.lambda_near, 0.0, 20.0);
  v.Number(
      {"servo.lambda_slope", "1/s", "slope of the gain over the feature's error, at error 0", kInMotion<2>},
      c.lambda_slope, 0.0, 1e6);
  v.Choice(
      {"servo.law", "",
       "visual law; auto: that of servo.feature, ibvs unless it is pose or hybrid. ibvs: on the picture; "
       "pbvs: on the pose; hybrid: place in the picture, ln Z and turn; mean, desired: on the picture, "
       "with the mean of the interaction matrices of now and of the goal, or that of the goal; "
       "second_order: on the picture, commands its acceleration; predictive: as mean, along horizons that "
       "the "
       "planner beside the tick computes for the whole picture, ahead of all limits"},
      c.law, kLawNames);
  v.Number({"servo.smooth_start_s", "s", "the law is blended in over this time"}, c.smooth_start_s, 0.001,
           10.0);
  v.Number({"servo.damping", "",
            "the task is damped in directions whose singular value is below this share of the rms one",
            kInMotion<3>},
           c.damping, 1e-6, 1.0);
  v.Number({"servo.posture_gain", "1/s", "pull of the posture in the directions that the feature leaves free",
            kInMotion<4>},
           c.posture_gain, 0.0, 20.0);
  v.Number({"servo.joint_limit_gain", "1/s",
            "pull away from the ends of the joints' ranges in the free directions", kInMotion<5>},
           c.joint_limit_gain, 0.0, 20.0);
  v.Number({"servo.manipulability_gain", "rad^2/s", "pull towards more manipulability in the free directions",
            kInMotion<6>},
           c.manipulability_gain, 0.0, 20.0);
  v.Number({"servo.free_speed", "rad/s", "speed limit of these three pulls together", kInMotion<7>},
           c.free_speed, 1e-6, 10.0);
  v.PerJoint({"servo.posture", "rad",
              "posture that servo.posture_gain pulls to, one per joint; default: the arm's ready posture"},
             c.q_posture, -1e4, 1e4);
  v.Number({"servo.unreachable_s", "s", "Hold after limits block the arm from its goal for this time"},
           c.unreachable_s, 0.001, 60.0);
  v.Number({"servo.unreachable_progress", "",
            "the arm counts as blocked if limits leave less than this share of the wanted motion"},
           c.unreachable_progress, 0.0, 1.0);
  v.Flag({"servo.plans", "",
          "far from its goal, and where limits stop the law, the arm follows a plan; false: the law alone"},
         c.plans);
}

}  // namespace fovea::config
