// SPDX-License-Identifier: Apache-2.0
// Selects the true one of the poses that three corners allow, and finds a still target from all views.
#include "firmware/core/estimate/pose_hypotheses.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <numbers>
#include <vector>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "tests/core/estimate/corner_views.hpp"

namespace fovea::estimate {
namespace {

// A view, and the whole comparison with the views before it.
Verdict TakeWhole(const config::PredictConfig& config, const Polygon& polygon, const CornerView& view,
                  PoseHypotheses& hypotheses) {
  const Verdict verdict = TakeView(config, polygon, view, hypotheses);
  while (GoOn(polygon, hypotheses)) {
  }
  return verdict;
}

// The comparison of all poses with all views ends before the next picture of a camera with 30 Hz. A view that
// comes before its end changes nothing of it.
TEST(PlateHypothesesTest, ComparisonIsSpreadOverTicks) {
  constexpr int kTicksBetweenPictures = 33;
  const config::PredictConfig config;
  const Polygon triangle = features::MakeTriangle(features::kDefaultTriangle);
  Draw draw(11);
  PoseHypotheses hypotheses;
  int most_ticks = 0;
  int most_poses = 0;
  for (int k = 0; k < 60; ++k) {
    const CornerView view = ViewOf(triangle, CameraAt(0.02 * k), kOnTable, k, 0.05, draw);
    ASSERT_EQ(TakeView(config, triangle, view, hypotheses).intake, hal::Intake::kTaken);
    most_poses = std::max(most_poses, hypotheses.plate.count);
    PoseHypotheses disturbed = hypotheses;
    int ticks = 0;
    while (GoOn(triangle, hypotheses)) {
      ++ticks;
    }
    most_ticks = std::max(most_ticks, ticks);
    if (GoOn(triangle, disturbed)) {
      const CornerView early = ViewOf(triangle, CameraAt(0.02 * k + 0.01), kOnTable, k + 1, 0.05, draw);
      (void)TakeView(config, triangle, early, disturbed);
      while (GoOn(triangle, disturbed)) {
      }
      ASSERT_EQ(disturbed.plate.views.count, hypotheses.plate.views.count);
      ASSERT_TRUE(disturbed.plate.best().X_BO_still.R == hypotheses.plate.best().X_BO_still.R ||
                  disturbed.plate.stillness == Stillness::kMoving);
    }
  }
  std::cout << "at most " << most_ticks << " ticks for " << most_poses << " poses\n";
  EXPECT_GT(most_ticks, 5);
  EXPECT_LT(most_ticks, kTicksBetweenPictures);
}

// A detector that reports another place now and then.
TEST(PlateHypothesesTest, RejectsOutliersAndRestartsAfterSeveral) {
  config::PredictConfig config;
  config.gate_rejects_max = 3;
  const Polygon square = features::MakeSquare(0.08);
  Draw draw(3);
  PoseHypotheses hypotheses;
  int k = 0;
  const auto see = [&](const Pose& X_BO) {
    return TakeWhole(config, square, ViewOf(square, CameraAt(0.0), X_BO, k++, 0.05, draw), hypotheses)
               .intake == hal::Intake::kTaken;
  };
  while (k < 30) {
    ASSERT_TRUE(see(kOnTable));
  }
  const Pose elsewhere{kOnTable.R, kOnTable.p + Vec3(0.05, 0.0, 0.0)};
  EXPECT_FALSE(see(elsewhere));
  EXPECT_EQ(hypotheses.stamp_ns, 29 * kFrameNs);
  EXPECT_TRUE(see(kOnTable));
  EXPECT_EQ(hypotheses.rejected_in_row, 0);
  EXPECT_FALSE(see(elsewhere));
  EXPECT_FALSE(see(elsewhere));
  EXPECT_TRUE(see(elsewhere)) << "three in a row";
  EXPECT_EQ(hypotheses.accepted, 1);
  EXPECT_LT((hypotheses.plate.best().filter.X_BO.p - elsewhere.p).norm(), 1e-3);
  EXPECT_TRUE(hypotheses.plate.best().filter.w_BO_B.isZero());
  EXPECT_EQ(TakeWhole(config, square, ViewOf(square, CameraAt(0.0), elsewhere, k - 1, 0.05, draw), hypotheses)
                .intake,
            hal::Intake::kTooOld);
  CornerView nothing = ViewOf(square, CameraAt(0.0), kOnTable, k, 0.05, draw);
  nothing.seen.num_branches = 0;
  PoseHypotheses empty;
  EXPECT_EQ(TakeWhole(config, square, nothing, empty).intake, hal::Intake::kWrongKind);
  EXPECT_EQ(empty.plate.count, 0);
}

// All poses that put the triangle's corners at `xy`, in any order: Newton's method from many starts.
std::vector<SeenCorners::Branch> AllPoses(const Polygon& triangle, const SeenCorners::Vector& xy,
                                          Draw& draw) {
  std::vector<SeenCorners::Branch> all;
  for (int trial = 0; trial < 400; ++trial) {
    const int first = trial % 3;
    Pose X{Turned({0.0, 0.0, draw.Between(-3.1, 3.1)}), {0.0, 0.0, draw.Between(0.3, 0.7)}};
    X.R = Turned(0.5 * Vec3(draw.Normal(), draw.Normal(), 0.0)) * X.R;
    SeenCorners::Vector goal(6);
    for (int i = 0; i < 3; ++i) {
      goal.segment<2>(2 * i) = xy.segment<2>(2 * ((first + i) % 3));
    }
    SeenCorners::Vector e;
    for (int round = 0; round < 40; ++round) {
      const SeenCorners::Vector now = CornersOf(triangle, X);
      e = goal - now;
      Eigen::Matrix<double, 6, 6> J;
      for (int k = 0; k < 6; ++k) {
        Eigen::Matrix<double, 6, 1> d = Eigen::Matrix<double, 6, 1>::Zero();
        d[k] = 1e-6;
        J.col(k) = 1e6 * (CornersOf(triangle, {Turned(d.tail<3>()) * X.R, X.p + d.head<3>()}) - now);
      }
      // Damped a little, so that it ends at the nearest pose where noise leaves no exact one.
      const Eigen::Matrix<double, 6, 6> normal =
          J.transpose() * J + 1e-7 * Eigen::Matrix<double, 6, 6>::Identity();
      Eigen::Matrix<double, 6, 1> step = normal.ldlt().solve(J.transpose() * e);
      step *= std::min(1.0, 0.3 / std::max(step.norm(), 1e-9));
      X.p += step.head<3>();
      X.R = Turned(step.tail<3>()) * X.R;
    }
    bool good = e.norm() < 0.1 / kFocalPx && X.p.z() > 0.1 && X.R.col(2).dot(X.p) > 0.5 * X.p.norm();
    for (const auto& other : all) {
      good = good && (other.first != first || Between(other.X_CO.R, X.R).norm() > 0.01);
    }
    if (good) {
      all.push_back({X, first});
    }
  }
  return all;
}

// The camera moves over a still triangle with any orientation. After the first image all poses remain
// possible, the most frontal one first. In the end only the true one is left.
TEST(PlateHypothesesTest, CameraMotionFindsTheTruePoseOfATriangle) {
  config::PredictConfig config;
  const Polygon triangle = features::MakeTriangle(features::kDefaultTriangle);
  Draw draw(7);
  constexpr int kRuns = 60;
  int right = 0;
  int alone = 0;
  int most = 0;
  int first_was_wrong = 0;
  double last_wrong_s = 0.0;
  std::vector<double> nees;
  for (int run = 0; run < kRuns; ++run) {
    const Pose X_BO{Turned({3.14159265, 0.0, 0.0}) *
                        Turned({0.12 * draw.Normal(), 0.12 * draw.Normal(), 0.0}) *
                        Turned({0.0, 0.0, draw.Between(-3.1, 3.1)}),
                    {0.5 + 0.03 * draw.Normal(), 0.03 * draw.Normal(), 0.02}};
    const Vec3 aside(draw.Between(-0.12, 0.12), draw.Between(-0.12, 0.12), draw.Between(0.45, 0.6));
    const auto camera = [&](double t) {
      const double s = 1.0 - std::exp(-t * t / (0.2 + t));  // begins at rest
      Pose X_BC;
      X_BC.p = (1.0 - s) * (X_BO.p + aside) + s * (X_BO.p + Vec3(0.0, 0.0, 0.4));
      const Vec3 z = (X_BO.p - X_BC.p).normalized();
      X_BC.R.col(2) = z;
      X_BC.R.col(0) = model::Cross(Vec3(0.0, -1.0, 0.0), z).normalized();
      X_BC.R.col(1) = model::Cross(X_BC.R.col(2), X_BC.R.col(0));
      return X_BC;
    };
    PoseHypotheses hypotheses;
    CornerView view = ViewOf(triangle, camera(0.0), X_BO, 0, 0.03, draw);
    std::vector<SeenCorners::Branch> all = AllPoses(triangle, view.seen.xy, draw);
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.X_CO.R(2, 2) > b.X_CO.R(2, 2); });
    view.seen.num_branches = std::min<int>(static_cast<int>(all.size()), hal::kMaxPoses);
    std::copy_n(all.begin(), view.seen.num_branches, view.seen.branches.begin());
    most = std::max(most, view.seen.num_branches);
    ASSERT_EQ(TakeWhole(config, triangle, view, hypotheses).intake, hal::Intake::kTaken);
    const auto off = [&] { return Between(hypotheses.plate.best().filter.X_BO.R, X_BO.R).norm(); };
    first_was_wrong += off() > 0.05 ? 1 : 0;
    for (int k = 1; k <= 60; ++k) {
      view = ViewOf(triangle, camera(k * kFrameS), X_BO, k, 0.03, draw, k % 3);
      view.seen.num_branches = 0;
      (void)TakeWhole(config, triangle, view, hypotheses);
      if (off() > 0.05) {
        last_wrong_s = std::max(last_wrong_s, k * kFrameS);
      }
    }
    right += off() < 0.06 ? 1 : 0;
    alone += hypotheses.plate.count == 1 ? 1 : 0;
    Eigen::Matrix<double, 6, 1> e;
    e << X_BO.p - hypotheses.plate.best().filter.X_BO.p,
        Between(X_BO.R, hypotheses.plate.best().filter.X_BO.R);
    const Eigen::Matrix<double, 6, 6> P = hypotheses.plate.best().filter.P.topLeftCorner<6, 6>();
    nees.push_back(e.dot(P.inverse() * e));
  }
  std::sort(nees.begin(), nees.end());
  const double median = nees[nees.size() / 2];
  std::cout << "up to " << most << " poses; the first one wrong in " << first_was_wrong
            << ", a wrong one believed for at most " << last_wrong_s << " s; right in the end " << right
            << ", alone " << alone << " of " << kRuns << "; median normalised squared error " << median
            << ", expected 5.3\n";
  EXPECT_GE(most, 4);
  EXPECT_GT(first_was_wrong, kRuns / 10);
  EXPECT_GE(right, kRuns - 1) << "at most one run may still be wrong after two seconds";
  EXPECT_GE(alone, 54);
  EXPECT_LT(median, 7.0);
}

