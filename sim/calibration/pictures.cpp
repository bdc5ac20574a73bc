// SPDX-License-Identifier: Apache-2.0
#include "sim/calibration/pictures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <random>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/config/folder_lock.hpp"
#include "firmware/host/config/input_error.hpp"
#include "sim/calibration/board_plane.hpp"
#include "sim/calibration/place_hand.hpp"
#include "sim/camera/optics.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;

const Eigen::Vector3d kMiddle(0.50, 0.0, 0.0);  // centre of boards and discs, in B [m]
constexpr double kNearestPx = 6.0;              // least distance of the board's corners to the picture's edge

// A view of the camera [rad]: rotated by `tilt` about the horizontal axis at `azimuth`, and by `roll` about
// the optical axis. The board's centre appears at `xy` of the normalised image.
struct Look {
  double tilt = 0.0;
  double azimuth = 0.0;
  double roll = 0.0;
  Eigen::Vector2d xy = Eigen::Vector2d::Zero();
};

// View `i`. The views tilt by up to 43 degrees to all sides and spread the board over the whole picture.
Look LookOf(int i, const Pinhole& pinhole) {
  constexpr double kGoldenDeg = 137.508;
  Look look;
  look.tilt = i == 0 ? 0.0 : kRadPerDeg * (16.0 + 9.0 * (i % 4));
  look.azimuth = kRadPerDeg * kGoldenDeg * i;
  look.roll = kRadPerDeg * (37 * i % 81 - 40);
  const double aside = i == 0 ? 0.0 : i % 3 == 0 ? 0.28 : 0.12;  // every third view reaches into a corner
  const int quarter = i + i / 3;                                 // such views cycle through all corners
  const double around = kRadPerDeg * (90.0 * quarter + 45.0);
  look.xy = aside / pinhole.f_px *
            Eigen::Vector2d(pinhole.width_px * std::cos(around), pinhole.height_px * std::sin(around));
  return look;
}

class Photographer {
 public:
  explicit Photographer(const Scenario& scenario)
      : about_(DescribeRun(scenario)),
        sensor_(MakeScenarioSensor(scenario), SeedOf(scenario, RandomStream::kSensor)),
        encoders_(SeedOf(scenario, RandomStream::kEncoders)),
        chain_(about_.scene.robot),
        arm_(about_.scene.robot, {}),
        q_start_(
            Eigen::Map<const Eigen::VectorXd>(scenario.arm.q_start.data(), about_.servo.arm.num_joints)) {
    exposure_.p_BO = Eigen::Vector3d(0.0, 0.0, -10.0);  // out of sight
  }

  const RunDescription& about() const { return about_; }

  // R_BC of a camera that looks straight down, with the yaw of the start posture: the hand turns little.
  Eigen::Matrix3d Down() const {
    const Eigen::Matrix3d R = (chain_.TipPose(q_start_) * about_.scene.X_EC).linear();
    const double yaw = std::atan2(R(1, 0), R(0, 0));
    Eigen::Matrix3d down;
    down.col(0) = Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
    down.col(2) = -Eigen::Vector3d::UnitZ();
    down.col(1) = down.col(2).cross(down.col(0));
    return down;
  }

  // False if the arm cannot reach the pose.
  bool PlaceCamera(const Eigen::Isometry3d& X_BC) {
    const std::optional<Eigen::VectorXd> q =
        PlaceHand(chain_, about_.servo.arm, q_start_, X_BC * about_.scene.X_EC.inverse());
    if (q) {
      q_ = *q;
      arm_.SetState(q_, Eigen::VectorXd::Zero(q_.size()));
      exposure_.X_BL.clear();
      for (std::size_t i = 0; i < about_.scene.robot.links.size(); ++i) {
        exposure_.X_BL.push_back(arm_.LinkPose(static_cast<int>(i)));
      }
      exposure_.X_BC = exposure_.X_BL[static_cast<std::size_t>(about_.scene.robot.tip)] * about_.scene.X_EC;
    }
    return q.has_value();
  }

