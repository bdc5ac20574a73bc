#include "sim/run/log_feed.hpp"

#include <fmt/format.h>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/build_info.hpp"
#include "firmware/host/film/target_curve.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/record_hash.hpp"
#include "firmware/host/recording/log/run_messages.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"
#include "sim/run/log_scene.hpp"
#include "sim/verdict/target_error.hpp"

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

log::RunSetup MakeSetup(const RunDescription& about) {
  log::RunSetup setup;
  setup.name = about.scenario.name;
  setup.joint_names = about.robot.joint_names;
  setup.arm = about.servo.arm;
  setup.feature = about.servo.feature;
  setup.intrinsics = about.intrinsics;
  setup.lambda = about.servo.law.lambda;
  setup.target_radius = about.scene.has_eye ? about.scene.target.Reach() : 0.0;
  setup.target_moves = KeepsMoving(about.scenario.target);
  setup.workspace_radius = about.servo.guard.workspace_radius;
  setup.duration_s = about.scenario.run.duration_s;
  return setup;
}

}  // namespace

LogFeed::LogFeed(const RunDescription& about, const std::filesystem::path& path, bool may_drop,
                 bool replayable)
    : about_(about), path_(path), log_(MakeRunLogConfig(about, path, may_drop)) {
  if (about.scene.has_eye) {
    log::AddOutline(about.intrinsics, film::GoalCurve(about.intrinsics, about.servo.feature), log::kGoalRole,
                    goal_);
  }
  Scenario scenario = about.scenario;
  log_.AddMetadata("configuration", ScenarioKeys(scenario).Values());
  log_.AddMetadata("build", BuildEntries());
  log_.AddMetadata("robot", {{"name", about.robot.name}, {"model", log::HashOfModel(about.servo.arm)}});
  log_.Add(log::kSetupTopic, 0, log::SetupMessage(MakeSetup(about)));
  if (replayable) {
    log_.Add(log::kConfigurationTopic, 0, flight::ToMessage(about.servo));
  }
  log_.Add(log::kCalibrationTopic, 0, log::CalibrationMessage(0, about.intrinsics));
  log_.Add(log::kSceneTopic, 0, MakeSceneMessage(about.scene));
}

void LogFeed::AddRecord(const flight::FlightRecord& record) {
  log_.AddTick(record.record, flight::ReplayDataOf(record));
}

void LogFeed::AddKeyframe(const flight::Keyframe& keyframe) {
  log_.Add(log::kKeyframeTopic, keyframe.state.now_ns, flight::ToMessage(keyframe));
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
  log::AddOutline(about_.intrinsics, film::TargetCurve(about_.intrinsics, about_.servo.feature, X_CO),
                  log::kTruthRole, annotations);
  log::AddDetection(about_.intrinsics, detection, annotations);
  log_.Add(log::kAnnotationTopic, frame.stamp_ns, annotations);
  log_.AddImage(frame);
}

void LogFeed::Finish(const linux_rt::DurationHistogram& ticks, const std::string& summary_json) {
  log_.Add(log::kTickTimesTopic, static_cast<std::int64_t>(about_.scenario.run.duration_s * 1e9),
           log::TickTimesMessage(ticks));
  log_.AddAttachment("summary.json", "application/json", summary_json);
  log_.Finish();
}

}  // namespace fovea::sim
