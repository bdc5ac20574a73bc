#include "sim/app/log_feed.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "fovea/build_info.hpp"
#include "fovea/log/picture_messages.hpp"
#include "fovea/log/record_hash.hpp"
#include "fovea/log/topics.hpp"
#include "fovea/model/rotation.hpp"
#include "fovea/run.pb.h"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"
#include "sim/app/log_scene.hpp"
#include "sim/app/target_curve.hpp"
#include "sim/app/target_error.hpp"

namespace fovea::sim {
namespace {

log::RunLogConfig MakeRunLogConfig(const RunDescription& about, const std::filesystem::path& path,
                                   bool may_drop) {
  log::RunLogConfig out;
  out.path = path;
  out.library = fmt::format("fovea {}", kVersion);
  out.arm = about.servo.arm;
  out.frames = MakeLinkFrames(about.scene.robot, about.servo.arm, about.scene.X_EC);
  out.may_drop = may_drop;
  return out;
}

log::Setup MakeSetup(const RunDescription& about) {
  log::Setup setup;
  setup.set_name(about.scenario.name);
  const model::ArmModel& arm = about.servo.arm;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    log::Joint& joint = *setup.add_joints();
    joint.set_name(about.robot.joint_names[k]);
    joint.set_prismatic(arm.joints[k].type == model::JointType::kPrismatic);
    joint.set_q_min(arm.joints[k].q_min);
    joint.set_q_max(arm.joints[k].q_max);
    joint.set_dq_max(arm.joints[k].dq_max);
    joint.set_tau_max(arm.joints[k].tau_max);
  }
  setup.set_lambda(about.servo.law.lambda);
  if (about.scene.has_eye) {
    setup.set_target_radius(about.scene.target.Reach());
  }
  const features::TargetFeature& feature = about.servo.feature;
  setup.set_target(features::kTargetNames[static_cast<std::size_t>(feature.target)]);
  setup.set_feature(features::kFormNames[static_cast<std::size_t>(feature.form)]);
  for (int i = 0; feature.SeesOrientation() && i < feature.corners.num_corners; ++i) {
    setup.add_corners(feature.corners.corners[static_cast<std::size_t>(i)].x());
    setup.add_corners(feature.corners.corners[static_cast<std::size_t>(i)].y());
  }
  const std::array<double, 4> q_CO_star = model::QuaternionOf(feature.R_CO_star);
  setup.mutable_q_co_star()->Add(q_CO_star.begin(), q_CO_star.end());
  setup.set_target_moves(KeepsMoving(about.scenario.target));
  const model::Vec3& goal = feature.p_CO_C_star;
  setup.mutable_p_co_c_star()->Add(goal.data(), goal.data() + 3);
  setup.set_workspace_radius(about.servo.guard.workspace_radius);
  setup.set_duration_s(about.scenario.run.duration_s);
  setup.set_f_px(about.pinhole.f_px);
  setup.set_c_u_px(about.pinhole.c_u_px);
  setup.set_c_v_px(about.pinhole.c_v_px);
  for (int i = 0; i < hal::kNumLimits; ++i) {
    setup.add_limits(hal::Name(static_cast<hal::Limit>(i)));
  }
  return setup;
}

// Every key of the scenario as it was in force.
std::map<std::string, std::string> Configuration(Scenario scenario) {
  std::map<std::string, std::string> entries;
  const config::KeyTable table = ScenarioKeys(scenario);
  for (const config::Key& key : table.keys()) {
    entries[key.name] = key.default_text;
  }
  return entries;
}

}  // namespace

LogFeed::LogFeed(const RunDescription& about, const std::filesystem::path& path, bool may_drop)
    : about_(about), path_(path), log_(MakeRunLogConfig(about, path, may_drop)) {
  if (about.scene.has_eye) {
    log::AddOutline(about.intrinsics, GoalCurve(about.intrinsics, about.servo.feature), log::kGoalRole,
                    goal_);
  }
  log_.AddMetadata("configuration", Configuration(about.scenario));
  log_.AddMetadata("build", {{"version", kVersion},
                             {"git", kGitRevision},
                             {"servo library", kServoLibraryHash},
                             {"compiler", kCompiler},
                             {"flags", kFlags}});
  log_.AddMetadata("robot", {{"name", about.robot.name}, {"model", log::HashOfModel(about.servo.arm)}});
  log_.Add(log::kSetupTopic, 0, MakeSetup(about));
  log_.Add(log::kCalibrationTopic, 0, log::CalibrationMessage(0, about.intrinsics));
  log_.Add(log::kSceneTopic, 0, MakeSceneMessage(about.scene));
}

void LogFeed::AddTheory(const TheorySample& sample) {
  log::Theory message;
  message.set_stamp_ns(sample.stamp_ns);
  message.set_x(sample.x);
  message.set_x_goal(sample.x_goal);
  message.set_x_analytic(sample.x_analytic);
  log_.Add(log::kTheoryTopic, sample.stamp_ns, message);
}

void LogFeed::AddTruth(const Truth& truth) {
  if (!about_.scene.has_eye) {
    return;  // there is no target
  }
  const TargetError error = ErrorOf(truth, about_.pinhole, GoalOf(about_.servo.feature));
  log::TruthSample sample;
  sample.stamp_ns = truth.stamp_ns;
  Eigen::Map<Eigen::Vector3d>(sample.p_BO.data()) = truth.p_BO;
  Eigen::Map<Eigen::Vector3d>(sample.p_BC.data()) = truth.X_BC.translation();
  sample.error_px = error.error_px;
  sample.error_mm = 1e3 * error.error_C.norm();
  sample.q_BO = model::QuaternionOf(truth.R_BO);
  log_.AddTruth(sample);
}

void LogFeed::AddFrame(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO) {
  foxglove::ImageAnnotations annotations = goal_;
  log::AddOutline(about_.intrinsics, TargetCurve(about_.intrinsics, about_.servo.feature, X_CO),
                  log::kTruthRole, annotations);
  log::AddDetection(about_.intrinsics, detection, annotations);
  log_.Add(log::kAnnotationTopic, frame.stamp_ns, annotations);
  log_.AddImage(frame);
}

void LogFeed::Finish(const linux_rt::DurationHistogram& ticks, const std::string& summary_json,
                     const std::optional<std::filesystem::path>& film) {
  log::TickTimes times;
  ticks.ForEach([&times](std::int64_t upper_ns, std::uint64_t count) {
    times.add_upper_ns(static_cast<std::uint64_t>(upper_ns));
    times.add_counts(count);
  });
  log_.Add(log::kTickTimesTopic, static_cast<std::int64_t>(about_.scenario.run.duration_s * 1e9), times);
  log_.AddAttachment("summary.json", "application/json", summary_json);
  if (film) {
    std::ifstream stream(*film, std::ios::binary);
    log_.AddAttachment("camera.mp4", "video/mp4", {std::istreambuf_iterator<char>(stream), {}});
  }
  log_.Finish();
}

}  // namespace fovea::sim
