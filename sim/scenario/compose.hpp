// SPDX-License-Identifier: Apache-2.0
// Builds the simulator's parts from a scenario's keys, and checks keys against each other.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "sim/camera/lens.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/camera/shutter.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/robot/sim_robot.hpp"
#include "sim/scenario/commanded_motion.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

// Pose X_EC of the camera on the end effector.
Eigen::Isometry3d CameraMount(const Scenario& scenario);
// InputError: incomplete intrinsics, or a principal point outside the picture.
Pinhole MakeScenarioPinhole(const Scenario& scenario);
Lens MakeScenarioLens(const Scenario& scenario);
Shutter MakeScenarioShutter(const Scenario& scenario);
SensorConfig MakeScenarioSensor(const Scenario& scenario);
RenderScene MakeRenderScene(const Scenario& scenario, const SimRobot& robot);
// The motion of [motion]. Call it only if motion.kind is not "none".
CommandedMotion MakeMotion(const Scenario& scenario);

// Each consumer of random numbers has its own generator.
enum class RandomStream : std::uint8_t {
  kEncoders,
  kSensor,
  kArmFaults,
  kFrameFaults,
  kDetectorFaults,
  kStalls,
  kTarget,
  kBoardLine,
  kTruth,
  kDrives
};
std::uint64_t SeedOf(const Scenario& scenario, RandomStream stream);

// InputError: a list does not have one entry per joint.
void CheckSizes(const Scenario& scenario, const robots::Robot& robot);
// InputError: robot and servo together compensate more friction than there is.
void CheckFriction(const Scenario& scenario);
// Sets the scenario's springs, friction and rotors in the servo's model and in the physics.
void SetJoints(const Scenario& scenario, robots::Robot& robot, SimRobot& sim_robot);
// Adds `load` to the arm of the physics, if it has a mass; the servo's model includes it separately.
void AddLoad(const model::Load& load, SimRobot& robot);
// InputError: arm.q_start is outside the joints' range or the workspace, or arm.dq_start is too fast.
void CheckStart(const Scenario& scenario, const robots::Robot& robot);

// InputError: camera.lens cannot be drawn.
void CheckLens(const Scenario& scenario);
// InputError: a target at servo.goal would be invisible.
void CheckGoal(const Scenario& scenario);
// InputError: exposure, latency, frame rate or stale limit contradict each other.
void CheckTimes(const Scenario& scenario);

}  // namespace fovea::sim
