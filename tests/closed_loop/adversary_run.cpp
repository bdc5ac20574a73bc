// SPDX-License-Identifier: Apache-2.0
#include "tests/closed_loop/adversary_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "firmware/core/barriers/solid_barriers.hpp"
#include "fovea/hal/types.hpp"
#include "tests/closed_loop/guard_bench.hpp"
#include "tests/support/adversary.hpp"

namespace fovea::test {
namespace {

constexpr double kTickS = hal::kTickPeriodS;
constexpr std::int64_t kLatencyNs = 40 * hal::kNsPerMs;
constexpr double kRounding = 1e-9;

class Run {
 public:
  explicit Run(std::uint64_t seed) : setup_(Setup(seed)), world_(setup_.world), adversary_(seed) {
    if (!task_.Init(setup_.servo).ok()) {
      throw std::logic_error("Init refuses the configuration");
    }
    world_.OnStep([this](const sim::Truth& truth) { Watch(truth); });
    world_.OnExposure([this](const sim::Exposure& exposure) {
      const Eigen::Vector3d ball(0.55, 0.1, 0.04);
      under_way_.emplace_back(
          exposure.stamp_ns + kLatencyNs,
          adversary_.See(exposure.X_BC, ball, setup_.servo.feature.radius, exposure.stamp_ns));
    });
  }

  void Tick() {
    task::ServoInputs inputs;
    inputs.arm = world_.MeasuredState();
    if (!under_way_.empty() && under_way_.front().first <= world_.now_ns()) {
      inputs.has_feature = true;
      inputs.feature = under_way_.front().second;
      under_way_.pop_front();
    }
    if (outputs_.record.mode == hal::Mode::kFault) {
      inputs.request = outputs_.command().engage_brakes ? task::Request::kReset : task::Request::kNone;
      asked_ = false;
    } else if (outputs_.record.mode == hal::Mode::kHold &&
               (!asked_ || outputs_.record.hold_reason == hal::HoldReason::kEyeDoubted)) {
      inputs.request = task::Request::kTrack;  // even if the servo doubts its measurements
      asked_ = true;
    }
    const hal::Fault before = outputs_.record.fault;
    task_.Step(inputs, outputs_);
    const hal::TickRecord& r = outputs_.record;
    if (r.fault != hal::Fault::kNone && r.fault != before) {
      ++figures_.faults[hal::Name(r.fault)];
      Note(fmt::format("fault {}", hal::Name(r.fault)));
    }
    if (r.has_feature) {
      ++figures_.intakes[hal::Name(r.intake)];
    }
    figures_.tracking_ticks += r.mode == hal::Mode::kTrack || r.mode == hal::Mode::kCoast ? 1 : 0;
    figures_.fastest_target = std::max(figures_.fastest_target, std::hypot(r.v_BO[0], r.v_BO[1], r.v_BO[2]));
    world_.Command(outputs_.command());
    world_.AdvanceTo(world_.now_ns() + hal::kTickPeriodNs);
  }

  AdversaryFigures& figures() { return figures_; }

 private:
  static GuardSetup Setup(std::uint64_t seed) {
    GuardSetup setup;
    setup.world.seed = seed;
    TellTheBench(setup.servo);
    return setup;
  }

  void Use(const char* limit, double share) {
    double& most = figures_.most[limit];
    most = std::max(most, std::fabs(share));
    if (std::fabs(share) > 1.0 + kRounding) {
      passed_ = true;
      Note(limit);
    }
  }

  void Note(const std::string& what) {
    if (figures_.first.empty()) {
      figures_.first =
          fmt::format("{} at {:.3f} s, trick {}", what, 1e-9 * static_cast<double>(world_.now_ns()),
                      static_cast<int>(adversary_.trick()));
    }
  }