// The camera moves from the side to straight above the target within two seconds, then rests.
Pose ComesOver(const Pose& X_BO, double t) {
  const double s = std::min(0.5 * t, 1.0);
  Pose X_BC;
  X_BC.p = X_BO.p + Vec3((1.0 - s) * 0.2, (1.0 - s) * -0.1, 0.4);
  X_BC.R.col(2) = (X_BO.p - X_BC.p).normalized();
  X_BC.R.col(0) = model::Cross(Vec3(0.0, -1.0, 0.0), X_BC.R.col(2)).normalized();
  X_BC.R.col(1) = model::Cross(X_BC.R.col(2), X_BC.R.col(0));
  return X_BC;
}

// Seen from above, one corner is wrong by a quarter of a pixel in every frame. The filter counts each frame
// as new information, so its tilt becomes wrong. The views from the side correct this.
TEST(PlateHypothesesTest, AllViewsOfAStillTargetOutweighOneBiasedPlace) {
  const config::PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  Draw draw(3);
  PoseHypotheses hypotheses;
  for (int k = 0; k < 300; ++k) {
    const Pose X_BC = ComesOver(flat, k * kFrameS);
    CornerView view = ViewOf(square, X_BC, flat, k, 0.1, draw);
    if (k * kFrameS > 1.8) {
      view.seen.xy[0] += 0.25 / kFocalPx;
    }
    (void)TakeWhole(config, square, view, hypotheses);
  }
  const double filter =
      Between(hypotheses.plate.best().filter.X_BO.R, flat.R).norm() * 180.0 / std::numbers::pi;
  const double all = Between(MotionAt(config, hypotheses, hypotheses.stamp_ns).X_BO.R, flat.R).norm() *
                     180.0 / std::numbers::pi;
  std::cout << "off by: filter " << filter << " deg, all views " << all << " deg\n";
  EXPECT_EQ(hypotheses.plate.stillness, Stillness::kStill);
  EXPECT_GT(filter, 0.5);
  EXPECT_LT(all, 0.25);
}

