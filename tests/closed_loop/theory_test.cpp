// SPDX-License-Identifier: Apache-2.0
// One degree of freedom in Bullet, compared with its analytic answers (the exercises of part A).
#include <cmath>
#include <complex>
#include <limits>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

constexpr double kOnePercent = 0.01;
constexpr double kPoles = 0.05;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

sim::TheoryResult RunTheory(const std::string& name) {
  const sim::Summary s = RunShipped("theory/" + name);
  ExpectSound(s);
  EXPECT_TRUE(s.converged) << s.verdict;
  const sim::TheoryResult& t = s.theory.value();
  std::cout << name << ": zeta " << t.run.zeta.value_or(kNone) << ", omega_n "
            << t.run.omega_n.value_or(kNone) << ", settled after " << t.run.settle_time_s.value_or(kNone)
            << " s, e_ss " << t.run.e_ss << " m, poles";
  for (const std::complex<double>& pole : t.run.poles) {
    std::cout << ' ' << pole;
  }
  std::cout << "; differs from theory by " << 1e3 * t.residual_rms << " mm rms, " << 1e3 * t.residual_max
            << " mm at most\n";
  return t;
}

void ExpectPoles(const sim::TheoryFigures& figures, const std::vector<std::complex<double>>& poles) {
  ASSERT_EQ(figures.poles.size(), poles.size());
  for (std::size_t i = 0; i < poles.size(); ++i) {
    EXPECT_LE(std::abs(figures.poles[i] - poles[i]), kPoles * std::abs(poles[i]));
  }
}

// A critically damped loop of natural frequency `omega_n` [rad/s].
void ExpectCriticallyDamped(const sim::TheoryResult& t, double omega_n) {
  constexpr double kSettled = 5.8339;  // settling time to 2 % of a step, times omega_n
  EXPECT_NEAR(t.run.zeta.value(), 1.0, kOnePercent);
  EXPECT_NEAR(t.run.omega_n.value(), omega_n, kOnePercent * omega_n);
  EXPECT_NEAR(t.run.settle_time_s.value(), kSettled / omega_n, kOnePercent * kSettled / omega_n);
  ExpectPoles(t.run, {-omega_n, -omega_n});
  EXPECT_LT(t.residual_max, 3e-4);
}

// 16 kg, 16 N s/m, 4 N/m.
TEST(Theory, OpenLoopIsCriticallyDampedAtHalfARadianPerSecond) {
  ExpectCriticallyDamped(RunTheory("open-loop"), 0.5);
}

TEST(Theory, PdRegulatorHasTheRequestedStiffness) { ExpectCriticallyDamped(RunTheory("pd-regulator"), 1.0); }

TEST(Theory, PartitionLawKeepsItsPolesUnderDryFriction) {
  ExpectCriticallyDamped(RunTheory("trajectory-friction"), 1.0);
}

TEST(Theory, ReversalsUnderDryFrictionErrByMillimetresOnly) {
  const sim::TheoryResult t = RunTheory("trajectory-reversal");
  std::cout << "largest error at the reversals: " << 1e3 * t.error_max << " mm\n";
  EXPECT_LT(t.error_max, 1.5e-3);
  // Without compensation, or if it ignored the reference's sign at standstill: hundreds of times larger.
  const sim::TheoryResult bare =
      RunShipped("theory/trajectory-reversal", {"servo.friction_compensation=0"}).theory.value();
  EXPECT_GT(bare.error_max, 0.2);
}

TEST(Theory, ConstantForceWithoutIntegralLeavesHalfAMetreOfError) {
  const sim::TheoryResult t = RunTheory("disturbance");
  EXPECT_NEAR(t.run.e_ss, 0.5, kOnePercent * 0.5);
  ExpectCriticallyDamped(t, 1.0);
}

TEST(Theory, IntegralRemovesTheErrorOfAConstantForce) {
  const sim::TheoryResult t = RunTheory("disturbance-integral");
  EXPECT_LT(std::fabs(t.run.e_ss), 1e-6);
  ASSERT_EQ(t.analytic.poles.size(), 3U);
  ExpectPoles(t.run, t.analytic.poles);
  EXPECT_LT(t.residual_max, 3e-4);
}

TEST(Theory, ForceBelowStictionMovesNothing) {
  const sim::TheoryResult t = RunTheory("disturbance-stiction");
  EXPECT_EQ(t.run.e_ss, 0.0);
  EXPECT_EQ(t.residual_max, 0.0);
  // The same push with less friction than force.
  const sim::TheoryResult moved =
      RunShipped("theory/disturbance-stiction", {"arm.coulomb=[7]"}).theory.value();
  EXPECT_GT(std::fabs(moved.run.e_ss), 0.01);
}

TEST(Theory, TheoryForAMultiJointArmIsRefused) {
  EXPECT_THROW(RunShipped("ball", {"theory.enabled=true"}), std::runtime_error);
}

}  // namespace
}  // namespace fovea::test