  void PlaceTarget(const Eigen::Isometry3d& X_BO) {
    exposure_.p_BO = X_BO.translation();
    exposure_.R_BO = X_BO.linear();
  }

  void Take(Optics& optics, const fs::path& path) {
    const Pinhole& p = about_.eye.pinhole;
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(p.width_px) *
                                   static_cast<std::size_t>(p.height_px) * 4);
    optics.Draw(exposure_, rgba);
    cv::Mat bgr(p.height_px, p.width_px, CV_8UC3);
    sensor_.Expose(rgba, p.width_px, exposure_.sequence++, {bgr.data, bgr.total() * 3});
    if (!cv::imwrite(path.string(), bgr)) {
      throw config::InputError(path.string() + ": cannot be written");
    }
  }

  // The hand's pose by the noisy encoders and the servo's model.
  model::Pose HandByEncoders() {
    std::normal_distribution<double> noise(0.0, std::max(about_.scenario.arm.encoder_noise, 1e-15));
    model::VecN q = q_;
    const Eigen::VectorXd& zero = about_.robot_truth.encoder_zero;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      q[i] += noise(encoders_) + (zero.size() > 0 ? zero[i] : 0.0);
    }
    model::ArmPoses poses;
    model::ComputePoses(about_.servo.arm, q, poses);
    return poses.X_BE;
  }

 private:
  const RunDescription about_;
  const Sensor sensor_;
  std::mt19937_64 encoders_;
  const Chain chain_;
  BulletArm arm_;
  const Eigen::VectorXd q_start_;
  Eigen::VectorXd q_;
  Exposure exposure_;
};

// The nearest X_BC with the look's orientation from which the whole board is inside the picture.
Eigen::Isometry3d ViewOf(const Look& look, const Eigen::Matrix3d& R_down, const BoardPlane& board,
                         const Pinhole& pinhole, const Lens& lens) {
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis(std::cos(look.azimuth), std::sin(look.azimuth), 0.0);
  X_BC.linear() = Eigen::AngleAxisd(look.tilt, axis).toRotationMatrix() * R_down *
                  Eigen::AngleAxisd(look.roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d ray(look.xy.x(), look.xy.y(), 1.0);
  for (double depth = 0.12;; depth *= 1.03) {
    X_BC.translation() = board.middle_B - depth * (X_BC.linear() * ray);
    bool inside = depth > 0.0;
    for (const Eigen::Vector3d& corner : board.outline_B) {
      const Eigen::Vector3d p = X_BC.inverse() * corner;
      if (!(p.z() > 0.0)) {
        inside = false;
        break;
      }
      const Eigen::Vector2d xy = Distort(lens, p.head<2>() / p.z());
      const double u = pinhole.f_px * xy.x() + pinhole.c_u_px;
      const double v = pinhole.FocalV() * xy.y() + pinhole.c_v_px;
      inside = inside && u > kNearestPx && u < pinhole.width_px - 1 - kNearestPx && v > kNearestPx &&
               v < pinhole.height_px - 1 - kNearestPx;
    }
    if (inside || depth > 2.0) {
      return X_BC;
    }
  }
}

void WriteTruth(const RunDescription& about, const calibration::Board& board, const fs::path& path) {
  const Eigen::Isometry3d& X_EC = about.scene.X_EC;
  const Eigen::Quaterniond q(X_EC.linear());
  const Lens& lens = about.eye.lens;
  std::ofstream stream(path, std::ios::trunc);
  stream << nlohmann::ordered_json{{"width_px", about.eye.pinhole.width_px},
                                   {"height_px", about.eye.pinhole.height_px},
                                   {"f_u_px", about.eye.pinhole.f_px},
                                   {"f_v_px", about.eye.pinhole.FocalV()},
                                   {"c_u_px", about.eye.pinhole.c_u_px},
                                   {"c_v_px", about.eye.pinhole.c_v_px},
                                   {"lens", {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}},
                                   {"X_EC",
                                    {X_EC.translation().x(), X_EC.translation().y(), X_EC.translation().z(),
                                     q.w(), q.x(), q.y(), q.z()}},
                                   {"board",
                                    {{"columns", board.columns},
                                     {"rows", board.rows},
                                     {"square", board.square}}}}
                .dump(2)
         << "\n";
  stream.close();
  if (!stream) {
    throw config::InputError(path.string() + ": cannot be written");
  }
}

}  // namespace

