// SPDX-License-Identifier: Apache-2.0
// Random starts for the planner: an arm, a camera, a target, and where they are. Drawn as the atlas draws
// them (tools/fovea/atlas/sampler.hpp), but refused for geometry alone: start and target have to be allowed.
#pragma once

#include <string>

#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::test {

// The camera of the scenario `ball`: 640 x 480 pixels, 60 degrees.
inline vision::Intrinsics BallCamera() {
  const double f = 320.0 / std::tan(model::kPi / 6.0);
  return {640, 480, f, f, 319.5, 239.5};
}

// The servo as the simulator's scenarios configure it, before a table at z = 0.
inline config::ServoConfig PlannedServo(const std::string& arm, const std::string& target) {
  config::ServoSettings settings;
  settings.planes = {0.0, 0.0, 1.0, 0.01};
  config::TargetSettings kind;
  kind.kind = target;
  const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/" + arm + ".toml");
  return config::MakeServoConfig(settings, {arm, robot.model, {}}, DefaultMount(), BallCamera(), kind);
}

class PlannedStarts {
 public:
  PlannedStarts(const config::ServoConfig& config, unsigned seed) : config_(config), random_(seed) {}

  // The next start that is allowed.
  trajectory::PlanRequest Next() {
    trajectory::PlanRequest request;
    do {
      Draw(request);
    } while (!IsAllowed(request));
    return request;
  }

 private:
  void Draw(trajectory::PlanRequest& request) {
    constexpr double kMargin = 5.0 / 180.0 * model::kPi;
    const int n = config_.arm.num_joints;
    trajectory::Reference& start = request.start;
    start.q.resize(n);
    start.dq.setZero(n);
    start.ddq.setZero(n);
    for (int i = 0; i < n; ++i) {
      const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
      start.q[i] = random_.Uniform(joint.q_min + kMargin, joint.q_max - kMargin);
    }
    const vision::Intrinsics camera = BallCamera();
    const double depth = random_.Uniform(0.25, 0.90);
    const double tilt = random_.Uniform(0.0, 0.25 * model::kPi);
    const double about = random_.Uniform(-model::kPi, model::kPi);
    const model::Vec3 ray = camera.Ray(random_.Uniform(0.0, 639.0), random_.Uniform(0.0, 479.0));
    model::Pose X_CO;
    X_CO.p = depth * ray;
    X_CO.R = model::RotationOf({tilt * std::cos(about), tilt * std::sin(about), 0.0}) *
             model::RotationOf({0.0, 0.0, random_.Uniform(-model::kPi, model::kPi)});
    model::ComputePoses(config_.arm, start.q, poses_);
    request.X_BO = poses_.X_BE * config_.X_EC * X_CO;
    const bool is_disc = features::TraitsOf(config_.feature.target).body == features::TargetBody::kDisc;
    request.normal_B = is_disc ? model::Vec3(request.X_BO.R.col(2)) : model::Vec3(model::Vec3::Zero());
  }

  // Inside the workspace, clear of the table and of itself; the target 30 px inside the picture, in sight and
  // above the table.
  [[nodiscard]] bool IsAllowed(const trajectory::PlanRequest& request) const {
    constexpr double kClear = 0.02;  // [m]
    const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, poses_);
    const barriers::SolidBarriers solid(config_);
    bool allowed = true;
    for (int i = 0; i < solid.size(); ++i) {
      allowed = allowed && solid.ValueOf(i, poses_, bodies) > solid.StopMarginOf(i) + kClear;
    }
    const model::Pose X_BC = poses_.X_BE * config_.X_EC;
    const features::TargetOutline outline = config_.feature.Outline();
    allowed = allowed && barriers::ClearanceOfSight(
                             {poses_, bodies, X_BC, outline, request.X_BO, config_.guard.obstacles}) > 0.01;
    const vision::Intrinsics camera = BallCamera();
    for (int i = 0; i < outline.num_points; ++i) {
      const model::Vec3 p_BP = request.X_BO * outline.p_OP[static_cast<std::size_t>(i)];
      const model::Vec3 p_C = X_BC.Inverse() * p_BP;
      const double edge = 30.0 + camera.f_u_px * outline.radius / p_C.z();
      const double u = camera.U(p_C);
      const double v = camera.V(p_C);
      allowed = allowed && p_BP.z() > outline.radius && u > edge && u < 639.0 - edge && v > edge &&
                v < 479.0 - edge;
    }
    return allowed;
  }

  const config::ServoConfig& config_;
  RandomStates random_;
  model::ArmPoses poses_;
};

}  // namespace fovea::test
