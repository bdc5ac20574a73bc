// SPDX-License-Identifier: Apache-2.0
// Every row of firmware/GUARDS.md is provoked in closed loop: a row without a provocation fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

#include "fovea/hal/events.hpp"
#include "tests/closed_loop/guard_provocations.hpp"

namespace fovea::test {
namespace {

template <typename Row>
struct Provocation {
  Row row;
  void (*provoke)();
};

constexpr std::array kLimits{
    Provocation<hal::Limit>{hal::Limit::kJointPosition, ProvokeJointPosition},
    Provocation<hal::Limit>{hal::Limit::kJointVelocity, ProvokeJointVelocity},
    Provocation<hal::Limit>{hal::Limit::kJointAcceleration, ProvokeJointAcceleration},
    Provocation<hal::Limit>{hal::Limit::kJointJerk, ProvokeJointJerk},
    Provocation<hal::Limit>{hal::Limit::kWorkspace, ProvokeWorkspace},
    Provocation<hal::Limit>{hal::Limit::kTorque, ProvokeTorque},
    Provocation<hal::Limit>{hal::Limit::kTorqueRate, ProvokeTorqueRate},
    Provocation<hal::Limit>{hal::Limit::kObstacle, ProvokeObstacle},
    Provocation<hal::Limit>{hal::Limit::kCartesianSpeed, ProvokeCartesianSpeed},
    Provocation<hal::Limit>{hal::Limit::kSingularity, ProvokeSingularity},
    Provocation<hal::Limit>{hal::Limit::kFieldOfView, ProvokeFieldOfView},
    Provocation<hal::Limit>{hal::Limit::kRotationSpeed, ProvokeRotationSpeed},
};

constexpr std::array kFaults{
    Provocation<hal::Fault>{hal::Fault::kArmLost, ProvokeArmLost},
    Provocation<hal::Fault>{hal::Fault::kArmStale, ProvokeArmStale},
    Provocation<hal::Fault>{hal::Fault::kNonFiniteSensor, ProvokeNonFiniteSensor},
    Provocation<hal::Fault>{hal::Fault::kNonFiniteFeature, ProvokeNonFiniteFeature},
    Provocation<hal::Fault>{hal::Fault::kNonFiniteControl, ProvokeNonFiniteControl},
    Provocation<hal::Fault>{hal::Fault::kDeadlineMissed, ProvokeDeadlineMissed},
    Provocation<hal::Fault>{hal::Fault::kJointPosition, ProvokeJointOutside},
    Provocation<hal::Fault>{hal::Fault::kJointVelocity, ProvokeJointTooFast},
    Provocation<hal::Fault>{hal::Fault::kNotFollowing, ProvokeNotFollowing},
    Provocation<hal::Fault>{hal::Fault::kContact, ProvokeContact},
};

template <typename Row, std::size_t kSize>
void Provoke(const std::array<Provocation<Row>, kSize>& provocations, Row row) {
  const auto found = std::find_if(provocations.begin(), provocations.end(),
                                  [&](const auto& provocation) { return provocation.row == row; });
  ASSERT_NE(found, provocations.end()) << "no test provokes " << hal::Name(row);
  found->provoke();
}

class GuardLimits : public testing::TestWithParam<int> {};
TEST_P(GuardLimits, ActsInTimeAndIsNotExceeded) { Provoke(kLimits, static_cast<hal::Limit>(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Row, GuardLimits, testing::Range(0, hal::kNumLimits), [](const auto& row) {
  return std::string(hal::Name(static_cast<hal::Limit>(row.param)));
});

class GuardFaults : public testing::TestWithParam<int> {};
TEST_P(GuardFaults, StopsTheArmInTime) { Provoke(kFaults, static_cast<hal::Fault>(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Row, GuardFaults, testing::Range(1, hal::kNumFaults), [](const auto& row) {
  return std::string(hal::Name(static_cast<hal::Fault>(row.param)));
});

}  // namespace
}  // namespace fovea::test
