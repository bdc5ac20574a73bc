// SPDX-License-Identifier: Apache-2.0
// The client and the served robot together, tested against the contract of arms.
#include "tests/contract/arm_contract.hpp"
#include "tests/sim/panda/wire_panda.hpp"

namespace fovea::test {
namespace {

struct WireArmFixture {
  ServedPanda served{Lockstep()};
  franka::RobotClock clock;
  franka::FrankaArm driver{served.ClientConfig(), &clock};
  WireArmFixture() { StartMotion(driver); }
  hal::Arm& arm() { return driver; }
  // The robot's time advances with its states.
  void Advance() {
    hal::ArmState ignored;
    ASSERT_TRUE(driver.Read(ignored).ok()) << driver.failure();
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(FrankaOnTheWire, ArmContract, WireArmFixture);

}  // namespace
}  // namespace fovea::test
