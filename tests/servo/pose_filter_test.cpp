// A flat target's pose from its corners: exact for its own model, honest about its covariance, not led
// astray; and which of the poses that three corners allow is the true one.
#include "fovea/servo/pose_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include "fovea/features/square.hpp"
#include "fovea/features/triangle.hpp"
#include "fovea/servo/pose_choice.hpp"

namespace fovea::servo {
namespace {

using features::Polygon;
using features::SeenCorners;
using model::Mat3;
using model::Pose;
using model::Vec3;

constexpr std::int64_t kFrameNs = 33'333'333;
constexpr double kFrameS = 1e-9 * static_cast<double>(kFrameNs);
constexpr double kFocalPx = 554.256;

Mat3 Turned(const Vec3& phi) {
  return phi.norm() > 0.0 ? Eigen::AngleAxisd(phi.norm(), phi.normalized()).toRotationMatrix()
                          : Eigen::Matrix3d::Identity();
}
Vec3 Between(const Mat3& R_to, const Mat3& R_from) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(R_to * R_from.transpose()));
  return turn.angle() * turn.axis();
}

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3 Vector() { return {Normal(), Normal(), Normal()}; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

SeenCorners::Vector CornersOf(const Polygon& polygon, const Pose& X_CO) {
  SeenCorners::Vector xy(2 * polygon.num_corners);
  for (int i = 0; i < polygon.num_corners; ++i) {
    const Vec3 p = X_CO * polygon.corners[static_cast<std::size_t>(i)];
    xy.segment<2>(2 * i) << p.x() / p.z(), p.y() / p.z();
  }
  return xy;
}

// The target in the camera's axes, corners off by `sigma_px`, their first one named the `shift`th.
CornerView ViewOf(const Polygon& polygon, const Pose& X_BC, const Pose& X_BO, int frame, double sigma_px,
                  Draw& draw, int shift = 0) {
  CornerView view;
  view.stamp_ns = frame * kFrameNs;
  view.X_CB = X_BC.Inverse();
  const Pose X_CO = view.X_CB * X_BO;
  const SeenCorners::Vector xy = CornersOf(polygon, X_CO);
  const int n = polygon.num_corners;
  const double sigma = std::max(sigma_px, 1e-3) / kFocalPx;
  view.seen.xy.resize(2 * n);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 2; ++k) {
      view.seen.xy[2 * ((i + shift) % n) + k] =
          xy[2 * i + k] + (sigma_px > 0.0 ? sigma * draw.Normal() : 0.0);
    }
  }
  view.seen.cov = SeenCorners::Covariance::Identity(2 * n, 2 * n) * (sigma * sigma);
  view.seen.num_branches = 1;
  view.seen.branches[0] = {X_CO, shift};
  return view;
}

// A camera that goes to and fro over the table, looking down.
Pose CameraAt(double t, double swing = 1.0) {
  Pose X_BC;
  X_BC.R = Turned({3.14159265, 0.0, 0.0}) *
           Turned({0.15 * swing * std::sin(1.1 * t), 0.2 * swing * std::sin(0.9 * t), 0.4 * t});
  X_BC.p = {0.5 + 0.08 * swing * std::sin(1.3 * t), 0.07 * swing * std::cos(t),
            0.5 + 0.05 * std::sin(0.7 * t)};
  return X_BC;
}

const Pose kOnTable{Turned({3.05, 0.1, 0.0}), {0.5, 0.03, 0.02}};

TEST(PoseFilterTest, FollowsAConstantMotionExactly) {
  const PredictConfig config;
  for (const Polygon& polygon :
       {features::MakeTriangle(features::kDefaultTriangle), features::MakeSquare(0.08)}) {
    Draw draw(1);
    PoseFilter filter;
    const Vec3 v(0.05, -0.03, 0.01);
    const Vec3 w(0.2, -0.1, 0.4);
    const auto truth = [&](double t) { return Pose{Turned(w * t) * kOnTable.R, kOnTable.p + v * t}; };
    const CornerView first = ViewOf(polygon, CameraAt(0.0), truth(0.0), 0, 0.0, draw);
    ASSERT_TRUE(StartPose(polygon, first, first.seen.branches[0], filter));
    double distance2 = 0.0;
    for (int k = 1; k < 90; ++k) {
      // Vision names another corner the first one in each image.
      const CornerView view =
          ViewOf(polygon, CameraAt(k * kFrameS), truth(k * kFrameS), k, 0.0, draw, k % polygon.num_corners);
      ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2)) << k << ": " << distance2;
    }
    const std::int64_t now = 89 * kFrameNs + 70'000'000;
    const FlatMotion motion = MotionAt(filter, now);
    const Pose there = truth(1e-9 * static_cast<double>(now));
    const double off_m = (motion.X_BO.p - there.p).norm();
    const double off_rad = Between(motion.X_BO.R, there.R).norm();
    std::cout << polygon.num_corners << " corners, 70 ms ahead: off by " << off_m << " m, " << off_rad
              << " rad; rates by " << (motion.v_BO_B - v).norm() << " m/s, " << (motion.w_BO_B - w).norm()
              << " rad/s\n";
    EXPECT_LT(off_m, 1e-6);
    EXPECT_LT(off_rad, 1e-5);
  }
}

