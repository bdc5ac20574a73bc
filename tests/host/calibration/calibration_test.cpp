// SPDX-License-Identifier: Apache-2.0
// Calibration recovers the camera parameters that the ray-cast pictures were made with.
#include "firmware/host/calibration/calibration.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "tools/bench/vision/picture.hpp"

namespace fovea::calibration {
namespace {

using model::Mat3;
using model::Vec3;

bench::PictureCamera Camera() {
  bench::PictureCamera camera;
  camera.f_px = 560.0;
  camera.c_u_px = 322.0;
  camera.c_v_px = 236.0;
  camera.lens << -0.12, 0.05, 0.001, -0.0015;
  return camera;
}

const Board kBoard{8, 5, 0.02, 0.0, ""};

// A picture of the board at pose X_CO. O's origin is the board's first inner corner.
cv::Mat BoardPicture(const bench::PictureCamera& camera, const model::Pose& X_CO, unsigned seed) {
  bench::PictureScene scene;
  scene.camera = camera;
  scene.noise = 2.0;
  scene.seed = seed;
  scene.ground_bgr.setConstant(120.0);
  bench::Body board;
  board.shape = bench::Shape::kPolygon;
  const double s = kBoard.square;
  const double right = (kBoard.columns + 1) * s;
  const double bottom = (kBoard.rows + 1) * s;
  board.R = X_CO.R;
  board.p = X_CO.p;
  board.corners = {{-2.0 * s, -2.0 * s}, {right, -2.0 * s}, {right, bottom}, {-2.0 * s, bottom}};
  board.bgr.setConstant(220.0);
  for (int row = -1; row < kBoard.rows; ++row) {
    for (int column = -1; column < kBoard.columns; ++column) {
      if ((row + column) % 2 == 0) {
        board.pattern.emplace_back((column + 0.5) * s, (row + 0.5) * s, 0.5 * s);
      }
    }
  }
  scene.bodies.push_back(board);
  scene.grid = 6;
  return bench::Draw(scene);
}

// A view of the board's centre, tilted by `tilt` [rad] towards `about`.
model::Pose Look(double tilt, double about, double turn, double distance, double u, double v) {
  model::Pose X_CO;
  X_CO.R = model::RotationOf(tilt * Vec3(std::cos(about), std::sin(about), 0.0)) *
           model::RotationOf(Vec3(0.0, 0.0, turn));
  const Vec3 middle(0.5 * (kBoard.columns - 1) * kBoard.square, 0.5 * (kBoard.rows - 1) * kBoard.square, 0.0);
  X_CO.p = Vec3(u, v, distance) - X_CO.R * middle;
  return X_CO;
}

std::vector<model::Pose> Looks() {
  return {Look(0.0, 0.0, 0.0, 0.24, 0.0, 0.0),       Look(0.5, 0.3, 0.2, 0.27, 0.03, 0.01),
          Look(0.5, 1.9, -0.2, 0.27, -0.03, 0.02),   Look(0.55, 3.4, 0.4, 0.26, 0.02, -0.02),
          Look(0.45, 5.0, -0.4, 0.28, -0.03, -0.02), Look(0.3, 4.0, 0.1, 0.22, 0.0, 0.015)};
}

TEST(CalibrationTest, RecoversIntrinsicsAndLens) {
  const bench::PictureCamera camera = Camera();
  std::vector<BoardView> views;
  for (const model::Pose& X_CO : Looks()) {
    BoardView view;
    ASSERT_TRUE(FindBoard(BoardPicture(camera, X_CO, static_cast<unsigned>(views.size())), kBoard, view));
    views.push_back(view);
  }
  const IntrinsicsResult r = SolveIntrinsics(views, kBoard, {640, 480});
  // The error of the whole lens model, at image points that the boards reached.
  const vision::Intrinsics truth{640,
                                 480,
                                 camera.f_px,
                                 camera.f_px,
                                 camera.c_u_px,
                                 camera.c_v_px,
                                 {camera.lens[0], camera.lens[1], camera.lens[2], camera.lens[3], 0.0}};
  double worst = 0.0;
  for (int column = -4; column <= 4; ++column) {
    for (int row = -3; row <= 3; ++row) {
      const Vec3 p(0.1 * column, 0.1 * row, 1.0);
      double u = truth.U(p), v = truth.V(p), u_found = r.intrinsics.U(p), v_found = r.intrinsics.V(p);
      truth.Distort(u, v);
      r.intrinsics.Distort(u_found, v_found);
      worst = std::max(worst, std::hypot(u - u_found, v - v_found));
    }
  }
  std::cout << "f " << r.intrinsics.f_u_px << " +- " << r.sigma_f_px << ", c " << r.intrinsics.c_u_px << " "
            << r.intrinsics.c_v_px << " +- " << r.sigma_c_px << ", rms " << r.rms_px
            << " px, points off by at most " << worst << " px\n";
  EXPECT_NEAR(r.intrinsics.f_u_px, camera.f_px, 1.5);
  EXPECT_NEAR(r.intrinsics.c_u_px, camera.c_u_px, 1.5);
  EXPECT_NEAR(r.intrinsics.c_v_px, camera.c_v_px, 1.5);
  EXPECT_LT(worst, 0.5);
  EXPECT_LT(r.rms_px, 0.08);

  EXPECT_THROW(SolveIntrinsics({views.begin(), views.begin() + 3}, kBoard, {640, 480}), CalibrationError);
  EXPECT_THROW(SolveIntrinsics(std::vector<BoardView>(5, views[1]), kBoard, {640, 480}), CalibrationError)
      << "all views from one direction";
}

// Each kind of useless views has its own error line.
TEST(CalibrationTest, ReportsWhyViewsAreUseless) {
  const vision::Intrinsics in{640, 480, 560.0, 560.0, 320.0, 240.0, {}};
  const auto seen = [&in](const model::Pose& X_CO, const char* name) {
    BoardView view;
    view.name = name;
    for (int id = 0; id < kBoard.columns * kBoard.rows; ++id) {
      const cv::Point3d corner = CornerOf(kBoard, id);
      const Vec3 p = X_CO * Vec3(corner.x, corner.y, 0.0);
      view.corners.emplace_back(static_cast<float>(in.U(p)), static_cast<float>(in.V(p)));
      view.ids.push_back(id);
    }
    return view;
  };
  const auto refusal = [](const std::vector<BoardView>& views) -> std::string {
    try {
      static_cast<void>(SolveIntrinsics(views, kBoard, {640, 480}));
    } catch (const CalibrationError& error) {
      return error.what();
    }
    return "";
  };
  std::vector<BoardView> views;
  for (const model::Pose& X_CO : Looks()) {
    views.push_back(seen(X_CO, ("view " + std::to_string(views.size())).c_str()));
  }
  EXPECT_EQ(refusal(views), "");
  std::vector<BoardView> wrong = views;
  wrong[3] = seen(Look(0.9, 1.0, 0.3, 0.2, 0.0, 0.0), "another board");
  for (cv::Point2f& corner : wrong[3].corners) {
    corner.x += 25.0F * std::sin(corner.y);
  }
  EXPECT_THAT(refusal(wrong), testing::HasSubstr("the worst of them is another board"));
  std::vector<BoardView> flat;
  for (const double distance : {0.22, 0.24, 0.26, 0.28, 0.3, 0.32}) {
    flat.push_back(seen(Look(0.02, 10.0 * distance, distance, distance, 0.0, 0.0), "flat"));
  }
  EXPECT_THAT(refusal(flat), testing::HasSubstr("from nearly the same side"));
  std::vector<BoardView> few = views;
  for (BoardView& view : few) {  // three corners of one row
    view.corners.resize(3);
    view.ids.resize(3);
  }
  EXPECT_THAT(refusal(few), testing::HasSubstr("do not determine a camera"));
  EXPECT_THROW(SolveFocalLength({{60.0, 0.01, 0.0}, {59.99, 0.01, 0.15}}, 0.08, false), CalibrationError)
      << "the difference is only noise";
}

TEST(CalibrationTest, DrawnChessboardIsFoundWhereItWasDrawn) {
  const cv::Mat drawn = DrawBoard(kBoard, 40);
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(255));
  cv::Mat gray(480, 640, CV_8UC1, cv::Scalar(255));
  drawn.copyTo(gray(cv::Rect(100, 60, drawn.cols, drawn.rows)));
  cv::cvtColor(gray, image, cv::COLOR_GRAY2BGR);
  for (const cv::Mat& picture : {image, gray}) {
    BoardView view;
    ASSERT_TRUE(FindBoard(picture, kBoard, view));
    ASSERT_EQ(view.corners.size(), 40U);
    double worst = 0.0;
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      const int column = view.ids[i] % kBoard.columns;
      const int row = view.ids[i] / kBoard.columns;
      const cv::Point2f there(139.5F + 40.0F * static_cast<float>(column),
                              99.5F + 40.0F * static_cast<float>(row));
      worst = std::max(worst, cv::norm(view.corners[i] - there));
    }
    std::cout << "corners off by at most " << worst << " px\n";
    EXPECT_LT(worst, 1e-3);
  }
  BoardView none;
  EXPECT_FALSE(FindBoard(cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)), kBoard, none));
  EXPECT_NO_THROW(CheckBoard(kBoard)) << "a board without markers needs no dictionary";
  EXPECT_THROW(CheckBoard({8, 5, 0.02, 0.014, "9x9_50"}), CalibrationError);
}

