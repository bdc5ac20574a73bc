// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/true_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"
#include "sim/scenario/to_vector.hpp"

namespace fovea::sim {
namespace {

std::vector<double> PerJoint(const RunDescription& run, double value) {
  return std::vector<double>(static_cast<std::size_t>(run.robot.model.num_joints), value);
}

void DrawEye(TruthDraw& draw, RunDescription& run) {
  config::CalibrationSettings& eye = run.bench.camera.calibration;
  eye.mount_xyz = draw.Get(Quantity::kMountXyz, eye.mount_xyz);
  run.eye.X_EC = CameraMount(run.bench);
  const std::vector<double> turn = draw.Get(Quantity::kMountTurn, {0.0, 0.0, 0.0});
  const Eigen::Vector3d turn_C = kRadPerDeg * Eigen::Vector3d(turn[0], turn[1], turn[2]);
  if (const double angle = turn_C.norm(); angle > 0.0) {
    run.eye.X_EC.linear() *= Eigen::AngleAxisd(angle, turn_C / angle).toRotationMatrix();
  }
  const Pinhole& believed = run.pinhole;
  const double believed_aspect = believed.FocalV() / believed.f_px;
  const double f_px = draw.Get(Quantity::kFocalLength, {believed.f_px})[0];
  const double aspect = draw.Get(Quantity::kAspect, {believed_aspect})[0];
  const std::vector<double> c = draw.Get(
      Quantity::kPrincipalPoint, {believed.c_u_px, believed.c_v_px},
      {{0.0, static_cast<double>(believed.width_px)}, {0.0, static_cast<double>(believed.height_px)}});
  if (f_px != believed.f_px || aspect != believed_aspect ||
      c != std::vector{believed.c_u_px, believed.c_v_px}) {
    eye.intrinsics.f_u_px = f_px;
    eye.intrinsics.f_v_px =
        aspect == believed_aspect ? believed.FocalV() * (f_px / believed.f_px) : aspect * f_px;
    eye.intrinsics.c_u_px = c[0];
    eye.intrinsics.c_v_px = c[1];
  }
  eye.lens = draw.Get(Quantity::kLens, eye.lens);
  const double most_us = 1e6 / (run.scenario.camera.rate_hz * eye.intrinsics.height_px);
  eye.row_time_us = draw.Get(Quantity::kRowTime, {eye.row_time_us},
                             {{0.0, std::min(most_us, InfoOf(Quantity::kRowTime).high)}})[0];
  run.eye.pinhole = MakeScenarioPinhole(run.bench);
  run.eye.lens = MakeScenarioLens(run.bench);
  CheckLens(run.bench);
}

void DrawStamps(TruthDraw& draw, RunDescription& run) {
  constexpr double kNsPerMs = 1e6;
  constexpr double kMostSigmas = 3.0;  // of the jitter
  auto& camera = run.bench.camera;
  const double believed_ms = camera.latency_ms;
  const double jitter_ms = draw.Get(Quantity::kLatencyJitter, {0.0})[0];
  // No picture arrives before its exposure ends.
  const double ends_ms = 0.5 * (camera.exposure_ms + 1e-3 * camera.calibration.row_time_us *
                                                         camera.calibration.intrinsics.height_px);
  const Span allowed{ends_ms + kMostSigmas * jitter_ms, InfoOf(Quantity::kLatency).high};
  camera.latency_ms = draw.Get(Quantity::kLatency, {believed_ms}, {allowed})[0];
  if (camera.latency_ms < ends_ms) {
    throw config::InputError(
        fmt::format("camera.latency_ms = {:g} is not allowed: the last row of a picture is exposed until "
                    "{:g} ms after its "
                    "middle (truth.camera.row_time_us, camera.exposure_ms)",
                    camera.latency_ms, ends_ms));
  }
  if (camera.latency_ms < allowed.low) {
    throw config::InputError(fmt::format(
        "truth.camera.latency_jitter_ms = {:g} is not allowed: with a latency of {:g} ms and an "
        "exposure of {:g} ms at "
        "most {:g} ms",
        jitter_ms, camera.latency_ms, camera.exposure_ms, (camera.latency_ms - ends_ms) / kMostSigmas));
  }
  run.stamps.late_ns = static_cast<std::int64_t>((camera.latency_ms - believed_ms) * kNsPerMs);
  run.stamps.jitter_ns = jitter_ms * kNsPerMs;
  run.stamps.drift = 1e-6 * draw.Get(Quantity::kClockDrift, {0.0})[0];
  run.stamps.seed = SeedOf(run.scenario, RandomStream::kTruth);
}

// A larger target has its centre where the believed one has it; a larger ball has its lowest point there.
void DrawTarget(TruthDraw& draw, RunDescription& run) {
  TargetScene& target = run.bench.target;
  const double scale = draw.Get(Quantity::kTargetScale, {1.0})[0];
  run.target_scale = scale;
  if (target.kind == "sphere") {
    target.position[2] += 0.5 * (scale - 1.0) * target.diameter;
  }
  target.diameter *= scale;
  target.side *= scale;
  for (double& corner : target.triangle) {
    corner *= scale;
  }
}

// The moving link that carries link `index`: its degree of freedom, and its frame in that of the moving link;
// a degree of freedom of -1 for the base.
struct Carrier {
  int dof = -1;
  Eigen::Isometry3d X_ML = Eigen::Isometry3d::Identity();
};
Carrier CarrierOf(const SimRobot& robot, int index) {
  Carrier carrier;
  for (int i = index; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    const SimLink& link = robot.links[static_cast<std::size_t>(i)];
    if (link.dof >= 0) {
      carrier.dof = link.dof;
      return carrier;
    }
    carrier.X_ML = link.X_PL * carrier.X_ML;
  }
  return {};
}

void DrawLinks(TruthDraw& draw, const RunDescription& run, SimRobot& robot) {
  const auto joints = static_cast<std::size_t>(run.robot.model.num_joints);
  std::vector<double> masses(joints);
  std::vector<double> viscous(joints);
  std::vector<double> coulomb(joints);
  std::vector<double> rotors(joints);
  std::vector<Carrier> carriers;
  for (int i = 0; i < static_cast<int>(robot.links.size()); ++i) {
    const SimLink& link = robot.links[static_cast<std::size_t>(i)];
    carriers.push_back(CarrierOf(robot, i));
    if (carriers.back().dof >= 0) {
      masses.at(static_cast<std::size_t>(carriers.back().dof)) += link.mass;
    }
    if (link.dof >= 0) {
      viscous.at(static_cast<std::size_t>(link.dof)) = link.viscous;
      coulomb.at(static_cast<std::size_t>(link.dof)) = link.coulomb;
      rotors.at(static_cast<std::size_t>(link.dof)) = link.rotor_inertia;
    }
  }
  const std::vector<double> true_masses = draw.Get(Quantity::kLinkMasses, masses);
  const std::vector<double> shifts = draw.Get(Quantity::kLinkCentres, std::vector<double>(3 * joints, 0.0));
  viscous = draw.Get(Quantity::kViscousFriction, viscous);
  coulomb = draw.Get(Quantity::kCoulombFriction, coulomb);
  rotors = draw.Get(Quantity::kRotorInertias, rotors);
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    SimLink& link = robot.links[i];
    if (link.dof >= 0) {
      link.viscous = viscous.at(static_cast<std::size_t>(link.dof));
      link.coulomb = coulomb.at(static_cast<std::size_t>(link.dof));
      link.rotor_inertia = rotors.at(static_cast<std::size_t>(link.dof));
    }
    if (carriers[i].dof < 0) {
      continue;
    }
    const auto k = static_cast<std::size_t>(carriers[i].dof);
    if (true_masses[k] != masses[k]) {
      link.mass *= true_masses[k] / masses[k];
      link.I_Com *= true_masses[k] / masses[k];
    }
    const Eigen::Vector3d shift_M(shifts[3 * k], shifts[3 * k + 1], shifts[3 * k + 2]);
    link.X_LCom.translation() += carriers[i].X_ML.linear().transpose() * shift_M;
  }
}

void DrawDrives(TruthDraw& draw, RunDescription& run) {
  RobotTruth& truth = run.robot_truth;
  truth.encoder_zero = ToVectorX(draw.Get(Quantity::kEncoderZeros, PerJoint(run, 0.0)));
  truth.torque_scale = ToVectorX(draw.Get(Quantity::kTorqueScales, PerJoint(run, 1.0)));
  truth.torque_bias = ToVectorX(draw.Get(Quantity::kTorqueBiases, PerJoint(run, 0.0)));
  const std::vector<double> tilt = draw.Get(Quantity::kBaseTilt, {0.0, 0.0});
  truth.base_tilt = kRadPerDeg * Eigen::Vector2d(tilt[0], tilt[1]);
}

}  // namespace