// A camera that slowly comes to rest, as at the end of every approach: frames that look nearly alike must not
// count as frames from one place. Without noise the only error left is that of the mean.
TEST(PlateHypothesesTest, CreepingCameraDoesNotBiasTheMean) {
  const config::PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  for (const double speed : {5e-3, 1e-3, 2e-4}) {  // [m/s]
    Draw draw(5);
    PoseHypotheses hypotheses;
    double worst_mm = 0.0;
    double worst_deg = 0.0;
    for (int k = 0; k < 150; ++k) {
      Pose X_BC = ComesOver(flat, k * kFrameS);
      X_BC.p.x() += speed * k * kFrameS;
      (void)TakeWhole(config, square, ViewOf(square, X_BC, flat, k, 0.0, draw), hypotheses);
      if (k > 75) {
        const Pose X_BO = MotionAt(config, hypotheses, hypotheses.stamp_ns).X_BO;
        worst_mm = std::max(worst_mm, 1e3 * (X_BO.p - flat.p).norm());
        worst_deg = std::max(worst_deg, Between(X_BO.R, flat.R).norm() * 180.0 / std::numbers::pi);
      }
    }
    std::cout << 1e3 * speed << " mm/s: off by at most " << worst_mm << " mm, " << worst_deg << " deg\n";
    EXPECT_EQ(hypotheses.plate.stillness, Stillness::kStill);
    EXPECT_LT(worst_mm, 0.017);
    EXPECT_LT(worst_deg, 0.006);
  }
}

