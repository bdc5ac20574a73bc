// SPDX-License-Identifier: Apache-2.0
// The runs of a contact study: motions of the servo, the draws of what it believes wrongly, and the pushes.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::contact {

struct Motion {
  const char* name;
  const char* scenario;
  std::vector<std::string> assignments;
  double quiet_s;                  // duration of a run without a push
  std::array<double, 2> pushed_s;  // a push begins between these times
};
std::span<const Motion> Motions();

// Forces of the pushes [N], and how long they act [s].
inline constexpr std::array kForces{5.0, 10.0, 20.0, 40.0};
inline constexpr double kPushS = 0.3;

enum class Place : std::uint8_t { kHand, kElbow };
inline constexpr std::array kPlaces{Place::kHand, Place::kElbow};
const char* Name(Place place);

// What is not as the servo believes, as assignments of [truth]: each link's mass by up to 20 %, the load by
// -0.2 to +0.3 kg, friction by half. `draw` 0 and 1: all masses are 20 % larger, 20 % smaller.
std::vector<std::string> WrongBeliefs(std::mt19937_64& random, int draw, int num_joints);

// A push: where, in which direction in B, and when.
struct Push {
  Place place = Place::kHand;
  model::Vec3 direction_B = model::Vec3::UnitX();
  double from_s = 0.0;
};
Push DrawPush(std::mt19937_64& random, Place place, const Motion& motion);

// The assignments of [faults] for this push with `force` [N] on the arm at posture `q`: the joints' torques.
std::vector<std::string> AssignmentsOf(const Push& push, double force, const model::ArmModel& arm,
                                       const std::vector<double>& q);

}  // namespace fovea::contact