SimRobot DrawTruth(const SimRobot& believed, RunDescription& run) {
  run.bench = run.scenario;
  TruthDraw draw(run.scenario.truth, SeedOf(run.scenario, RandomStream::kTruth));
  if (run.scenario.camera.enabled) {
    DrawEye(draw, run);
    DrawStamps(draw, run);
    DrawTarget(draw, run);
  } else {
    run.eye = {run.pinhole, run.lens, CameraMount(run.scenario)};
    for (const Quantity quantity :
         {Quantity::kMountXyz, Quantity::kMountTurn, Quantity::kFocalLength, Quantity::kAspect,
          Quantity::kPrincipalPoint, Quantity::kLens, Quantity::kLatency, Quantity::kLatencyJitter,
          Quantity::kClockDrift, Quantity::kTargetScale, Quantity::kRowTime}) {
      draw.Refuse(quantity, "camera.enabled = false");
    }
  }
  SimRobot robot = believed;
  DrawLinks(draw, run, robot);
  config::LoadSettings& load = run.bench.arm.load;
  const double believed_mass = load.mass;
  load.mass = draw.Get(Quantity::kLoadMass, {believed_mass})[0];
  for (double& entry : load.inertia) {
    entry *= believed_mass > 0.0 ? load.mass / believed_mass : 1.0;
  }
  if (load.mass > 0.0) {
    load.com = draw.Get(Quantity::kLoadCentre, load.com);
  } else {
    draw.Refuse(Quantity::kLoadCentre, "the hand carries no load");
  }
  DrawDrives(draw, run);
  AddLoad(config::MakeLoad(load), robot);
  run.truth = draw.differing();
  if (run.truth.empty()) {
    run.robot_truth = {};
  } else {
    run.robot_truth.believed = believed;
    AddLoad(config::MakeLoad(run.scenario.arm.load), *run.robot_truth.believed);
  }
  return robot;
}

}  // namespace fovea::sim
