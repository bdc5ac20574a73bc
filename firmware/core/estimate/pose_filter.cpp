// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/pose_filter.hpp"

#include <cmath>

#include "firmware/core/estimate/first_sight.hpp"
#include "firmware/core/estimate/shortened.hpp"
#include "firmware/core/estimate/stamp_error.hpp"
#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using features::Polygon;
using features::SeenCorners;
using model::Mat3;
using model::Vec3;

constexpr double kStartTurnSigma = 0.5;      // how fast a target may turn when it is first seen [rad/s]
constexpr double kStartPositionSigma = 1.0;  // error of the corners' pose in directions that they do
constexpr double kStartTiltSigma = 0.3;      // not determine [m, rad]
constexpr double kMeanTime = 0.1;  // the configured jerk and angular acceleration are means over this [s]
constexpr double kNoWay = 1e9;     // a distance that passes no gate

using StateCovariance = Eigen::Matrix<double, PoseFilter::kDim, PoseFilter::kDim>;

// A target's corners, as kSize numbers. Sizes that the compiler knows save a third of a correction's work.
template <int kSize>
struct OfCorners {
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Slope = Eigen::Matrix<double, kSize, 6>;
  using Gain = Eigen::Matrix<double, kSize, PoseFilter::kDim>;
};

// Adds a b^T to the lower half of `S`, entry by entry; the Cholesky factor reads no other half. `a`, `b` [n x
// k].
template <typename Left, typename Right, typename Covariance>
void AddLower(const Left& a, const Right& b, Covariance& S) noexcept {
  for (Eigen::Index j = 0; j < S.cols(); ++j) {
    for (Eigen::Index i = j; i < S.rows(); ++i) {
      S(i, j) += a.row(i).cwiseProduct(b.row(j)).sum();
    }
  }
}

// H P + by_late P_late: the covariance of the seen corners with the state. `H`: their slope over the pose,
// `by_late`: over the stamps' common error. Two rows by two columns: each entry of H and P is loaded half as
// often.
template <int kSize>
typename OfCorners<kSize>::Gain WithState(const typename OfCorners<kSize>::Slope& H,
                                          const typename OfCorners<kSize>::Vector& by_late,
                                          const StateCovariance& P) noexcept {
  typename OfCorners<kSize>::Gain Y;
  for (Eigen::Index j = 0; j < PoseFilter::kDim; j += 2) {
    for (Eigen::Index i = 0; i < kSize; i += 2) {
      double sum_00 = by_late[i] * P(PoseFilter::kLate, j);
      double sum_10 = by_late[i + 1] * P(PoseFilter::kLate, j);
      double sum_01 = by_late[i] * P(PoseFilter::kLate, j + 1);
      double sum_11 = by_late[i + 1] * P(PoseFilter::kLate, j + 1);
      for (Eigen::Index k = 0; k < 6; ++k) {
        sum_00 += H(i, k) * P(k, j);
        sum_10 += H(i + 1, k) * P(k, j);
        sum_01 += H(i, k) * P(k, j + 1);
        sum_11 += H(i + 1, k) * P(k, j + 1);
      }
      Y(i, j) = sum_00;
      Y(i + 1, j) = sum_10;
      Y(i, j + 1) = sum_01;
      Y(i + 1, j + 1) = sum_11;
    }
  }
  return Y;
}

// P -= Y^T Y, and P = (P + P^T) / 2. The product is symmetric to the last bit; P is not quite. Two columns by
// two: each entry of Y is loaded half as often.
template <typename Gain>
void Reduce(const Gain& Y, StateCovariance& P) noexcept {
  const auto subtract = [&P](Eigen::Index i, Eigen::Index j, double product) {
    P(i, j) = P(j, i) = 0.5 * ((P(i, j) - product) + (P(j, i) - product));
  };
  for (Eigen::Index j = 0; j < PoseFilter::kDim; j += 2) {
    for (Eigen::Index i = j; i < PoseFilter::kDim; i += 2) {
      double sum_00 = Y(0, i) * Y(0, j);
      double sum_10 = Y(0, i + 1) * Y(0, j);
      double sum_01 = Y(0, i) * Y(0, j + 1);
      double sum_11 = Y(0, i + 1) * Y(0, j + 1);
      for (Eigen::Index k = 1; k < Y.rows(); ++k) {
        sum_00 += Y(k, i) * Y(k, j);
        sum_10 += Y(k, i + 1) * Y(k, j);
        sum_01 += Y(k, i) * Y(k, j + 1);
        sum_11 += Y(k, i + 1) * Y(k, j + 1);
      }
      subtract(i, j, sum_00);
      subtract(i + 1, j, sum_10);
      subtract(i + 1, j + 1, sum_11);
      if (i != j) {
        subtract(i, j + 1, sum_01);
      }
    }
  }
}

