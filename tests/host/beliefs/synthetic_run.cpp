// SPDX-License-Identifier: Apache-2.0
#include "tests/host/beliefs/synthetic_run.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/host/beliefs/refocus.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::test {
namespace {

constexpr double kFocalPx = 554.0;
constexpr double kRateHz = 30.0;
constexpr double kFrictionWidth = 1e-3;  // below this speed the synthetic friction falls to 0 [rad/s]

model::Pose EyeAt(const config::ServoConfig& config, const model::VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses.X_BE * config.X_EC;
}

// What the camera reports of a target at `X_CO`, when it believes another focal length and size.
hal::FeatureMeasurement Misread(const config::ServoConfig& config, const SyntheticTruth& truth,
                                const model::Pose& X_CO, std::int64_t stamp_ns, TruthEye& eye) {
  if (config.feature.SeesOrientation()) {
    hal::FeatureMeasurement m =
        eye.See({X_CO.R, X_CO.p / (1.0 + truth.size)}, stamp_ns, static_cast<std::uint64_t>(stamp_ns));
    for (double& entry : m.s) {
      entry *= 1.0 + truth.focal;
    }
    return m;
  }
  hal::FeatureMeasurement m =
      eye.See({X_CO.R, X_CO.p / (1.0 + truth.size)}, stamp_ns, static_cast<std::uint64_t>(stamp_ns));
  model::Vec3 s;
  model::Vec3 ignored;
  if (beliefs::RefocusSphere({m.s[0], m.s[1], m.s[2]}, 1.0 / (1.0 + truth.focal) - 1.0, s, ignored)) {
    std::copy(s.data(), s.data() + 3, m.s.begin());
  }
  return m;
}

}  // namespace

JointsNow Waves::operator()(double t_s) const {
  JointsNow now{from, from, from};
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const double rate = multiple[i] * omega;
    now.q[i] = from[i] + amplitude[i] * std::sin(rate * t_s);
    now.dq[i] = amplitude[i] * rate * std::cos(rate * t_s);
    now.ddq[i] = -amplitude[i] * rate * rate * std::sin(rate * t_s);
  }
  return now;
}

Waves LookAround() {
  Waves waves{Ready(), Ready(), Ready(), 1.0};
  waves.from << 0.0, -0.5, 0.0, -2.1, 0.0, 1.6, 0.785;
  waves.amplitude << 0.12, 0.08, 0.12, 0.12, 0.16, 0.12, 0.32;
  waves.multiple << 2.0, 3.0, 3.0, 1.0, 2.0, 2.0, 1.0;
  return waves;
}

model::Vec3 BallPlace() {
  const model::Pose X_BC = EyeAt(PandaConfig(), LookAround().from);
  return X_BC * model::Vec3(0.0, 0.0, 0.40);
}

JointPath AlongALine(const config::ServoConfig& config, const model::Vec3& direction, double way,
                     double omega, double duration_s) {
  constexpr double kStepS = 1e-3;
  const model::Pose X_BC_start = EyeAt(config, LookAround().from);
  auto path = std::make_shared<std::vector<model::VecN>>();
  model::VecN q = LookAround().from;
  for (int k = 0; k < static_cast<int>(duration_s / kStepS) + 3; ++k) {
    model::Pose X_wanted = X_BC_start;
    X_wanted.p += way * std::sin(omega * kStepS * k) * direction;
    for (int i = 0; i < 3; ++i) {
      model::ArmPoses poses;
      model::ComputePoses(config.arm, q, poses);
      model::Mat6N J;
      model::ComputeJacobian(config.arm, poses, config.X_EC, J);
      const model::Pose off = (poses.X_BE * config.X_EC).Inverse() * X_wanted;
      model::Vec6 twist;
      twist << off.p, model::RotationVector(off.R);
      q += Eigen::MatrixXd(J).completeOrthogonalDecomposition().solve(twist);
    }
    path->push_back(q);
  }
  return [path](double t_s) {
    const auto k = static_cast<std::size_t>(std::lround(t_s / kStepS)) + 1;
    const std::vector<model::VecN>& p = *path;
    const std::size_t i = std::min(std::max<std::size_t>(k, 1), p.size() - 2);
    return JointsNow{p[i], (p[i + 1] - p[i - 1]) / (2.0 * kStepS),
                     (p[i + 1] - 2.0 * p[i] + p[i - 1]) / (kStepS * kStepS)};
  };
}

