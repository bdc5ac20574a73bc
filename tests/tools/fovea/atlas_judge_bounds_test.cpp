// SPDX-License-Identifier: Apache-2.0
// The judge of starts searches at the bounds that the servo's guard keeps, by the servo's own measures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "tests/tools/fovea/atlas_scene.hpp"
#include "tools/fovea/atlas/judge.hpp"

namespace fovea::atlas {
namespace {

using model::VecN;

// By how much the guard's bounds of all solids are kept at `q` [m].
double RoomByServo(const Scene& scene, const VecN& q) {
  const barriers::SolidBarriers solid(scene.servo);
  model::ArmPoses poses;
  model::ComputePoses(scene.servo.arm, q, poses);
  const barriers::ArmBodies bodies = barriers::PlaceBodies(scene.servo.arm, poses);
  double room = HUGE_VAL;
  for (int i = 0; i < solid.size(); ++i) {
    room = std::min(room, solid.ValueOf(i, poses, bodies) - solid.StopMarginOf(i));
  }
  return room;
}

// The joints from `start` to `goal` and 0.03 rad further: other goal postures are out of reach, and the way
// is nearly straight. The servo keeps 0.02 rad from each end.
Scene InACorridor(Scene scene, const VecN& start, const VecN& goal) {
  constexpr double kBeside = 0.03;
  for (int i = 0; i < start.size(); ++i) {
    model::Joint& joint = scene.servo.arm.joints[static_cast<std::size_t>(i)];
    joint.q_min = std::min(start[i], goal[i]) - kBeside;
    joint.q_max = std::max(start[i], goal[i]) + kBeside;
  }
  return scene;
}

// With the table so much higher that the guard's bound is kept by `room` [m] at the lowest of `postures`.
Scene WithTableBelow(Scene scene, const std::vector<VecN>& postures, double room) {
  config::Plane& table = scene.servo.guard.obstacles.planes[0];
  const double begin = table.distance;
  double low = begin;
  double high = begin + 1.0;
  for (int i = 0; i < 40; ++i) {
    table.distance = 0.5 * (low + high);
    double least = HUGE_VAL;
    for (const VecN& q : postures) {
      least = std::min(least, RoomByServo(scene, q));
    }
    (least > room ? low : high) = table.distance;
  }
  return scene;
}

struct Case {
  Start start;
  VecN q;
  VecN goal;
};

// Drawn starts with the goal that is nearest to each.
std::vector<Case> Cases(const Scene& scene, int count) {
  std::vector<Case> cases;
  const Sampler sampler(scene);
  for (int index = 0; index < count; ++index) {
    const Start start = sampler.Draw(5, index);
    const VecN q = Eigen::Map<const VecN>(start.q.data(), static_cast<Eigen::Index>(start.q.size()));
    std::mt19937_64 engine(1);
    std::vector<VecN> goals = sampler.goals().Find(q, start.TargetPose(), {}, engine);
    std::sort(goals.begin(), goals.end(),
              [&](const VecN& a, const VecN& b) { return (a - q).norm() < (b - q).norm(); });
    if (!goals.empty()) {
      cases.push_back({start, q, goals[0]});
    }
  }
  return cases;
}

std::vector<VecN> StraightWay(const Case& one) {
  std::vector<VecN> way;
  for (int k = 0; k <= 100; ++k) {
    way.emplace_back(one.q + 0.01 * k * (one.goal - one.q));
  }
  return way;
}

bool IsAllowed(const std::vector<VecN>& way, const Case& one, const StartChecks& checks) {
  return std::all_of(way.begin(), way.end(), [&](const VecN& q) {
    return checks.OnTheWay(checks.At(q), one.start.TargetPose(), checks.LeastCosine());
  });
}

constexpr JudgeEffort kLittle{.descents = 40, .searches = 1, .draws = 3000};

// Six joints: near each goal posture there is no other.
TEST(AtlasJudgeBounds, GoalsNearJointEndsCount) {
  const Scene scene = test::AtlasScene("ur5e", "square");
  int with_way = 0;
  int straight = 0;
  for (const Case& one : Cases(scene, 12)) {
    const Scene narrow = InACorridor(scene, one.q, one.goal);
    const StartChecks checks(narrow);
    const bool is_straight = IsAllowed(StraightWay(one), one, checks);
    const Judgement judgement = JudgeStart(narrow, one.start, kLittle);
    straight += is_straight ? 1 : 0;
    with_way += is_straight && judgement.has_way ? 1 : 0;
    EXPECT_GT(judgement.goals, 0);
  }
  std::cout << with_way << " of " << straight
            << " straight ways to goals 0.03 rad from the joints' ends found\n";
  EXPECT_GE(straight, 3);
  EXPECT_EQ(with_way, straight);
}

TEST(AtlasJudgeBounds, GoalsOverTheTableCountAsFarAsTheServoGoes) {
  const Scene scene = test::AtlasScene("ur5e", "square");
  int compared = 0;
  for (const Case& one : Cases(scene, 12)) {
    const Scene narrow = InACorridor(scene, one.q, one.goal);
    if (RoomByServo(narrow, one.goal) > RoomByServo(narrow, one.q)) {
      continue;  // the start would be in the table
    }
    ++compared;
    EXPECT_GT(JudgeStart(WithTableBelow(narrow, {one.goal}, 0.003), one.start, kLittle).goals, 0);
    EXPECT_EQ(JudgeStart(WithTableBelow(narrow, {one.goal}, -0.003), one.start, kLittle).goals, 0);
  }
  std::cout << compared << " goals 3 mm within and 3 mm past the guard's bound\n";
  EXPECT_GE(compared, 3);
}

// Goals that show a disc at a larger tilt than the servo chooses do not count; a start with a larger one may
// be left.
TEST(AtlasJudgeBounds, GoalsShowADiscAtNoLargerTiltThanTheServo) {
  constexpr double kMost = 0.5;  // [rad]
  Scene scene = test::AtlasScene("panda", "circle");
  scene.servo.guard.view.disc_cosine_min = 0.0;
  const std::vector<Case> cases = Cases(scene, 12);
  Scene bounded = scene;
  bounded.servo.guard.view.disc_cosine_min = std::cos(kMost);
  const auto goals_of = [](const Scene& of, const Case& one) {
    std::mt19937_64 engine(2);
    return GoalPostures(of, GoalPostures::Bounds::kOfServo)
        .Find(one.q, one.start.TargetPose(), {.far = 40}, engine);
  };
  const StartChecks checks(bounded);
  int past = 0;
  int within = 0;
  int left = 0;
  int steep_starts = 0;
  for (const Case& one : cases) {
    const auto tilt = [&](const VecN& q) {
      return std::acos(checks.CosineTo(checks.At(q), one.start.TargetPose()));
    };
    for (const VecN& goal : goals_of(scene, one)) {
      past += tilt(goal) > kMost ? 1 : 0;
    }
    for (const VecN& goal : goals_of(bounded, one)) {
      ++within;
      EXPECT_LE(tilt(goal), kMost);
    }
    if (tilt(one.q) > kMost) {
      ++steep_starts;
      left += JudgeStart(bounded, one.start, kLittle).has_way ? 1 : 0;
    }
  }
  std::cout << past << " goals without the bound are past it, " << within << " with it are within; " << left
            << " of " << steep_starts << " starts past it have a way\n";
  EXPECT_GT(past, 5);
  EXPECT_GT(within, 5);
  EXPECT_GT(left, 0);
}

// The hand is nearest to the table on its way.
TEST(AtlasJudgeBounds, WaysOverTheTableCountAsFarAsTheServoGoes) {
  const Scene scene = test::AtlasScene("ur5e", "square");
  int compared = 0;
  int with_way = 0;
  for (const Case& one : Cases(scene, 40)) {
    const Scene narrow = InACorridor(scene, one.q, one.goal);
    const StartChecks checks(narrow);
    const std::vector<VecN> way = StraightWay(one);
    const Scene low = WithTableBelow(narrow, way, 0.003);
    if (IsAllowed(way, one, checks)) {
      ++compared;
      with_way += JudgeStart(low, one.start, kLittle).has_way ? 1 : 0;
    }
  }
  std::cout << with_way << " of " << compared << " ways that keep the guard's bound by 3 mm found\n";
  EXPECT_GE(compared, 8);
  EXPECT_EQ(with_way, compared);
}

// The target's outline at the servo's own bound of the picture.
TEST(AtlasJudgeBounds, PictureIsTheServos) {
  for (const char* target : {"sphere", "square"}) {
    const Scene scene = test::AtlasScene("panda", target);
    const StartChecks checks(scene);
    std::mt19937_64 engine(3);
    const model::Mat6N J = model::Mat6N::Zero(6, 7);
    int in = 0;
    int out = 0;
    for (int k = 0; k < 4000; ++k) {
      const double z = Uniform(engine, 0.2, 0.9);
      model::Pose X_CO;
      X_CO.p = {z * Uniform(engine, -0.7, 0.7), z * Uniform(engine, -0.6, 0.6), z};
      double room = HUGE_VAL;
      for (const barriers::Barrier& side : barriers::FieldOfViewBarriers(
               scene.servo.guard,
               {scene.servo.feature.Outline(), {X_CO, model::Vec3::Zero(), model::Vec3::Zero()}, J})) {
        room = std::min(room, side.value - side.margin);
      }
      if (std::fabs(room) > 1e-9) {
        (room > 0.0 ? in : out) += 1;
        EXPECT_EQ(checks.OutOfViewOnTheWay(X_CO), room < 0.0) << target << " by " << room;
      }
    }
    std::cout << target << ": " << in << " in the picture, " << out << " not\n";
    EXPECT_GT(in, 500);
    EXPECT_GT(out, 500);
  }
}

}  // namespace
}  // namespace fovea::atlas