  void Watch(const sim::Truth& truth) {
    passed_ = false;
    const model::ArmModel& arm = setup_.servo.arm;
    for (int i = 0; i < arm.num_joints; ++i) {
      const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
      Use("joint_position",
          (truth.q[i] - 0.5 * (joint.q_max + joint.q_min)) / (0.5 * (joint.q_max - joint.q_min)));
      Use("joint_velocity", truth.dq[i] / joint.dq_max);
      Use("torque", truth.tau_cmd[i] / joint.tau_max);
      if (tau_before_.size() > 0) {
        Use("torque_rate", (truth.tau_cmd[i] - tau_before_[i]) / (joint.dtau_max * kTickS));
      }
    }
    tau_before_ = truth.tau_cmd;
    const Eigen::Vector3d p = truth.X_BE.translation();
    Use("workspace", p.norm() / setup_.servo.guard.workspace_radius);
    if (p_before_.size() > 0) {
      Use("cartesian_speed", (p - p_before_).norm() / kTickS / setup_.servo.guard.cartesian_speed);
    }
    p_before_ = p;
    const Eigen::Matrix3d R = truth.X_BE.linear();
    Use("rotation_speed", Eigen::AngleAxisd(R_before_.value_or(R).transpose() * R).angle() / kTickS /
                              setup_.servo.guard.rotation_speed);
    R_before_ = R;
    model::ArmPoses poses;
    model::ComputePoses(arm, truth.q, poses);
    const double clearance = barriers::ClearanceOfArm(setup_.servo, poses);
    figures_.lowest_mm = std::min(figures_.lowest_mm, 1e3 * clearance);
    if (clearance < 0.0) {
      passed_ = true;
      Note("plane");
    }
    figures_.passed_ticks += passed_ ? 1 : 0;
    if (truth.contacts.Any()) {
      ++figures_.contact_ticks;
      Note(truth.contacts.bench > 0 ? "contact with the bench"
           : truth.contacts.self    ? "contact with itself"
                                    : "contact with the target");
    }
  }

  GuardSetup setup_;
  sim::World world_;
  task::ServoTask task_;
  task::ServoOutputs outputs_;
  Adversary adversary_;
  std::deque<std::pair<std::int64_t, hal::FeatureMeasurement>> under_way_;
  bool asked_ = false;
  bool passed_ = false;
  Eigen::VectorXd tau_before_;
  Eigen::VectorXd p_before_;
  std::optional<Eigen::Matrix3d> R_before_;
  AdversaryFigures figures_;
};

}  // namespace

AdversaryFigures RunAdversary(double duration_s, std::uint64_t seed,
                              const std::function<void(double share)>& on_progress) {
  Run run(seed);
  const auto ticks = static_cast<std::int64_t>(duration_s * 1e3);
  for (std::int64_t k = 0; k < ticks; ++k) {
    run.Tick();
    if (on_progress && k % 1000 == 0) {
      on_progress(static_cast<double>(k) / static_cast<double>(ticks));
    }
  }
  run.figures().hours = duration_s / 3600.0;
  return run.figures();
}

std::string InWords(const AdversaryFigures& f) {
  std::string text = fmt::format(
      "{:.3f} h of robot time, {:.1f} % of it tracking; {} ticks with contact, {} ticks beyond a limit; "
      "smallest clearance {:.1f} mm; fastest target fed forward {:.2f} m/s\nlargest share of each limit:",
      f.hours, 1e-3 * static_cast<double>(f.tracking_ticks) / (36.0 * f.hours), f.contact_ticks,
      f.passed_ticks, f.lowest_mm, f.fastest_target);
  for (const auto& [name, most] : f.most) {
    text += fmt::format(" {} {:.1f} %,", name, 100.0 * most);
  }
  text += "\nmeasurements:";
  for (const auto& [name, count] : f.intakes) {
    text += fmt::format(" {} {},", name, count);
  }
  for (const auto& [name, count] : f.faults) {
    text += fmt::format("\nfault {}: {} times", name, count);
  }
  return text + (f.first.empty() ? "" : "\nfirst event: " + f.first) + "\n";
}

}  // namespace fovea::test
