// SPDX-License-Identifier: Apache-2.0
// The canonical tasks start where their names say.
#include "tools/fovea/laws/tasks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/model/rotation.hpp"
#include "tools/fovea/atlas/scene.hpp"

namespace fovea::laws {
namespace {

// The camera at the start of `task`, in its goal's frame.
model::Pose StartInGoal(const atlas::Scene& scene, const Task& task) {
  model::VecN q(static_cast<Eigen::Index>(task.start.q.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    q[i] = task.start.q[static_cast<std::size_t>(i)];
  }
  model::ArmPoses poses;
  model::ComputePoses(scene.servo.arm, q, poses);
  const model::Pose X_BC = poses.X_BE * scene.servo.X_EC;
  const features::TargetFeature& feature = scene.servo.feature;
  const model::Pose X_BD =
      task.start.TargetPose() * model::Pose{feature.R_CO_star, feature.p_CO_C_star}.Inverse();
  return X_BD.Inverse() * X_BC;
}

class LawTasks : public testing::TestWithParam<const char*> {};

TEST_P(LawTasks, StartWhereTheySay) {
  const atlas::Scene scene = atlas::LoadScene(GetParam(), atlas::SceneAssignments({"servo.plans=false"}));
  const Tasks tasks = TasksFor(scene, 3, 5);
  EXPECT_TRUE(tasks.skipped.empty()) << tasks.skipped.front();
  ASSERT_GE(tasks.tasks.size(), 15U);
  int random = 0;
  for (const Task& task : tasks.tasks) {
    random += task.is_random ? 1 : 0;
    const model::Pose X_DC = StartInGoal(scene, task);
    const double deg = model::RotationVector(X_DC.R).norm() * 180.0 / M_PI;
    int number = 0;
    if (std::sscanf(task.name.c_str(), "turn about the optical axis by %d", &number) == 1) {
      EXPECT_NEAR(deg, number, 0.05) << task.name;
      EXPECT_LT(X_DC.p.norm(), 1e-3) << task.name;
      EXPECT_LE(number * features::TraitsOf(scene.servo.feature.target).turns, 180);
    } else if (std::sscanf(task.name.c_str(), "nearer by %d", &number) == 1) {
      EXPECT_NEAR(X_DC.p.z(), 1e-3 * number, 1e-3) << task.name;
      EXPECT_LT(deg, 0.05) << task.name;
    } else if (std::sscanf(task.name.c_str(), "away by %d", &number) == 1) {
      EXPECT_NEAR(X_DC.p.z(), -1e-3 * number, 1e-3) << task.name;
    } else if (std::sscanf(task.name.c_str(), "turn of the target's plane by %d", &number) == 1) {
      EXPECT_NEAR(deg, number, 0.05) << task.name;
      // The target's centre stays where the goal camera has it.
      const model::Vec3& p_DO = scene.servo.feature.p_CO_C_star;
      EXPECT_LT((X_DC.Inverse() * p_DO - p_DO).norm(), 1e-3) << task.name;
    }
  }
  EXPECT_EQ(random, 3);
}

INSTANTIATE_TEST_SUITE_P(Targets, LawTasks, testing::Values("square", "triangle"));

}  // namespace
}  // namespace fovea::laws