// An arm that follows the noise of each frame trembles; if trembling made the frames' mean begin anew, it
// would tremble on. So the pose changes little more from frame to frame than for a camera that stands still.
TEST(PlateHypothesesTest, TremblingCameraDoesNotRestartTheMean) {
  const config::PredictConfig config;
  const Polygon triangle = features::MakeTriangle(features::kDefaultTriangle);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  const auto rms_step_deg = [&](double tremble_m, double tremble_rad) {
    Draw draw(8);
    PoseHypotheses hypotheses;
    Pose before = flat;
    double sum2 = 0.0;
    for (int k = 0; k < 240; ++k) {
      Pose X_BC = ComesOver(flat, k * kFrameS);
      X_BC.p += tremble_m * draw.Vector();
      X_BC.R = Turned(tremble_rad * draw.Vector()) * X_BC.R;
      (void)TakeWhole(config, triangle, ViewOf(triangle, X_BC, flat, k, 0.1, draw), hypotheses);
      const Pose X_BO = MotionAt(config, hypotheses, hypotheses.stamp_ns).X_BO;
      sum2 += k >= 120 ? Between(X_BO.R, before.R).squaredNorm() : 0.0;
      before = X_BO;
    }
    EXPECT_EQ(hypotheses.plate.stillness, Stillness::kStill);
    return std::sqrt(sum2 / 120.0) * 180.0 / std::numbers::pi;
  };
  const double still = rms_step_deg(0.0, 0.0);
  const double trembling = rms_step_deg(6e-5, 2e-4);
  const double moving = rms_step_deg(1e-3, 3e-3);
  std::cout << "from frame to frame: " << still << " deg rms, trembling " << trembling << ", moving "
            << moving << "\n";
  EXPECT_LT(trembling, 1.5 * still);
  EXPECT_GT(moving, 5.0 * still);
}