vision::Intrinsics IntrinsicsOf(const bench::PictureCamera& camera) {
  return {640,
          480,
          camera.f_px,
          camera.f_px,
          camera.c_u_px,
          camera.c_v_px,
          {camera.lens[0], camera.lens[1], camera.lens[2], camera.lens[3], 0.0}};
}

// The board of DrawBoard, seen through a camera with a lens. Each pixel is the mean of 3 x 3 rays.
cv::Mat SeenBoard(const Board& board, const vision::Intrinsics& in, const model::Pose& X_CO, unsigned seed) {
  constexpr int kSquarePx = 160;
  constexpr int kRays = 3;
  const cv::Mat drawn = DrawBoard(board, kSquarePx);
  cv::Mat image(in.height_px, in.width_px, CV_8UC1);
  cv::RNG random(seed);
  const model::Pose X_OC = X_CO.Inverse();
  for (int v = 0; v < in.height_px; ++v) {
    for (int u = 0; u < in.width_px; ++u) {
      double sum = 0.0;
      for (int i = 0; i < kRays * kRays; ++i) {
        const int aside = i % kRays - 1;
        const int below = i / kRays - 1;
        double u_px = u + aside / 3.0;
        double v_px = v + below / 3.0;
        in.Undistort(u_px, v_px);
        const Vec3 d = X_OC.R * in.Ray(u_px, v_px);
        const Vec3 p = X_OC.p - X_OC.p.z() / d.z() * d;
        const auto column = static_cast<int>(std::floor((p.x() / board.square + 1.0) * kSquarePx));
        const auto row = static_cast<int>(std::floor((p.y() / board.square + 1.0) * kSquarePx));
        const bool on_board = column >= 0 && row >= 0 && column < drawn.cols && row < drawn.rows;
        sum += on_board ? 30.0 + 0.75 * drawn.at<std::uint8_t>(row, column) : 150.0;
      }
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(sum / (kRays * kRays) + random.gaussian(2.0));
    }
  }
  return image;
}

