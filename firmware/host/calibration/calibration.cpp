// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/calibration/calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "firmware/core/model/rotation.hpp"

namespace fovea::calibration {
namespace {

using model::Mat3;
using model::Vec3;

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr std::size_t kFewestViews = 4;
constexpr double kLeastTiltDeg = 8.0;  // between the two views that differ most
constexpr double kMostRmsPx = 2.0;

// Positions on the board of the corners in `view` [m].
std::vector<cv::Point3f> CornersOf(const Board& board, const BoardView& view) {
  std::vector<cv::Point3f> corners;
  corners.reserve(view.ids.size());
  for (const int id : view.ids) {
    corners.push_back(CornerOf(board, id));
  }
  return corners;
}

void CheckCount(std::size_t views) {
  if (views < kFewestViews) {
    throw CalibrationError("the board is in " + std::to_string(views) + " views; at least " +
                           std::to_string(kFewestViews) + " are needed");
  }
}

Vec3 ToVec3(const cv::Mat& m) { return {m.at<double>(0), m.at<double>(1), m.at<double>(2)}; }

cv::Matx33d CameraMatrix(const vision::Intrinsics& in) {
  return {in.f_u_px, 0.0, in.c_u_px, 0.0, in.f_v_px, in.c_v_px, 0.0, 0.0, 1.0};
}

cv::Mat ToMat(const Mat3& R) {
  cv::Mat m(3, 3, CV_64F);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      m.at<double>(i, j) = R(i, j);
    }
  }
  return m;
}

std::size_t WorstOf(const cv::Mat& per_view) {
  double most = 0.0;
  cv::Point worst;
  cv::minMaxLoc(per_view, nullptr, &most, nullptr, &worst);
  return static_cast<std::size_t>(std::max(worst.x, worst.y));
}

}  // namespace

FocalLength SolveFocalLength(const std::vector<RadiusView>& views, double diameter, bool sphere) {
  if (views.size() < 2) {
    throw CalibrationError("at least two views are needed");
  }
  std::vector<RadiusView> ordered = views;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.moved < b.moved; });
  const RadiusView& near = ordered.front();
  const RadiusView& far = ordered.back();
  const double dZ = far.moved - near.moved;
  const double unsure = 3.0 * std::hypot(near.sigma_px, far.sigma_px);
  if (!(dZ > 0.0) || near.radius_px - far.radius_px <= unsure) {
    throw CalibrationError("the target must look clearly smaller in the farthest view than in the nearest");
  }
  for (std::size_t k = 1; k < ordered.size(); ++k) {
    const RadiusView& nearer = ordered[k - 1];
    const RadiusView& farther = ordered[k];
    if (farther.moved > nearer.moved && !(farther.radius_px < nearer.radius_px)) {
      std::ostringstream why;
      why << "the target must look smaller in each farther view, but its radius is " << nearer.radius_px
          << " px at +" << nearer.moved << " m and " << farther.radius_px << " px at +" << farther.moved
          << " m";
      throw CalibrationError(why.str());
    }
  }
  const double R = 0.5 * diameter;
  // Start value: the formula for two views.
  FocalLength result;
  result.f_px = 2.0 * dZ * near.radius_px * far.radius_px / (diameter * (near.radius_px - far.radius_px));
  result.Z = result.f_px * R / near.radius_px - near.moved;
  Eigen::Matrix2d normal;
  double chi2 = 0.0;
  constexpr int kRounds = 20;
  for (int round = 0; round < kRounds; ++round) {
    normal.setZero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    chi2 = 0.0;
    double sum2 = 0.0;
    for (const RadiusView& view : views) {
      const double Z = result.Z + view.moved;
      const double depth = sphere ? std::sqrt(std::max(Z * Z - R * R, 1e-9)) : Z;
      const double r = result.f_px * R / depth;
      const Eigen::Vector2d row(r / result.f_px, -r / depth * (sphere ? Z / depth : 1.0));
      const double weight = 1.0 / std::max(view.sigma_px * view.sigma_px, 1e-8);
      const double e = view.radius_px - r;
      normal += weight * row * row.transpose();
      right += weight * e * row;
      chi2 += weight * e * e;
      sum2 += e * e;
    }
    const Eigen::Vector2d step = normal.inverse() * right;
    result.f_px += step[0];
    result.Z += step[1];
    result.rms_px = std::sqrt(sum2 / static_cast<double>(views.size()));
  }
  const double freedom = static_cast<double>(views.size()) - 2.0;
  const double scale = freedom > 0.0 ? std::max(1.0, chi2 / freedom) : 1.0;
  result.sigma_px = std::sqrt(scale * normal.inverse()(0, 0));
  if (!(result.f_px > 0.0) || !(result.Z > 0.0) || !std::isfinite(result.sigma_px)) {
    throw CalibrationError("no focal length explains these radii");
  }
  return result;
}

