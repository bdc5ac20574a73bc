// The shortest change of velocity: by the motion that it claims, and against the guard's stop, which is other
// code.
#include "fovea/servo/velocity_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "fovea/servo/stop_path.hpp"
#include "support/random_states.hpp"
#include "support/repetitions.hpp"

namespace fovea::servo {
namespace {

TEST(VelocityChangeTest, EndsAtItsVelocityWithinItsLimits) {
  test::RandomStates random(62);
  double worst_end = 0.0;
  double worst_a = 0.0;
  double worst_travel = 0.0;
  for (int n = 0; n < test::Repetitions(200000); ++n) {
    const AxisLimits limits{1.0, std::pow(10.0, random.Uniform(-2.0, 2.0)),
                            std::pow(10.0, random.Uniform(-2.0, 4.0))};
    const double v0 = random.Uniform(-2.0, 2.0);
    const double a0 = random.Uniform(-2.0, 2.0) * limits.a_max;
    const double v1 = random.Uniform(-1.0, 1.0);
    const VelocityChange change = PlanVelocityChange(v0, a0, v1, limits);
    AxisState state{0.0, v0, a0};
    double v_size = std::fabs(v0) + std::fabs(v1);
    for (int k = 0; k < VelocityChange::kNumPhases; ++k) {
      const JerkPhase& phase = change.phases[static_cast<std::size_t>(k)];
      ASSERT_GE(phase.duration_s, 0.0);
      ASSERT_LE(std::fabs(phase.jerk), limits.j_max);
      state = After(state, phase.jerk, phase.duration_s);
      v_size = std::max(v_size, std::fabs(state.v));
      worst_a = std::max(worst_a, std::fabs(state.a) / limits.a_max);
    }
    worst_end = std::max({worst_end, std::fabs(state.v - v1) / v_size, std::fabs(state.a) / limits.a_max});
    const double T = change.Duration();
    worst_travel = std::max({worst_travel, std::fabs(change.Travel() - state.x) / (v_size * T + 1e-300),
                             std::fabs(change.At(T + 1.0).x - state.x - v1) / (v_size * (T + 1.0))});
  }
  std::cout << "ends off by " << worst_end << ", goes off by " << worst_travel
            << ", largest use of the acceleration " << worst_a << "\n";
  EXPECT_LE(worst_end, 1e-13);
  EXPECT_LE(worst_travel, 1e-13);
  EXPECT_LE(worst_a, 1.0 + 1e-13);
}

TEST(VelocityChangeTest, ToRestIsTheGuardsStop) {
  test::RandomStates random(63);
  double worst = 0.0;
  for (int n = 0; n < test::Repetitions(100000); ++n) {
    const AxisLimits limits{1.0, random.Uniform(1.0, 15.0), random.Uniform(50.0, 5000.0)};
    const double v = random.Uniform(-2.0, 2.0);
    const double a = random.Uniform(-1.0, 1.0) * limits.a_max;
    const JointStop stop = PlanStop(v, a, limits.a_max, limits.j_max);
    const VelocityChange change = PlanVelocityChange(v, a, 0.0, limits);
    worst = std::max({worst, std::fabs(change.Duration() - stop.Duration()),
                      std::fabs(change.Travel() - StopTravel(stop, v, a, stop.Duration()))});
  }
  std::cout << "differs by " << worst << " s or m\n";
  EXPECT_LE(worst, 1e-12);
}

TEST(VelocityChangeTest, NothingToChangeIsNothing) {
  const VelocityChange change = PlanVelocityChange(0.5, 0.0, 0.5, {1.0, 2.0, 3.0});
  EXPECT_EQ(change.Duration(), 0.0);
  EXPECT_EQ(change.Travel(), 0.0);
  EXPECT_EQ(change.At(2.0).x, 1.0);
}

}  // namespace
}  // namespace fovea::servo