const Board kCharuco{8, 5, 0.02, 0.014, "5x5_100"};

// A visible part of a ChArUco board suffices; here a third of it lies outside every picture.
TEST(CalibrationTest, PartlyVisibleCharucoBoardSuffices) {
  const bench::PictureCamera camera = Camera();
  const vision::Intrinsics in = IntrinsicsOf(camera);
  const model::Pose X_EC{model::RotationOf(Vec3(0.05, -0.03, 1.6)), Vec3(0.05, -0.01, 0.04)};
  const model::Pose X_BO{model::RotationOf(Vec3(0.2, 0.1, 0.5)), Vec3(0.5, 0.1, 0.02)};
  std::vector<BoardView> views;
  std::vector<HandView> hands;
  std::size_t partial = 0;
  double off2 = 0.0;
  std::size_t corners = 0;
  for (model::Pose X_CO : Looks()) {
    X_CO.p.x() += views.size() % 2 == 0 ? 0.07 : -0.07;
    const unsigned seed = static_cast<unsigned>(views.size()) + 1;
    BoardView view;
    ASSERT_TRUE(FindBoard(SeenBoard(kCharuco, in, X_CO, seed), kCharuco, view)) << "view " << seed;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
      const cv::Point3d corner = CornerOf(kCharuco, view.ids[i]);
      const Vec3 p = X_CO * Vec3(corner.x, corner.y, 0.0);
      double u = in.U(p);
      double v = in.V(p);
      in.Distort(u, v);
      const cv::Point2d off = cv::Point2d(u, v) - cv::Point2d(view.corners[i]);
      off2 += off.dot(off);
    }
    corners += view.ids.size();
    partial += view.ids.size() < 40 ? 1U : 0U;
    views.push_back(view);
    hands.push_back({X_BO * X_CO.Inverse() * X_EC.Inverse(), view});
  }
  EXPECT_GE(partial, 2U) << "no board is cut off";
  const double rms = std::sqrt(off2 / static_cast<double>(corners));
  const IntrinsicsResult r = SolveIntrinsics(views, kCharuco, {640, 480});
  const HandEyeResult hand = SolveHandEye(hands, kCharuco, in);
  const double off_mm = 1e3 * (hand.X_EC.p - X_EC.p).norm();
  std::cout << corners << " corners, " << rms << " px rms off; f " << r.intrinsics.f_u_px << " +- "
            << r.sigma_f_px << ", c " << r.intrinsics.c_u_px << " " << r.intrinsics.c_v_px << " +- "
            << r.sigma_c_px << ", rms " << r.rms_px << " px; X_EC off " << off_mm << " mm\n";
  EXPECT_LT(rms, 0.12);
  EXPECT_NEAR(r.intrinsics.f_u_px, camera.f_px, 1.0);
  EXPECT_NEAR(r.intrinsics.c_u_px, camera.c_u_px, 1.2);
  EXPECT_NEAR(r.intrinsics.c_v_px, camera.c_v_px, 1.2);
  EXPECT_LT(off_mm, 0.2);

  vision::Intrinsics other = in;
  other.f_u_px *= 1.25;
  EXPECT_THROW(SolveHandEye(hands, kCharuco, other), CalibrationError) << "intrinsics of another camera";
  EXPECT_THROW(CheckBoard({8, 5, 0.02, 0.0195, "5x5_100"}), CalibrationError)
      << "markers as large as squares";
  EXPECT_THROW(CheckBoard({20, 20, 0.02, 0.014, "5x5_50"}), CalibrationError) << "too few markers";
  EXPECT_NO_THROW(CheckBoard(kCharuco));
  BoardView none;
  EXPECT_FALSE(FindBoard(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)), kCharuco, none));
  EXPECT_FALSE(FindBoard(cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)), kCharuco, none));
}

