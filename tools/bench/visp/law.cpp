// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/visp/law.hpp"

#include <visp3/visual_features/vpFeaturePoint.h>
#include <visp3/vs/vpServo.h>

namespace fovea::bench {
namespace {

using Features = std::array<vpFeaturePoint, 4>;

void Look(const VispPoints& points, Features& features) {
  for (std::size_t k = 0; k < features.size(); ++k) {
    features[k].buildFrom(points[k][0], points[k][1], points[k][2]);
  }
}

VispTwist TwistOf(const vpColVector& V) { return {V[0], V[1], V[2], V[3], V[4], V[5]}; }

}  // namespace

struct VispLaw::Task {
  Features s;
  Features s_star;
  vpServo servo;
};

VispLaw::VispLaw(const VispPoints& goal, double lambda) : lambda_(lambda), task_(std::make_unique<Task>()) {
  task_->servo.setServo(vpServo::EYEINHAND_CAMERA);
  task_->servo.setInteractionMatrixType(vpServo::CURRENT, vpServo::PSEUDO_INVERSE);
  task_->servo.setLambda(lambda);
  Look(goal, task_->s_star);
  for (std::size_t k = 0; k < goal.size(); ++k) {
    task_->servo.addFeature(task_->s[k], task_->s_star[k]);
  }
}

VispLaw::~VispLaw() { task_->servo.kill(); }

VispTwist VispLaw::Control(const VispPoints& points) {
  Look(points, task_->s);
  return TwistOf(task_->servo.computeControlLaw());
}

VispTwist VispLaw::Steps(const VispPoints& points, double smallest_ratio) {
  Look(points, task_->s);
  const vpMatrix L = task_->servo.computeInteractionMatrix();
  const vpColVector e = task_->servo.computeError();
  return TwistOf((L.pseudoInverse(smallest_ratio) * e) * -lambda_);
}

}  // namespace fovea::bench