// The derivative of the corners by the camera's twist in C; zero if a corner is not in front of the camera.
CornerSlope SlopeByCamera(const Polygon& polygon, const model::Pose& X_CO) noexcept {
  CornerSlope by_camera(2 * polygon.num_corners, 6);
  for (int i = 0; i < polygon.num_corners; ++i) {
    features::ImagePoint point;
    if (!features::ComputePoint(X_CO * polygon.corners[static_cast<std::size_t>(i)], Vec3::Zero(), point)) {
      by_camera.setZero();
      break;
    }
    by_camera.middleRows<2>(2 * i) = point.L;
  }
  return by_camera;
}

// Rolling shutter: how the seen corners `xy` depend on the target's velocity and turn rate. Each is seen
// delta after the stamp, so it has moved by delta times these. `H`: their slope over the pose; the result is
// over velocity and turn rate.
template <typename Vector, typename Slope>
Slope SlopeByRates(const CornerView& view, const Vector& xy, Slope H) noexcept {
  for (Eigen::Index i = 0; i + 1 < xy.size(); i += 2) {
    H.template middleRows<2>(i) *= view.row_time * (xy[i + 1] - view.row_y);
  }
  return H;
}

// Adds the noise of the camera's own pose to the lower half of `cov`.
template <typename Slope, typename Covariance>
void AddCameraNoise(Slope by_camera, Covariance& cov) noexcept {
  by_camera.template leftCols<3>() *= kCameraShiftSigma;
  by_camera.template rightCols<3>() *= kCameraTurnSigma;
  AddLower(by_camera, by_camera, cov);
}

// The squared distance of `innovation` in standard deviations of `S`.
template <typename Covariance, typename Vector>
double Distance2(Covariance S, Vector innovation) noexcept {
  model::FactorCholesky(S);
  model::SolveLower(S, innovation);
  return innovation.squaredNorm();
}

// What a focal length that is wrong by its whole size does to the corners `xy` and no pose of the camera
// explains: the part of d(xy)/d(ln f) = xy that is perpendicular to the columns of `by_camera`. A near tilted
// square's perspective does not fit a wrong focal length. Zero if the columns depend on each other.
SeenCorners::Vector ShapeByFocalLength(const CornerSlope& by_camera, const SeenCorners::Vector& xy) noexcept {
  model::Mat6 normal = by_camera.transpose().lazyProduct(by_camera);
  model::Vec6 pose = by_camera.transpose().lazyProduct(xy);
  model::FactorCholesky(normal);
  model::SolveCholesky(normal, pose);
  SeenCorners::Vector shape = xy - by_camera.lazyProduct(pose);
  if (!shape.allFinite()) {
    shape.setZero();
  }
  return shape;
}