TEST(CalibrationTest, RecoversTheCameraPoseOnTheHand) {
  const bench::PictureCamera camera = Camera();
  const vision::Intrinsics in = IntrinsicsOf(camera);
  const model::Pose X_EC{model::RotationOf(Vec3(0.05, -0.03, 1.6)), Vec3(0.05, -0.01, 0.04)};
  const model::Pose X_BO{model::RotationOf(Vec3(0.2, 0.1, 0.5)), Vec3(0.5, 0.1, 0.02)};
  std::vector<HandView> views;
  for (const model::Pose& X_CO : Looks()) {
    HandView view;
    ASSERT_TRUE(
        FindBoard(BoardPicture(camera, X_CO, static_cast<unsigned>(views.size())), kBoard, view.board));
    view.X_BE = X_BO * X_CO.Inverse() * X_EC.Inverse();
    views.push_back(view);
  }
  const HandEyeResult r = SolveHandEye(views, kBoard, in);
  const double off_mm = 1e3 * (r.X_EC.p - X_EC.p).norm();
  const double off_deg = model::RotationVector(X_EC.R.transpose() * r.X_EC.R).norm() * 57.29578;
  std::cout << "off " << off_mm << " mm, " << off_deg << " deg; the views agree to " << r.rms_mm << " mm, "
            << r.rms_deg << " deg\n";
  EXPECT_LT(off_mm, 0.15);
  EXPECT_LT(off_deg, 0.03);

  for (HandView& view : views) {
    view.X_BE.R = model::RotationOf(Vec3(0.0, 0.0, 0.1 * static_cast<double>(&view - views.data())));
  }
  EXPECT_THROW(SolveHandEye(views, kBoard, in), CalibrationError) << "all rotations are about one axis";
}

