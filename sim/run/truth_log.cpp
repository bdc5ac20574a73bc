// SPDX-License-Identifier: Apache-2.0
#include "sim/run/truth_log.hpp"

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/film/target_curve.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "sim/run/log_scene.hpp"
#include "sim/verdict/target_error.hpp"

namespace fovea::sim {

run::RunFacts FactsOf(const RunDescription& about) {
  run::RunFacts facts;
  facts.name = about.scenario.name;
  facts.robot = about.robot.name;
  facts.joint_names = about.robot.joint_names;
  facts.servo = about.servo;
  facts.has_camera = about.scene.has_eye;
  facts.intrinsics = about.intrinsics;
  facts.target_radius = about.scene.has_eye ? about.scene.target.Reach() : 0.0;
  facts.target_moves = KeepsMoving(about.scenario.target);
  facts.duration_s = about.scenario.run.duration_s;
  Scenario scenario = about.scenario;
  facts.keys = ScenarioKeys(scenario).Values();
  for (const TrueValue& value : about.truth) {
    facts.keys[std::string("truth.") + InfoOf(value.quantity).key + " (drawn)"] =
        config::ToText(value.actual);
  }
  Scenario defaults;
  facts.default_keys = ScenarioKeys(defaults).Values();
  facts.frames = MakeLinkFrames(about.scene.robot, about.servo.arm, about.scene.X_EC);
  facts.scene = MakeSceneMessage(about.scene);
  return facts;
}

log::TruthSample TruthSampleOf(const RunDescription& about, const Truth& truth) {
  const TargetError error = ErrorOf(truth, JudgedEyeOf(about), GoalOf(about.servo.feature));
  log::TruthSample sample;
  sample.stamp_ns = truth.stamp_ns;
  Eigen::Map<Eigen::Vector3d>(sample.p_BO.data()) = truth.p_BO;
  Eigen::Map<Eigen::Vector3d>(sample.p_BC.data()) = truth.X_BC.translation();
  sample.error_px = error.error_px;
  sample.error_mm = 1e3 * error.error_C.norm();
  sample.q_BO = model::QuaternionOf(truth.R_BO);
  return sample;
}

void LogTruth(const RunDescription& about, const Truth& truth, log::RunLog& log) {
  if (about.scene.has_eye) {  // otherwise there is no target
    log.AddTruth(TruthSampleOf(about, truth));
  }
}

void LogTheory(const TheorySample& sample, log::RunLog& log) {
  log::Theory message;
  message.set_stamp_ns(sample.stamp_ns);
  message.set_x(sample.x);
  message.set_x_goal(sample.x_goal);
  message.set_x_analytic(sample.x_analytic);
  log.Add(log::kTheoryTopic, sample.stamp_ns, message);
}

foxglove::ImageAnnotations TruthOnPicture(const RunDescription& about, const model::Pose& X_CO) {
  foxglove::ImageAnnotations annotations;
  const Pinhole& pinhole = about.eye.pinhole;
  const Lens& lens = about.eye.lens;
  vision::Intrinsics intrinsics{pinhole.width_px, pinhole.height_px, pinhole.f_px,
                                pinhole.FocalV(), pinhole.c_u_px,    pinhole.c_v_px};
  intrinsics.lens = {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3};
  const features::TargetFeature target = config::MakeTarget(about.bench.target);
  log::AddOutline(intrinsics, film::TargetCurve(intrinsics, target, X_CO), log::kTruthRole, annotations);
  return annotations;
}

}  // namespace fovea::sim
