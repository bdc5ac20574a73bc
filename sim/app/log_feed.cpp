#include "sim/app/log_feed.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "fovea/build_info.hpp"
#include "fovea/features/sphere.hpp"
#include "fovea/log/picture_messages.hpp"
#include "fovea/log/record_hash.hpp"
#include "fovea/log/topics.hpp"
#include "fovea/run.pb.h"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"
#include "sim/app/log_scene.hpp"
#include "sim/app/target_error.hpp"

namespace fovea::sim {
namespace {

log::RunLogConfig MakeRunLogConfig(const LogFeedConfig& config) {
  log::RunLogConfig out;
  out.path = config.path;
  out.library = fmt::format("fovea {}", kVersion);
  out.arm = config.servo.arm;
  out.frames = MakeLinkFrames(config.scene.robot, config.servo.arm, config.scene.X_EC);
  out.may_drop = config.may_drop;
  return out;
}

log::Setup MakeSetup(const LogFeedConfig& config) {
  log::Setup setup;
  setup.set_name(config.scenario.name);
  const model::ArmModel& arm = config.servo.arm;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    log::Joint& joint = *setup.add_joints();
    joint.set_name(config.robot.joint_names[k]);
    joint.set_prismatic(arm.joints[k].type == model::JointType::kPrismatic);
    joint.set_q_min(arm.joints[k].q_min);
    joint.set_q_max(arm.joints[k].q_max);
    joint.set_dq_max(arm.joints[k].dq_max);
    joint.set_tau_max(arm.joints[k].tau_max);
  }
  setup.set_lambda(config.servo.law.lambda);
  setup.set_target_radius(config.scene.target_radius);
  setup.set_target_moves(config.scenario.target.motion != "still");
  const model::Vec3& goal = config.servo.feature.p_CO_C_star;
  setup.mutable_p_co_c_star()->Add(goal.data(), goal.data() + 3);
  setup.set_workspace_radius(config.servo.guard.workspace_radius);
  setup.set_duration_s(config.scenario.run.duration_s);
  setup.set_f_px(config.pinhole.f_px);
  setup.set_c_u_px(config.pinhole.c_u_px);
  setup.set_c_v_px(config.pinhole.c_v_px);
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

LogFeed::LogFeed(const LogFeedConfig& config) : config_(config), log_(MakeRunLogConfig(config)) {
  log_.AddMetadata("configuration", Configuration(config.scenario));
  log_.AddMetadata("build", {{"version", kVersion},
                             {"git", kGitRevision},
                             {"servo library", kServoLibraryHash},
                             {"compiler", kCompiler},
                             {"flags", kFlags}});
  log_.AddMetadata("robot", {{"name", config.robot.name}, {"model", log::HashOfModel(config.servo.arm)}});
  log_.Add(log::kSetupTopic, 0, MakeSetup(config));
  log_.Add(log::kCalibrationTopic, 0, log::CalibrationMessage(0, config.intrinsics));
  log_.Add(log::kSceneTopic, 0, MakeSceneMessage(config.scene));
}

void LogFeed::AddTruth(const Truth& truth) {
  const TargetError error = ErrorOf(truth, config_.pinhole, config_.servo.feature.p_CO_C_star);
  log::TruthSample sample;
  sample.stamp_ns = truth.stamp_ns;
  Eigen::Map<Eigen::Vector3d>(sample.p_BO.data()) = truth.p_BO;
  Eigen::Map<Eigen::Vector3d>(sample.p_BC.data()) = truth.X_BC.translation();
  sample.error_px = error.error_px;
  sample.error_mm = 1e3 * error.error_C.norm();
  log_.AddTruth(sample);
}

void LogFeed::AddFrame(const hal::Frame& frame, const vision::BallDetection& detection,
                       const Eigen::Vector3d& p_CO_C) {
  foxglove::ImageAnnotations annotations;
  const double radius = config_.scene.target_radius;
  log::AddOutline(config_.intrinsics, features::ConeFromSphere(config_.servo.feature.p_CO_C_star / radius),
                  log::kGoalRole, annotations);
  if (p_CO_C.z() > 1.1 * radius) {
    log::AddOutline(config_.intrinsics, features::ConeFromSphere(p_CO_C / radius), log::kTruthRole,
                    annotations);
  }
  log::AddDetection(config_.intrinsics, detection, annotations);
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
  log_.Add(log::kTickTimesTopic, static_cast<std::int64_t>(config_.scenario.run.duration_s * 1e9), times);
  log_.AddAttachment("summary.json", "application/json", summary_json);
  if (film) {
    std::ifstream stream(*film, std::ios::binary);
    log_.AddAttachment("camera.mp4", "video/mp4", {std::istreambuf_iterator<char>(stream), {}});
  }
  log_.Finish();
}

}  // namespace fovea::sim