TEST(CalibrationTest, FocalLengthIsFoundFromTwoOrMoreDistances) {
  // The closed-form result of two views.
  const FocalLength two = SolveFocalLength({{60.0, 0.01, 0.0}, {40.0, 0.01, 0.15}}, 0.08, false);
  EXPECT_NEAR(two.f_px, 2.0 * 0.15 * 60.0 * 40.0 / (0.08 * 20.0), 1e-9);
  EXPECT_THROW(SolveFocalLength({{40.0, 0.01, 0.0}, {60.0, 0.01, 0.15}}, 0.08, false), CalibrationError);
  EXPECT_THROW(SolveFocalLength({{40.0, 0.01, 0.0}}, 0.08, false), CalibrationError);
  for (const double middle_px : {60.0, 61.0, 40.0, 39.0}) {
    try {
      (void)SolveFocalLength({{60.0, 0.01, 0.0}, {40.0, 0.01, 0.15}, {middle_px, 0.01, 0.07}}, 0.08, false);
      ADD_FAILURE() << middle_px << " px between 60 and 40 px is accepted";
    } catch (const CalibrationError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("smaller in each farther view")) << middle_px;
    }
  }
  EXPECT_NO_THROW(SolveFocalLength({{60.0, 0.01, 0.0}, {40.0, 0.01, 0.15}, {50.0, 0.01, 0.07}}, 0.08, false));

  // Radii from pictures of a disc; the detector has only a rough focal length.
  bench::PictureScene scene;
  scene.noise = 3.0;
  bench::Body disc;
  disc.shape = bench::Shape::kDisc;
  scene.bodies.push_back(disc);
  vision::DetectorConfig config;
  config.kind = hal::FeatureKind::kCircle;
  config.by = vision::FindBy::kGray;
  config.intrinsics = {640, 480, 500.0, 500.0, 319.5, 239.5};
  std::vector<RadiusView> views;
  for (int i = 0; i < 4; ++i) {
    scene.bodies[0].p.z() = 0.30 + 0.1 * i;
    scene.seed = static_cast<unsigned>(i + 1);
    vision::TargetDetector detector(config);
    const vision::Detection d = detector.Detect(bench::Draw(scene));
    ASSERT_TRUE(d.found);
    views.push_back({d.radius_px, std::sqrt(d.cov_uvr_px2(2, 2)), 0.1 * i});
  }
  const FocalLength many = SolveFocalLength(views, 0.08, false);
  std::cout << "f " << many.f_px << " +- " << many.sigma_px << " px of " << scene.camera.f_px << ", Z "
            << many.Z << "\n";
  EXPECT_NEAR(many.f_px, scene.camera.f_px, 4.0 * many.sigma_px);
  EXPECT_LT(many.sigma_px, 0.4);
  EXPECT_NEAR(many.Z, 0.30, 3e-4);
}

}  // namespace
}  // namespace fovea::calibration