IntrinsicsResult SolveIntrinsics(const std::vector<BoardView>& views, const Board& board, cv::Size size) {
  CheckCount(views.size());
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> image;
  for (const BoardView& view : views) {
    object.push_back(CornersOf(board, view));
    image.push_back(view.corners);
  }
  cv::Mat K, lens, deviations, ignored, per_view;
  std::vector<cv::Mat> turns, places;
  IntrinsicsResult result;
  try {
    result.rms_px =
        cv::calibrateCamera(object, image, size, K, lens, turns, places, deviations, ignored, per_view);
  } catch (const cv::Exception&) {
    throw CalibrationError(
        "the views do not determine a camera: they are too similar, or show too little of the board");
  }
  result.views = static_cast<int>(views.size());
  double apart = 0.0;
  for (const cv::Mat& a : turns) {
    for (const cv::Mat& b : turns) {
      const Vec3 na = model::RotationOf(ToVec3(a)).col(2);
      const Vec3 nb = model::RotationOf(ToVec3(b)).col(2);
      apart = std::max(apart, std::acos(std::clamp(na.dot(nb), -1.0, 1.0)));
    }
  }
  if (apart < kLeastTiltDeg * kDeg) {
    throw CalibrationError(
        "all views look at the board from nearly the same side: tilt the board by at least 20 degrees");
  }
  if (!(result.rms_px < kMostRmsPx)) {
    throw CalibrationError(
        "the views do not fit one camera and this board: " + std::to_string(result.rms_px) +
        " px rms, the worst of them is " + views[WorstOf(per_view)].name);
  }
  vision::Intrinsics& in = result.intrinsics;
  in.width_px = size.width;
  in.height_px = size.height;
  in.f_u_px = K.at<double>(0, 0);
  in.f_v_px = K.at<double>(1, 1);
  in.c_u_px = K.at<double>(0, 2);
  in.c_v_px = K.at<double>(1, 2);
  in.lens = {lens.at<double>(0), lens.at<double>(1), lens.at<double>(2), lens.at<double>(3),
             lens.at<double>(4)};
  result.sigma_f_px = std::max(deviations.at<double>(0), deviations.at<double>(1));
  result.sigma_c_px = std::max(deviations.at<double>(2), deviations.at<double>(3));
  return result;
}

HandEyeResult SolveHandEye(const std::vector<HandView>& views, const Board& board,
                           const vision::Intrinsics& in) {
  CheckCount(views.size());
  // The hand must turn about two different axes.
  double across = 0.0;
  for (const HandView& a : views) {
    for (const HandView& b : views) {
      const Vec3 ta = model::RotationVector(views.front().X_BE.R.transpose() * a.X_BE.R);
      const Vec3 tb = model::RotationVector(views.front().X_BE.R.transpose() * b.X_BE.R);
      across = std::max(across, model::Cross(ta, tb).norm());
    }
  }
  if (across < kLeastTiltDeg * kDeg * kLeastTiltDeg * kDeg) {
    throw CalibrationError(
        "the hand turned about only one axis, or hardly: turn it by at least 20 degrees about two axes");
  }
  const std::vector<double> lens{in.lens.k1, in.lens.k2, in.lens.p1, in.lens.p2, in.lens.k3};
  std::vector<cv::Mat> hand_R, hand_p, board_R, board_p;
  std::vector<model::Pose> X_CO;
  double off2_px = 0.0;
  std::size_t corners = 0;
  for (const HandView& view : views) {
    const std::vector<cv::Point3f> object = CornersOf(board, view.board);
    cv::Mat turn, place;
    cv::solvePnP(object, view.board.corners, CameraMatrix(in), lens, turn, place, false,
                 cv::SOLVEPNP_ITERATIVE);
    std::vector<cv::Point2f> seen;
    cv::projectPoints(object, turn, place, CameraMatrix(in), lens, seen);
    off2_px += std::pow(cv::norm(seen, view.board.corners, cv::NORM_L2), 2);
    corners += seen.size();
    X_CO.push_back({model::RotationOf(ToVec3(turn)), ToVec3(place)});
    hand_R.push_back(ToMat(view.X_BE.R));
    hand_p.push_back((cv::Mat_<double>(3, 1) << view.X_BE.p.x(), view.X_BE.p.y(), view.X_BE.p.z()));
    board_R.push_back(ToMat(X_CO.back().R));
    board_p.push_back(place);
  }
  HandEyeResult result;
  result.rms_px = std::sqrt(off2_px / static_cast<double>(corners));
  if (!(result.rms_px < kMostRmsPx)) {
    throw CalibrationError("these intrinsics do not fit the images: the board's corners are " +
                           std::to_string(result.rms_px) + " px rms off");
  }
  cv::Mat R, p;
  cv::calibrateHandEye(hand_R, hand_p, board_R, board_p, R, p, cv::CALIB_HAND_EYE_PARK);
  result.views = static_cast<int>(views.size());
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result.X_EC.R(i, j) = R.at<double>(i, j);
    }
  }
  result.X_EC.p = ToVec3(p);
  // The board stands still, so the spread of its poses in B measures the error.
  Vec3 mean = Vec3::Zero();
  std::vector<model::Pose> X_BO;
  for (std::size_t i = 0; i < views.size(); ++i) {
    X_BO.push_back(views[i].X_BE * result.X_EC * X_CO[i]);
    mean += X_BO.back().p / static_cast<double>(views.size());
  }
  Vec3 turn = Vec3::Zero();
  for (const model::Pose& X : X_BO) {
    turn += model::RotationVector(X_BO.front().R.transpose() * X.R) / static_cast<double>(views.size());
  }
  const Mat3 mean_R = X_BO.front().R * model::RotationOf(turn);
  double mm2 = 0.0;
  double deg2 = 0.0;
  for (const model::Pose& X : X_BO) {
    mm2 += 1e6 * (X.p - mean).squaredNorm();
    deg2 += model::RotationVector(mean_R.transpose() * X.R).squaredNorm() / (kDeg * kDeg);
  }
  result.rms_mm = std::sqrt(mm2 / static_cast<double>(views.size()));
  result.rms_deg = std::sqrt(deg2 / static_cast<double>(views.size()));
  if (!result.X_EC.R.allFinite() || !result.X_EC.p.allFinite()) {
    throw CalibrationError("the hand's poses and the views do not determine the camera's place");
  }
  return result;
}

}  // namespace fovea::calibration