void Advance(const config::PredictConfig& config, double dt, PoseFilter& f) noexcept {
  using F = PoseFilter;
  const Vec3 turn = f.w_BO_B * dt;
  const Mat3 E = model::RotationOf(turn);
  const Mat3 G = model::TurnRateMatrix(turn) * dt;
  f.X_BO.p += dt * (f.v_BO_B + 0.5 * dt * f.a_BO_B);
  f.v_BO_B += dt * f.a_BO_B;
  f.X_BO.R = E * f.X_BO.R;
  // P' = F P F^T + Q: the rows first, then the columns.
  auto& P = f.P;
  P.middleRows<3>(F::kPosition) +=
      dt * P.middleRows<3>(F::kVelocity) + 0.5 * dt * dt * P.middleRows<3>(F::kAcceleration);
  P.middleRows<3>(F::kVelocity) += dt * P.middleRows<3>(F::kAcceleration);
  P.middleRows<3>(F::kTurn) = (E * P.middleRows<3>(F::kTurn) + G * P.middleRows<3>(F::kTurnRate)).eval();
  P.middleCols<3>(F::kPosition) +=
      dt * P.middleCols<3>(F::kVelocity) + 0.5 * dt * dt * P.middleCols<3>(F::kAcceleration);
  P.middleCols<3>(F::kVelocity) += dt * P.middleCols<3>(F::kAcceleration);
  P.middleCols<3>(F::kTurn) =
      (P.middleCols<3>(F::kTurn) * E.transpose() + P.middleCols<3>(F::kTurnRate) * G.transpose()).eval();
  const double j = config.target_jerk * config.target_jerk * kMeanTime;  // [m^2/s^5]
  const double q = config.target_turn * config.target_turn * kMeanTime;  // [rad^2/s^3]
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  const auto add = [&P](int row, int col, double value) {
    for (int i = 0; i < 3; ++i) {
      P(row + i, col + i) += value;
      if (row != col) {
        P(col + i, row + i) += value;
      }
    }
  };
  add(F::kPosition, F::kPosition, j * dt3 * dt2 / 20.0);
  add(F::kPosition, F::kVelocity, j * dt2 * dt2 / 8.0);
  add(F::kPosition, F::kAcceleration, j * dt3 / 6.0);
  add(F::kVelocity, F::kVelocity, j * dt3 / 3.0);
  add(F::kVelocity, F::kAcceleration, j * dt2 / 2.0);
  add(F::kAcceleration, F::kAcceleration, j * dt);
  add(F::kTurn, F::kTurn, q * dt3 / 3.0);
  add(F::kTurn, F::kTurnRate, q * dt2 / 2.0);
  add(F::kTurnRate, F::kTurnRate, q * dt);
  P(F::kLate, F::kLate) = DriftedVariance(P(F::kLate, F::kLate), dt, config.stamp_sigma);
}

// Begins the estimate of the stamps' common error: what it adds to the measured pose, the motion of a plate
// that the camera holds, it takes from the state.
void AddLateness(const CornerView& view, PoseFilter& start) noexcept {
  using F = PoseFilter;
  const model::Pose X_BC = view.X_CB.Inverse();
  const Vec3 p_CO_C = view.X_CB * start.X_BO.p;
  model::Vec6 V_BO_held;  // in axes of B
  V_BO_held << X_BC.R * (view.V_BC_C.head<3>() + model::CrossMatrix(view.V_BC_C.tail<3>()) * p_CO_C),
      X_BC.R * view.V_BC_C.tail<3>();
  const double P_late = view.late_sigma * view.late_sigma;
  start.late = view.late;
  start.P.topLeftCorner<6, 6>() += P_late * V_BO_held * V_BO_held.transpose();
  start.P.col(F::kLate).head<6>() = -P_late * V_BO_held;
  start.P.row(F::kLate).head<6>() = -P_late * V_BO_held.transpose();
  start.P(F::kLate, F::kLate) = P_late;
}