// Normalised squared error of pose and rates over many runs: as many on average as there are, when the
// covariance is true. The camera moves, the target turns and is pushed about as its model says. Over the
// triangle the camera stays inside the cylinder through its corners: on it two of its poses are one, and
// which one a target that moves anyhow went on to is not to be seen.
TEST(PoseFilterTest, CovarianceIsHonestForATargetOfItsOwnModel) {
  PredictConfig config;
  config.target_jerk = 0.3;
  config.gate_sigma = 100.0;
  constexpr double kMean = 0.1;
  constexpr double kSigmaPx = 0.05;
  for (const Polygon& polygon :
       {features::MakeTriangle(features::kDefaultTriangle), features::MakeSquare(0.08)}) {
    Draw draw(12);
    config.target_turn = polygon.num_corners == 3 ? 0.02 : 0.1;
    double pose = 0.0;
    double all = 0.0;
    constexpr int kRuns = 300;
    for (int run = 0; run < kRuns; ++run) {
      const double t0 = draw.Between(0.0, 20.0);
      const double swing = polygon.num_corners == 3 ? 0.1 : 1.0;
      Pose X{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.0, 0.02}};
      Vec3 v = 0.01 * draw.Vector();
      Vec3 a = 0.01 * draw.Vector();
      Vec3 w = 0.01 * draw.Vector();
      PoseFilter filter;
      const CornerView first = ViewOf(polygon, CameraAt(t0, swing), X, 0, kSigmaPx, draw);
      ASSERT_TRUE(StartPose(polygon, first, first.seen.branches[0], filter));
      double distance2 = 0.0;
      for (int k = 1; k < 40; ++k) {
        constexpr int kSteps = 33;
        const double dt = kFrameS / kSteps;
        for (int i = 0; i < kSteps; ++i) {
          const Vec3 a0 = a;
          const Vec3 v0 = v;
          const Vec3 w0 = w;
          a += std::sqrt(config.target_jerk * config.target_jerk * kMean * dt) * draw.Vector();
          w += std::sqrt(config.target_turn * config.target_turn * kMean * dt) * draw.Vector();
          v += 0.5 * dt * (a + a0);
          X.p += 0.5 * dt * (v + v0);
          X.R = Turned(0.5 * dt * (w + w0)) * X.R;
        }
        const Pose X_BC = CameraAt(t0 + k * kFrameS, swing);
        const Pose off{Turned(kCameraTurnSigma * draw.Vector()), kCameraShiftSigma * draw.Vector()};
        CornerView view = ViewOf(polygon, X_BC * off, X, k, kSigmaPx, draw);
        view.X_CB = X_BC.Inverse();
        ASSERT_TRUE(UpdatePose(config, polygon, view, filter, distance2));
      }
      Eigen::Matrix<double, 15, 1> e;
      e << X.p - filter.X_BO.p, Between(X.R, filter.X_BO.R), v - filter.v_BO_B, a - filter.a_BO_B,
          w - filter.w_BO_B;
      const Eigen::Matrix<double, 15, 15> P = filter.P;
      const Eigen::Matrix<double, 6, 6> P_pose = P.topLeftCorner<6, 6>();
      EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
      all += e.dot(P.inverse() * e);
      pose += e.head<6>().dot(P_pose.inverse() * e.head<6>());
    }
    std::cout << polygon.num_corners << " corners: mean normalised squared error of the pose " << pose / kRuns
              << ", expected 6; of all " << all / kRuns << ", expected 15\n";
    EXPECT_NEAR(pose / kRuns, 6.0, 1.0);  // standard deviation sqrt(12 / 300) = 0.2
    EXPECT_NEAR(all / kRuns, 15.0, 1.6);  // and sqrt(30 / 300) = 0.3
  }
}

