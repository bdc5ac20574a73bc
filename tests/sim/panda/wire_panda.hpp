// SPDX-License-Identifier: Apache-2.0
// A simulated Panda for the tests of its interface, without and with a network.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fovea/franka/franka_arm.hpp"
#include "sim/panda/robot.hpp"
#include "sim/panda/server.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {

inline sim::WorldConfig WirePandaWorld() {
  sim::WorldConfig config;
  config.robot = sim::LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  config.q_start.resize(7);
  config.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
  config.encoder_noise = 1e-5;
  config.velocity_noise = 5e-4;
  return config;
}

// A robot without a network.
struct PandaAlone {
  explicit PandaAlone(const sim::WorldConfig& config = WirePandaWorld(),
                      std::vector<sim::CartesianWall> walls = {})
      : world(config), robot(world, config.robot, std::move(walls)) {}
  sim::World world;
  sim::FciRobot robot;
};

// A served robot, in its own thread, on a free port.
class ServedPanda {
 public:
  explicit ServedPanda(const sim::FciServerConfig& config, const sim::WorldConfig& world = WirePandaWorld())
      : panda_(world),
        server_(panda_.robot, OnFreePort(config)),
        thread_([this] { server_.Run(stop_, [](const auto&) {}); }) {}
  ~ServedPanda() { Stop(); }
  ServedPanda(const ServedPanda&) = delete;
  ServedPanda& operator=(const ServedPanda&) = delete;

  // After this call, counters and robot may be read.
  void Stop() {
    stop_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  [[nodiscard]] std::uint16_t port() const { return server_.port(); }
  [[nodiscard]] sim::FciServer& server() { return server_; }
  [[nodiscard]] PandaAlone& panda() { return panda_; }

  [[nodiscard]] franka::FrankaConfig ClientConfig() const {
    franka::FrankaConfig config;
    config.host = "127.0.0.1";
    config.port = port();
    config.state_timeout_ns = 3 * hal::kNsPerSecond;
    return config;
  }

 private:
  static sim::FciServerConfig OnFreePort(const sim::FciServerConfig& config) {
    sim::FciServerConfig free = config;
    free.at.port = 0;
    return free;
  }

  PandaAlone panda_;
  std::atomic<bool> stop_{false};
  sim::FciServer server_;
  std::thread thread_;
};

inline sim::FciServerConfig Lockstep() {
  sim::FciServerConfig config;
  config.lockstep = true;
  return config;
}

// Reads states and writes zero torque until a motion runs.
inline void StartMotion(franka::FrankaArm& arm) {
  hal::ArmState state;
  hal::ArmCommand command;
  command.num_joints = 7;
  for (int k = 0; k < 500 && arm.phase() != franka::MotionPhase::kRunning; ++k) {
    ASSERT_TRUE(arm.Read(state).ok()) << arm.failure();
    ASSERT_TRUE(arm.Write(command).ok());
  }
  ASSERT_EQ(arm.phase(), franka::MotionPhase::kRunning);
}

}  // namespace fovea::test