// The pictures are 30 ms older than believed, and the servo finds that only as the camera moves. The views
// that it has by then move to their true places.
TEST(PlateHypothesesTest, ViewsOfWrongAgeDoNotPullThePose) {
  constexpr double kLateS = 0.03;
  constexpr double kDt = 1e-4;
  const config::PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  const auto camera = [&](double t) {
    const double u = std::clamp((t - 0.2) / 0.8, 0.0, 1.0);
    return ComesOver(flat, 2.0 * u * u * (3.0 - 2.0 * u));
  };
  Draw draw(6);
  PoseHypotheses hypotheses;
  for (int k = 0; k < 90; ++k) {
    const double t = k * kFrameS;
    CornerView view = ViewOf(square, camera(t - kLateS), flat, k, 0.03, draw);
    if (hypotheses.plate.count > 0) {
      view.late = hypotheses.plate.best().filter.late;
    }
    view.late_sigma = config.stamp_sigma;
    const Pose X_BC = camera(t - view.late);
    const Pose X_BC_next = camera(t - view.late + kDt);
    view.X_CB = X_BC.Inverse();
    view.V_BC_C << X_BC.R.transpose() * Vec3(X_BC_next.p - X_BC.p) / kDt,
        X_BC.R.transpose() * Between(X_BC_next.R, X_BC.R) / kDt;
    (void)TakeWhole(config, square, view, hypotheses);
  }
  const PlatePose& best = hypotheses.plate.best();
  const double off_mm = 1e3 * (best.X_BO_still.p - flat.p).norm();
  std::cout << "late by " << 1e3 * best.filter.late << " ms, off by " << off_mm << " mm\n";
  EXPECT_EQ(hypotheses.plate.stillness, Stillness::kStill);
  EXPECT_LT(off_mm, 0.03);
}

TEST(PlateHypothesesTest, StartOfMotionEndsTheStillState) {
  const config::PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  Draw draw(4);
  PoseHypotheses hypotheses;
  double worst = 0.0;
  int still_until = 0;
  constexpr int kSetsOut = 120;
  for (int k = 0; k < 240; ++k) {
    const Pose X_BC = ComesOver(flat, k * kFrameS);
    Pose X_BO = flat;
    X_BO.p.x() += k < kSetsOut ? 0.0 : 0.05 * (k - kSetsOut) * kFrameS;  // [m], at 0.05 m/s
    (void)TakeWhole(config, square, ViewOf(square, X_BC, X_BO, k, 0.03, draw), hypotheses);
    still_until = hypotheses.plate.stillness == Stillness::kStill ? k : still_until;
    if (k >= 60) {
      worst = std::max(worst, (MotionAt(config, hypotheses, hypotheses.stamp_ns).X_BO.p - X_BO.p).norm());
    }
  }
  std::cout << "still for " << still_until - kSetsOut << " more frames, off by at most " << 1e3 * worst
            << " mm\n";
  EXPECT_GE(still_until, kSetsOut - 1);
  EXPECT_LE(still_until, kSetsOut + 3);
  EXPECT_LT(worst, 0.006);
}

}  // namespace
}  // namespace fovea::estimate