// A detector that sees something else now and then.
TEST(PoseChoiceTest, LeavesOutliersOutAndStartsAnew) {
  PredictConfig config;
  config.gate_rejects_max = 3;
  const Polygon square = features::MakeSquare(0.08);
  Draw draw(3);
  PoseChoice choice;
  int k = 0;
  const auto see = [&](const Pose& X_BO) {
    return UpdatePoses(config, square, ViewOf(square, CameraAt(0.0), X_BO, k++, 0.05, draw), choice);
  };
  while (k < 30) {
    ASSERT_TRUE(see(kOnTable));
  }
  const Pose elsewhere{kOnTable.R, kOnTable.p + Vec3(0.05, 0.0, 0.0)};
  EXPECT_FALSE(see(elsewhere));
  EXPECT_EQ(choice.stamp_ns, 29 * kFrameNs);
  EXPECT_TRUE(see(kOnTable));
  EXPECT_EQ(choice.rejected_in_row, 0);
  EXPECT_FALSE(see(elsewhere));
  EXPECT_FALSE(see(elsewhere));
  EXPECT_TRUE(see(elsewhere)) << "three in a row";
  EXPECT_EQ(choice.accepted, 1);
  EXPECT_LT((choice.best().X_BO.p - elsewhere.p).norm(), 1e-3);
  EXPECT_TRUE(choice.best().w_BO_B.isZero());
  EXPECT_FALSE(
      UpdatePoses(config, square, ViewOf(square, CameraAt(0.0), elsewhere, k - 1, 0.05, draw), choice))
      << "no news";
  CornerView nothing = ViewOf(square, CameraAt(0.0), kOnTable, k, 0.05, draw);
  nothing.seen.num_branches = 0;
  PoseChoice empty;
  EXPECT_FALSE(UpdatePoses(config, square, nothing, empty));
  EXPECT_EQ(empty.num_branches, 0);
}

// Poses in which the triangle's corners look as in `xy`, in any order: Newton's method from many starts.
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
      // Held back a little, so that it ends at the nearest pose too where noise leaves none.
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

// The camera comes over a still triangle, which lies any way. In the first image all poses stand side by
// side, the most squarely seen one first; in the end the true one alone is left.
TEST(PoseChoiceTest, FindsTheTrueOneOfATrianglesPosesByMoving) {
  PredictConfig config;
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
    PoseChoice choice;
    CornerView view = ViewOf(triangle, camera(0.0), X_BO, 0, 0.03, draw);
    std::vector<SeenCorners::Branch> all = AllPoses(triangle, view.seen.xy, draw);
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.X_CO.R(2, 2) > b.X_CO.R(2, 2); });
    view.seen.num_branches = std::min<int>(static_cast<int>(all.size()), hal::kMaxPoses);
    std::copy_n(all.begin(), view.seen.num_branches, view.seen.branches.begin());
    most = std::max(most, view.seen.num_branches);
    ASSERT_TRUE(UpdatePoses(config, triangle, view, choice));
    const auto off = [&] { return Between(choice.best().X_BO.R, X_BO.R).norm(); };
    first_was_wrong += off() > 0.05 ? 1 : 0;
    for (int k = 1; k <= 60; ++k) {
      view = ViewOf(triangle, camera(k * kFrameS), X_BO, k, 0.03, draw, k % 3);
      view.seen.num_branches = 0;
      UpdatePoses(config, triangle, view, choice);
      if (off() > 0.05) {
        last_wrong_s = std::max(last_wrong_s, k * kFrameS);
      }
    }
    right += off() < 0.06 ? 1 : 0;
    alone += choice.num_branches == 1 ? 1 : 0;
    Eigen::Matrix<double, 6, 1> e;
    e << X_BO.p - choice.best().X_BO.p, Between(X_BO.R, choice.best().X_BO.R);
    const Eigen::Matrix<double, 6, 6> P = choice.best().P.topLeftCorner<6, 6>();
    nees.push_back(e.dot(P.inverse() * e));
  }
  std::sort(nees.begin(), nees.end());
  const double median = nees[nees.size() / 2];
  std::cout << "up to " << most << " poses; the first one wrong in " << first_was_wrong
            << ", the last wrong one believed for " << last_wrong_s << " s; right in the end " << right
            << ", alone " << alone << " of " << kRuns << "; median normalised squared error " << median
            << ", expected 5.3\n";
  EXPECT_GE(most, 4);
  EXPECT_GT(first_was_wrong, kRuns / 10);
  EXPECT_GE(right, kRuns - 1) << "one is not told apart within two seconds";
  EXPECT_GE(alone, 54);
  EXPECT_LT(median, 7.0);
}