// UpdatePose for a target with kSize / 2 corners. If false, `next` is of no use.
template <int kSize>
bool Correct(const config::PredictConfig& config, const Polygon& polygon, const CornerView& view,
             PoseFilter& next, double& distance2) noexcept {
  using F = PoseFilter;
  using Slope = typename OfCorners<kSize>::Slope;
  using Vector = typename OfCorners<kSize>::Vector;
  using Covariance = typename OfCorners<kSize>::Covariance;
  distance2 = kNoWay;
  Advance(config, hal::ToSeconds(view.stamp_ns - next.stamp_ns), next);
  SeenCorners::Vector xy_expected;
  CornerSlope slope;
  SeenCorners::Covariance bent;
  if (!ExpectAround(polygon, view.X_CB, next.X_BO, next.P.topLeftCorner<6, 6>(), xy_expected, slope, bent)) {
    return false;
  }
  SeenCorners::Vector xy;
  SeenCorners::Covariance noise;
  InOrder(view.seen, NearestFirst(view.seen.xy, xy_expected), xy, noise);
  const Vector expected = xy_expected.template head<kSize>();
  const Slope H = slope.template topRows<kSize>();
  const Slope by_camera = SlopeByCamera(polygon, view.X_CB * next.X_BO).template topRows<kSize>();
  Covariance S = noise.template topLeftCorner<kSize, kSize>();
  AddCameraNoise(by_camera, S);
  const Vector by_late = -by_camera.lazyProduct(view.V_BC_C);
  Vector innovation = xy.template head<kSize>();
  Slope by_rates;
  if (view.row_time > 0.0) {
    by_rates = SlopeByRates(view, innovation, H);
  }
  innovation -= expected + (next.late - view.late) * by_late;
  if (view.row_time > 0.0) {
    innovation -=
        by_rates.template leftCols<3>() * next.v_BO_B + by_rates.template rightCols<3>() * next.w_BO_B;
  }
  // With S = L L^T and Y = L^-1 H P, the gain is Y^T L^-1 and reduces P by Y^T Y. Of S, only the lower half
  // is computed.
  typename OfCorners<kSize>::Gain Y = WithState<kSize>(H, by_late, next.P);
  if (view.row_time > 0.0) {
    Y += by_rates.template leftCols<3>().lazyProduct(next.P.middleRows<3>(F::kVelocity));
    Y += by_rates.template rightCols<3>().lazyProduct(next.P.middleRows<3>(F::kTurnRate));
    AddLower(Y.template middleCols<3>(F::kVelocity), by_rates.template leftCols<3>(), S);
    AddLower(Y.template middleCols<3>(F::kTurnRate), by_rates.template rightCols<3>(), S);
  }
  AddLower(Y.template leftCols<6>(), H, S);
  AddLower(Y.col(F::kLate), by_late, S);
  S += bent.template topLeftCorner<kSize, kSize>();
  const double gate2 = config.gate_sigma * config.gate_sigma;
  const Covariance S_noise = S;
  const Vector off_by = innovation;
  model::FactorCholesky(S);
  model::SolveLower(S, Y);
  model::SolveLower(S, innovation);
  const double off = innovation.squaredNorm();
  if (!(off < kNoWay)) {
    return false;
  }
  distance2 = off;
  if (off > gate2) {
    const model::Mat6 doubt =
        view.doubt != nullptr ? view.doubt->OfCamera() : model::Mat6(model::Mat6::Zero());
    const Slope doubted = by_camera.lazyProduct(doubt);
    const Vector bent_by_focal =
        config.scale_sigma * ShapeByFocalLength(by_camera, xy_expected).template head<kSize>();
    const Covariance S_doubt = S_noise + doubted.lazyProduct(by_camera.transpose()) +
                               bent_by_focal.lazyProduct(bent_by_focal.transpose());
    if (!(Distance2(S_doubt, off_by) <= gate2)) {
      return false;
    }
  }
  const Eigen::Matrix<double, F::kDim, 1> correction = Y.transpose().lazyProduct(innovation);
  Reduce(Y, next.P);
  next.X_BO.p += correction.segment<3>(F::kPosition);
  next.X_BO.R = model::RotationOf(correction.segment<3>(F::kTurn)) * next.X_BO.R;
  next.v_BO_B += correction.segment<3>(F::kVelocity);
  next.a_BO_B += correction.segment<3>(F::kAcceleration);
  next.w_BO_B += correction.segment<3>(F::kTurnRate);
  next.late = CredibleLateness(next.late + correction[F::kLate], config.stamp_offset, config.stamp_sigma);
  next.v_BO_B = Shortened(next.v_BO_B, config.target_speed_max);
  next.a_BO_B = Shortened(next.a_BO_B, config.target_acceleration_max);
  next.w_BO_B = Shortened(next.w_BO_B, config.target_turn_max);
  next.stamp_ns = view.stamp_ns;
  return true;
}

}  // namespace