CalibrationPictures TakeCalibrationPictures(const Scenario& scenario,
                                            const CalibrationPicturesOptions& options) {
  if (!scenario.camera.enabled) {
    throw config::InputError("camera.enabled = false is not allowed: there is no camera to calibrate");
  }
  const BoardPlane board = MakeBoardPlane(options.board, kMiddle);
  Photographer photographer(scenario);
  const RunDescription& about = photographer.about();
  const Pinhole& pinhole = about.eye.pinhole;
  const Lens& lens = about.eye.lens;
  std::error_code error;
  fs::create_directories(options.out / "focal", error);
  if (error) {
    throw config::InputError(options.out.string() + ": the folder cannot be made: " + error.message());
  }
  const config::FolderLock lock(options.out);

  CalibrationPictures taken;
  std::ofstream poses(options.out / "poses.csv", std::ios::trunc);
  poses << "# file, pose of the hand in B: x,y,z [m],qw,qx,qy,qz\n";
  const Eigen::Matrix3d R_down = photographer.Down();
  {
    RenderScene scene = about.scene;
    auto bench = std::make_shared<Bench>(*scene.bench);
    bench->planes.insert(bench->planes.begin(), board.plane);
    scene.bench = std::move(bench);
    Optics optics(scene, pinhole, lens, Sampling::kFine);
    const int most = 4 * options.views;  // views to try
    for (int i = 0; i < most && static_cast<int>(taken.boards.size()) < options.views; ++i) {
      if (!photographer.PlaceCamera(ViewOf(LookOf(i, pinhole), R_down, board, pinhole, lens))) {
        continue;
      }
      const std::string name = fmt::format("view-{:02}.png", taken.boards.size() + 1);
      photographer.Take(optics, options.out / name);
      const model::Pose X_BE = photographer.HandByEncoders();
      const Eigen::Quaterniond q(X_BE.R);
      poses << fmt::format("{},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}\n", name, X_BE.p.x(),
                           X_BE.p.y(), X_BE.p.z(), q.w(), q.x(), q.y(), q.z());
      taken.boards.push_back(name);
    }
  }
  poses.close();
  if (!poses) {
    throw config::InputError((options.out / "poses.csv").string() + ": cannot be written");
  }
  if (static_cast<int>(taken.boards.size()) < options.views) {
    throw config::InputError(fmt::format("--views {} is not allowed: the arm can reach only {} views",
                                         options.views, taken.boards.size()));
  }

  RenderScene scene = about.scene;
  scene.target = {TargetShape::Kind::kDisc, 0.5 * taken.disc_diameter, {}};
  Optics optics(scene, pinhole, lens, Sampling::kFine);
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  X_BO.linear() = R_down;
  X_BO.translation() = kMiddle + Eigen::Vector3d(0.0, 0.0, 0.01);
  photographer.PlaceTarget(X_BO);
  constexpr double kNearZ = 0.30;
  for (const auto& [name, depth] :
       {std::pair{"focal/near.png", kNearZ}, std::pair{"focal/far.png", kNearZ + taken.disc_delta_z}}) {
    Eigen::Isometry3d X_BC = X_BO;
    X_BC.translation().z() += depth;
    if (!photographer.PlaceCamera(X_BC)) {
      throw config::InputError("the arm cannot reach the views of the disc; try another arm.q_start");
    }
    photographer.Take(optics, options.out / name);
    taken.discs.emplace_back(name);
  }
  WriteTruth(about, options.board, options.out / "truth.json");
  return taken;
}

}  // namespace fovea::sim