// From aside to straight above the target within two seconds, then at rest there.
Pose ComesOver(const Pose& X_BO, double t) {
  const double s = std::min(0.5 * t, 1.0);
  Pose X_BC;
  X_BC.p = X_BO.p + Vec3((1.0 - s) * 0.2, (1.0 - s) * -0.1, 0.4);
  X_BC.R.col(2) = (X_BO.p - X_BC.p).normalized();
  X_BC.R.col(0) = model::Cross(Vec3(0.0, -1.0, 0.0), X_BC.R.col(2)).normalized();
  X_BC.R.col(1) = model::Cross(X_BC.R.col(2), X_BC.R.col(0));
  return X_BC;
}

// What is wrong with the corners from above, a quarter of a pixel of one of them, is wrong in every frame:
// for the filter it is much news, and the tilt goes. The views from aside know better.
TEST(PoseChoiceTest, WhatAllViewsSayOfAStillTargetOutweighsOnePlacesError) {
  const PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  Draw draw(3);
  PoseChoice choice;
  for (int k = 0; k < 300; ++k) {
    const Pose X_BC = ComesOver(flat, k * kFrameS);
    CornerView view = ViewOf(square, X_BC, flat, k, 0.1, draw);
    if (k * kFrameS > 1.8) {
      view.seen.xy[0] += 0.25 / kFocalPx;
    }
    UpdatePoses(config, square, view, choice);
  }
  const double filter = Between(choice.best().X_BO.R, flat.R).norm() * 180.0 / std::numbers::pi;
  const double all =
      Between(MotionAt(choice, choice.stamp_ns).X_BO.R, flat.R).norm() * 180.0 / std::numbers::pi;
  std::cout << "off by: filter " << filter << " deg, all views " << all << " deg\n";
  EXPECT_TRUE(choice.is_still);
  EXPECT_GT(filter, 0.5);
  EXPECT_LT(all, 0.25);
}

// A camera that comes to rest by and by, as at the end of every approach: frames that look nearly alike are
// not taken for frames from one place. Without noise all that is left of an error is the mean's.
TEST(PoseChoiceTest, ACameraThatCreepsSpoilsNoMean) {
  const PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  for (const double speed : {5e-3, 1e-3, 2e-4}) {  // [m/s]
    Draw draw(5);
    PoseChoice choice;
    double worst_mm = 0.0;
    double worst_deg = 0.0;
    for (int k = 0; k < 150; ++k) {
      Pose X_BC = ComesOver(flat, k * kFrameS);
      X_BC.p.x() += speed * k * kFrameS;
      UpdatePoses(config, square, ViewOf(square, X_BC, flat, k, 0.0, draw), choice);
      if (k > 75) {
        const Pose X_BO = MotionAt(choice, choice.stamp_ns).X_BO;
        worst_mm = std::max(worst_mm, 1e3 * (X_BO.p - flat.p).norm());
        worst_deg = std::max(worst_deg, Between(X_BO.R, flat.R).norm() * 180.0 / std::numbers::pi);
      }
    }
    std::cout << 1e3 * speed << " mm/s: off by at most " << worst_mm << " mm, " << worst_deg << " deg\n";
    EXPECT_TRUE(choice.is_still);
    EXPECT_LT(worst_mm, 0.017);
    EXPECT_LT(worst_deg, 0.006);
  }
}

TEST(PoseChoiceTest, ATargetThatSetsOutIsStillNoMore) {
  const PredictConfig config;
  const Polygon square = features::MakeSquare(0.08);
  const Pose flat{Turned({3.14159265, 0.0, 0.0}), {0.5, 0.03, 0.02}};
  Draw draw(4);
  PoseChoice choice;
  double worst = 0.0;
  int still_until = 0;
  constexpr int kSetsOut = 120;
  for (int k = 0; k < 240; ++k) {
    const Pose X_BC = ComesOver(flat, k * kFrameS);
    Pose X_BO = flat;
    X_BO.p.x() += k < kSetsOut ? 0.0 : 0.05 * (k - kSetsOut) * kFrameS;  // [m], at 0.05 m/s
    UpdatePoses(config, square, ViewOf(square, X_BC, X_BO, k, 0.03, draw), choice);
    still_until = choice.is_still ? k : still_until;
    if (k >= 60) {
      worst = std::max(worst, (MotionAt(choice, choice.stamp_ns).X_BO.p - X_BO.p).norm());
    }
  }
  std::cout << "still for " << still_until - kSetsOut << " frames more, off by at most " << 1e3 * worst
            << " mm\n";
  EXPECT_GE(still_until, kSetsOut - 1);
  EXPECT_LE(still_until, kSetsOut + 3);
  EXPECT_LT(worst, 0.006);
}

}  // namespace
}  // namespace fovea::servo