void MakeRun(const config::ServoConfig& config, const JointPath& path, const model::Pose& X_BO,
             const SyntheticTruth& truth, const SyntheticNoise& noise, double duration_s, unsigned seed,
             const std::function<void(const hal::TickRecord&)>& take) {
  const int n = config.arm.num_joints;
  model::ArmModel arm = config.arm;
  if (truth.load.mass > 0.0) {
    model::Attach(truth.load, arm);
  }
  for (Eigen::Index i = 0; i < truth.link_mass.size(); ++i) {
    model::LinkInertia& link = arm.links[static_cast<std::size_t>(i)];
    link.mass *= 1.0 + truth.link_mass[i];
    link.I_Com_Li *= 1.0 + truth.link_mass[i];
  }
  const model::Pose X_EC = config.X_EC * model::Pose{model::RotationOf(truth.turn), truth.shift};
  TruthEye eye(config.feature, kFocalPx, noise.sigma_px, seed);
  std::mt19937_64 engine(seed + 1);
  std::normal_distribution<double> normal;
  std::deque<hal::FeatureMeasurement> under_way;
  int frame = 0;
  for (int tick = 0; tick < static_cast<int>(duration_s * 1e3); ++tick) {
    const double t_s = 1e-3 * tick;
    const std::int64_t stamp_ns = tick * hal::kTickPeriodNs;
    const JointsNow now = path(t_s);
    model::ArmPoses poses;
    model::ComputePoses(arm, now.q, poses);
    model::VecN tau;
    model::InverseDynamics(arm, poses, now.dq, now.ddq, tau);
    model::ArmDynamics believed;
    model::ComputeDynamics(config.arm, poses, now.dq, believed);
    hal::TickRecord record;
    record.tick = static_cast<std::uint64_t>(tick);
    record.stamp_ns = stamp_ns;
    record.arm.stamp_ns = stamp_ns;
    record.arm.num_joints = n;
    record.mode = hal::Mode::kMove;
    record.target_known = true;
    record.p_BO = {X_BO.p.x(), X_BO.p.y(), X_BO.p.z()};
    record.q_BO = model::QuaternionOf(X_BO.R);
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      record.arm.q[k] = now.q[i] + noise.position * normal(engine);
      record.arm.dq[k] = now.dq[i] + noise.velocity * normal(engine);
      const double bias = truth.bias.size() > 0 ? truth.bias[i] : 0.0;
      record.arm.tau_meas[k] =
          tau[i] - arm.joints[k].rotor_inertia * now.ddq[i] + bias;  // on the links' side
      const double friction =
          truth.viscous * now.dq[i] + truth.coulomb * motion_laws::SmoothSign(now.dq[i], kFrictionWidth);
      record.arm.tau_applied[k] = tau[i] - believed.g[i] + friction;
    }
    if (t_s * kRateHz >= frame) {
      ++frame;
      const model::Pose X_CO = (poses.X_BE * X_EC).Inverse() * X_BO;
      under_way.push_back(Misread(config, truth, X_CO, stamp_ns + std::llround(1e9 * truth.late), eye));
    }
    if (!under_way.empty() && under_way.front().stamp_ns + 40'000'000 <= stamp_ns) {
      record.has_feature = true;
      record.intake = hal::Intake::kTaken;
      record.feature = under_way.front();
      under_way.pop_front();
    }
    take(record);
  }
}

}  // namespace fovea::test
