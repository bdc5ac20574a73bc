// SPDX-License-Identifier: Apache-2.0
// Tests the simulator's drivers against their contracts.
#include <memory>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "sim/camera/on_demand_camera.hpp"
#include "sim/camera/sim_camera.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/contract/arm_contract.hpp"
#include "tests/contract/camera_contract.hpp"
#include "tests/contract/clock_contract.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

sim::WorldConfig PandaWorld() {
  sim::WorldConfig config;
  config.robot = sim::LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  config.q_start.resize(7);
  config.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
  return config;
}

struct SimArmFixture {
  sim::World world{PandaWorld()};
  sim::SimArm driver{world};
  hal::Arm& arm() { return driver; }
  void Advance() { world.AdvanceTo(world.now_ns() + hal::kTickPeriodNs); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(SimArm, ArmContract, SimArmFixture);

struct LockstepClockFixture {
  sim::World world{PandaWorld()};
  sim::LockstepClock driver{world, [](std::int64_t) { return true; }};
  hal::Clock& clock() { return driver; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(LockstepClock, ClockContract, LockstepClockFixture);

// The fault decorators are drivers, too.
struct FaultyArmFixture {
  sim::World world{PandaWorld()};
  sim::SimArm inner{world};
  sim::FaultyArm driver{inner, {}};
  hal::Arm& arm() { return driver; }
  void Advance() { world.AdvanceTo(world.now_ns() + hal::kTickPeriodNs); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(FaultyArm, ArmContract, FaultyArmFixture);

struct StallingClockFixture {
  sim::World world{PandaWorld()};
  sim::LockstepClock inner{world, [](std::int64_t) { return true; }};
  sim::StallingClock driver{inner, {{0.001, 0.004}, 0.5, 1}};
  hal::Clock& clock() { return driver; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(StallingClock, ClockContract, StallingClockFixture);

struct RealPaceClockFixture {
  sim::World world{PandaWorld()};
  linux_rt::MonotonicClock monotonic;
  sim::RealPaceClock driver{world, monotonic, [](std::int64_t) { return true; }};
  hal::Clock& clock() { return driver; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(RealPaceClock, ClockContract, RealPaceClockFixture);

// A camera with `driver`, which takes numbered exposures.
template <class Driven>
struct ExposedFixture : Driven {
  std::uint64_t next = 0;
  hal::Camera& camera() { return this->driver; }
  void Expose(std::int64_t stamp_ns) {
    sim::Exposure exposure;
    exposure.sequence = next++;
    exposure.stamp_ns = stamp_ns;
    this->driver.Expose(exposure);
  }
  void Close() { this->driver.Close(); }
};

// Two painters. Each fills the picture with the sequence number of the exposure.
struct SimCameraDriven {
  static sim::Painter Painter() {
    return {[](const sim::Exposure& exposure, std::span<std::uint8_t> rgba) {
              std::fill(rgba.begin(), rgba.end(), static_cast<std::uint8_t>(exposure.sequence));
            },
            {}};
  }
  sim::SimCamera driver{{.width_px = 64, .height_px = 48, .exposure_ns = 1000, .queue = 16},
                        sim::Sensor({.read_sigma = 2.0}, 1),
                        {Painter(), Painter()}};
};
INSTANTIATE_TYPED_TEST_SUITE_P(SimCamera, CameraContract, ExposedFixture<SimCameraDriven>);

struct OnDemandCameraDriven {
  sim::OnDemandCamera driver{
      {.width_px = 64, .height_px = 48, .exposure_ns = 1000, .queue = 16},
      sim::Sensor({.read_sigma = 2.0}, 1),
      [](const sim::Exposure& exposure, std::span<const sim::PictureArea>, std::span<std::uint8_t> rgba) {
        std::fill(rgba.begin(), rgba.end(), static_cast<std::uint8_t>(exposure.sequence));
      },
      [] {}};
};
INSTANTIATE_TYPED_TEST_SUITE_P(OnDemandCamera, CameraContract, ExposedFixture<OnDemandCameraDriven>);

}  // namespace
}  // namespace fovea::test
