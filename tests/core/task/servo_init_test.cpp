// SPDX-License-Identifier: Apache-2.0
// Init refuses a configuration that cannot work and names the key.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "firmware/core/task/servo_task.hpp"
#include "tests/support/panda.hpp"

namespace fovea::task {
namespace {

struct Case {
  const char* where;
  std::function<void(config::ServoConfig&)> spoil;
};

TEST(ServoInitTest, AcceptsTheDefaults) {
  ServoTask task;
  EXPECT_TRUE(task.Init(test::PandaConfig()).ok());
}

TEST(ServoInitTest, RefusesABadValueAndNamesTheKey) {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Case> cases = {
      {"arm.num_joints", [](config::ServoConfig& c) { c.arm.num_joints = 0; }},
      {"arm.num_joints", [](config::ServoConfig& c) { c.arm.num_joints = 9; }},
      {"joint position range", [](config::ServoConfig& c) { c.arm.joints[2].q_max = -3.0; }},
      {"joint velocity, acceleration or jerk limit",
       [](config::ServoConfig& c) { c.arm.joints[2].ddq_max = 0.0; }},
      {"joint torque limit", [=](config::ServoConfig& c) { c.arm.joints[2].dtau_max = nan; }},
      {"link inertia", [](config::ServoConfig& c) { c.arm.links[6].mass = 0.0; }},
      {"joint frame", [=](config::ServoConfig& c) { c.arm.joints[0].X_PJ.p.x() = nan; }},
      {"arm.shape.bodies", [=](config::ServoConfig& c) { c.arm.shape.bodies[5].radius = nan; }},
      {"arm.shape.bodies", [](config::ServoConfig& c) { c.arm.shape.bodies[5].radius = -0.05; }},
      {"arm.shape.bodies", [=](config::ServoConfig& c) { c.arm.shape.bodies[0].p_LB.z() = infinity; }},
      {"arm.shape.num_pairs", [](config::ServoConfig& c) { c.arm.shape.num_pairs = 22; }},
      {"arm.shape.pairs",
       [](config::ServoConfig& c) {
         c.arm.shape.pairs[0] = {1, 8};
       }},
      {"arm.shape.pairs",
       [](config::ServoConfig& c) {
         c.arm.shape.pairs[0] = {5, 5};
       }},
      {"target.diameter", [](config::ServoConfig& c) { c.feature.radius = 0.0; }},
      {"servo.goal", [](config::ServoConfig& c) { c.feature.p_CO_C_star.z() = -0.4; }},
      {"servo.goal", [=](config::ServoConfig& c) { c.feature.p_CO_C_star.x() = nan; }},
      {"servo.feature", [](config::ServoConfig& c) { c.feature.form = features::FeatureForm::kCorners; }},
      {"servo.goal",
       [](config::ServoConfig& c) {
         c.feature.target = hal::FeatureKind::kSquare;
         c.feature.form = features::FeatureForm::kCorners;
         c.feature.corners = features::MakeSquare(1.0);  // turned so that a corner is behind the camera
         c.feature.R_CO_star << 0, 0, 1, 0, 1, 0, -1, 0, 0;
       }},
      {"safety.view_margin_px", [](config::ServoConfig& c) { c.guard.view.enabled = true; }},
      {"safety.sight_clearance", [](config::ServoConfig& c) { c.guard.sight_clearance = -0.1; }},
      {"safety.disc_tilt_max", [](config::ServoConfig& c) { c.guard.view.disc_cosine_min = -0.1; }},
      {"servo.damping", [](config::ServoConfig& c) { c.law.damping = 1e-7; }},
      {"servo.lambda_near", [](config::ServoConfig& c) { c.law.lambda_near = -1.0; }},
      {"servo.posture", [=](config::ServoConfig& c) { c.law.q_posture[0] = nan; }},
      {"camera.mount_xyz", [=](config::ServoConfig& c) { c.X_EC.p.x() = nan; }},
      {"joint position range", [=](config::ServoConfig& c) { c.arm.joints[4].q_max = infinity; }},
      {"joint velocity, acceleration or jerk limit",
       [=](config::ServoConfig& c) { c.arm.joints[2].dq_max = infinity; }},
      {"safety.joint_position_margin",
       [](config::ServoConfig& c) { c.arm.joints[5].q_max = c.arm.joints[5].q_min + 0.03; }},
      {"servo.lambda", [=](config::ServoConfig& c) { c.law.lambda = nan; }},
      {"servo.stale_s", [](config::ServoConfig& c) { c.predict.stale_s = 2.0 * c.predict.coast_s; }},
      {"servo.omega_n", [](config::ServoConfig& c) { c.motion_law.omega_n = 81.0; }},
      {"servo.integral",
       [](config::ServoConfig& c) {
         c.motion_law.integral = 1.01 * c.motion_law.zeta * c.motion_law.omega_n;
       }},
      {"servo.zeta",
       [](config::ServoConfig& c) {
         c.motion_law.omega_n = 80.0;
         c.motion_law.zeta = 2.6;  // 416 1/s
       }},
      {"servo.k_v",
       [](config::ServoConfig& c) {
         c.motion_law.kind = config::MotionLawKind::kPd;
         c.motion_law.k_v[6] = 1.0;  // on 0.005 kg m^2
       }},
      {"safety.joint_acceleration_fraction",
       [](config::ServoConfig& c) { c.guard.joint_acceleration_fraction = 0.9; }},
      {"safety.torque_fraction",
       [](config::ServoConfig& c) {
         c.arm.joints[5].tau_max = 0.02;  // too little to accelerate the hand
       }},
      {"safety.rotation_speed", [](config::ServoConfig& c) { c.guard.rotation_speed = 0.19; }},
      {"safety.joint_velocity_fraction",
       [](config::ServoConfig& c) { c.guard.joint_velocity_fraction = 1.5; }},
      {"safety.workspace_radius", [](config::ServoConfig& c) { c.guard.workspace_radius = 0.0; }},
      {"safety.torque_fraction", [](config::ServoConfig& c) { c.safety.torque_fraction = 1.1; }},
      {"safety.missed_ticks", [](config::ServoConfig& c) { c.safety.missed_ticks = 0; }},
      {"servo.k_p", [](config::ServoConfig& c) { c.motion_law.k_p[3] = -1.0; }},
      {"servo.k_v", [=](config::ServoConfig& c) { c.motion_law.k_v[3] = infinity; }},
      {"joint friction or spring", [](config::ServoConfig& c) { c.arm.joints[1].coulomb = -0.1; }},
      {"joint friction or spring", [=](config::ServoConfig& c) { c.arm.joints[1].spring = nan; }},
      {"rotor inertia", [](config::ServoConfig& c) { c.arm.joints[2].rotor_inertia = -0.1; }},
      {"rotor inertia", [=](config::ServoConfig& c) { c.arm.joints[2].rotor_inertia = infinity; }},
      {"safety.planes", [](config::ServoConfig& c) { c.guard.obstacles.num_planes = -1; }},
      {"safety.boxes",
       [](config::ServoConfig& c) { c.guard.obstacles.num_boxes = config::Obstacles::kMost + 1; }},
      {"safety.planes",
       [](config::ServoConfig& c) {
         c.guard.obstacles.num_planes = 1;
         c.guard.obstacles.planes[0].normal = model::Vec3(0.0, 0.0, 2.0);
       }},
      {"safety.planes",
       [=](config::ServoConfig& c) {
         c.guard.obstacles.num_planes = 1;
         c.guard.obstacles.planes[0].distance = nan;
       }},
      {"safety.boxes",
       [](config::ServoConfig& c) {
         c.guard.obstacles.num_boxes = 1;
         c.guard.obstacles.boxes[0] = {model::Vec3(0.0, 0.0, 0.0), model::Vec3(1.0, 0.0, 1.0)};
       }},
      {"safety.boxes",
       [=](config::ServoConfig& c) {
         c.guard.obstacles.num_boxes = 1;
         c.guard.obstacles.boxes[0] = {model::Vec3(0.0, 0.0, 0.0), model::Vec3(1.0, infinity, 1.0)};
       }},
      {"servo.motion_law",
       [](config::ServoConfig& c) {
         c.arm.num_joints = 1;
         c.arm.shape.num_pairs = 0;
         c.motion_law.kind = config::MotionLawKind::kOperationalSpace;
       }},
  };
  for (const Case& c : cases) {
    config::ServoConfig config = test::PandaConfig();
    c.spoil(config);
    ServoTask task;
    const hal::Status status = task.Init(config);
    EXPECT_FALSE(status.ok()) << c.where;
    EXPECT_STREQ(status.where(), c.where);
  }
}

}  // namespace
}  // namespace fovea::task