bool StartPose(const Polygon& polygon, const CornerView& view, const SeenCorners::Branch& branch,
               PoseFilter& filter) noexcept {
  constexpr int kRounds = 2;  // of Gauss-Newton: the branch is near
  SeenCorners::Vector xy;
  SeenCorners::Covariance L;
  InOrder(view.seen, branch.first, xy, L);
  PoseFilter start;
  start.stamp_ns = view.stamp_ns;
  start.X_BO = view.X_CB.Inverse() * branch.X_CO;
  if (view.row_time > 0.0) {  // the target's velocity is not known yet
    CornerSlope by_pose;
    SlopeOfCorners(polygon, view.X_CB, start.X_BO, by_pose);
    CornerSlope by_rates = SlopeByRates(view, xy, by_pose);
    by_rates.leftCols<3>() *= kStartSpeedSigma;
    by_rates.rightCols<3>() *= kStartTurnSigma;
    L += by_rates.lazyProduct(by_rates.transpose());
  }
  model::FactorCholesky(L);
  model::Mat6 cov;
  for (int round = 0; round <= kRounds; ++round) {
    SeenCorners::Vector e;
    CornerSlope H;
    if (!ExpectCorners(polygon, view.X_CB, start.X_BO, e)) {
      return false;
    }
    SlopeOfCorners(polygon, view.X_CB, start.X_BO, H);
    e = xy - e;
    model::SolveLower(L, e);
    model::SolveLower(L, H);
    model::Mat6 information = H.transpose().lazyProduct(H);
    information.diagonal().head<3>().array() += 1.0 / (kStartPositionSigma * kStartPositionSigma);
    information.diagonal().tail<3>().array() += 1.0 / (kStartTiltSigma * kStartTiltSigma);
    model::FactorCholesky(information);
    if (round == kRounds) {
      cov.setIdentity();
      model::SolveCholesky(information, cov);
      break;
    }
    model::Vec6 step = H.transpose().lazyProduct(e);
    model::SolveCholesky(information, step);
    start.X_BO.p += step.head<3>();
    start.X_BO.R = model::RotationOf(step.tail<3>()) * start.X_BO.R;
  }
  start.P.topLeftCorner<6, 6>() = 0.5 * (cov + cov.transpose());
  const auto spread = [&start](int part, double sigma) {
    start.P.diagonal().segment<3>(part).fill(sigma * sigma);
  };
  spread(PoseFilter::kVelocity, kStartSpeedSigma);
  spread(PoseFilter::kAcceleration, kStartAccelerationSigma);
  spread(PoseFilter::kTurnRate, kStartTurnSigma);
  AddLateness(view, start);
  if (!start.P.allFinite() || !start.X_BO.p.allFinite() || !start.X_BO.R.allFinite()) {
    return false;
  }
  filter = start;
  return true;
}

bool UpdatePose(const config::PredictConfig& config, const Polygon& polygon, const CornerView& view,
                PoseFilter& filter, double& distance2) noexcept {
  static_assert(Polygon::kMost == 4);
  const PoseFilter before = filter;
  const bool fits = polygon.num_corners == 4 ? Correct<8>(config, polygon, view, filter, distance2)
                                             : Correct<6>(config, polygon, view, filter, distance2);
  if (!fits) {
    filter = before;
  }
  return fits;
}

FlatMotion MotionAt(const config::PredictConfig& config, const PoseFilter& filter,
                    std::int64_t now_ns) noexcept {
  const double dt = hal::ToSeconds(now_ns - filter.stamp_ns) + filter.late;
  const Mat3 R = model::RotationOf(filter.w_BO_B * dt).lazyProduct(filter.X_BO.R);
  const Vec3 way = dt * (filter.v_BO_B + 0.5 * dt * filter.a_BO_B);
  return {{R, filter.X_BO.p + Shortened(way, config.target_speed_max * std::fabs(dt))},
          Shortened(filter.v_BO_B + dt * filter.a_BO_B, config.target_speed_max),
          filter.w_BO_B};
}

}  // namespace fovea::estimate
