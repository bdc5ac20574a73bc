// From a scenario's keys to what the simulator is made of, and the checks that need more than one key.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "sim/camera/lens.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/robot/sim_robot.hpp"
#include "sim/scenario/commanded_motion.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// X_EC.
Eigen::Isometry3d CameraMount(const Scenario& scenario);
// std::runtime_error: intrinsics that are not whole, or that lie outside the picture.
Pinhole MakeScenarioPinhole(const Scenario& scenario);
Lens MakeScenarioLens(const Scenario& scenario);
WorldConfig MakeWorldConfig(const Scenario& scenario, const SimRobot& robot);
RenderScene MakeRenderScene(const Scenario& scenario, const SimRobot& robot);
// What [motion] commands; of interest when motion.kind says so.
CommandedMotion MakeMotion(const Scenario& scenario);

// Each consumer of random numbers has a generator of its own.
enum class RandomStream : std::uint8_t {
  kEncoders,
  kSensor,
  kArmFaults,
  kFrameFaults,
  kDetectorFaults,
  kStalls,
  kTarget,
  kBoardLine
};
std::uint64_t SeedOf(const Scenario& scenario, RandomStream stream);

// InputError when a list has not one entry per joint.
void CheckSizes(const Scenario& scenario, const robots::Robot& robot);
// InputError: robot and servo make up for more friction than there is.
void CheckFriction(const Scenario& scenario);
// Springs and friction as the scenario has them, for the servo's model and for the physics.
void SetFriction(const Scenario& scenario, robots::Robot& robot, SimRobot& sim_robot);
// The physics' arm carries `load` too, which the servo's model knows of.
void AddLoad(const model::Load& load, SimRobot& robot);
// InputError when arm.q_start is outside the joints' range or the workspace.
void CheckStart(const Scenario& scenario, const robots::Robot& robot);

// InputError when the arm starts within what the servo keeps out of.
void CheckOutside(const Scenario& scenario, const config::ServoConfig& servo);
// InputError when the lens of camera.k1, ... cannot be drawn.
void CheckLens(const Scenario& scenario);
// InputError when the target, standing at servo.goal, could not be seen.
void CheckGoal(const Scenario& scenario);
// InputError when exposure, latency, frame rate or stale limit contradict each other.
void CheckTimes(const Scenario& scenario);

}  // namespace fovea::sim
