// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/run_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "firmware/host/beliefs/arm_estimate.hpp"
#include "firmware/host/beliefs/eye_estimate.hpp"
#include "firmware/host/beliefs/servo_estimate.hpp"

namespace fovea::beliefs {
namespace {

constexpr std::size_t kMostSentences = 3;

// Errors of a detector repeat from view to view and from run to run, so the residuals do not show them all.
// With what is added here, the true value is within two standard deviations in 94 to 97 % of runs of the
// scenario ball-exciting, with the ball elsewhere in each (seeds 7001 to 7300; sim/FINDINGS.md has other
// ones).
struct SharedError {
  const char* names_begin;
  double sigma;  // in the belief's unit
};
constexpr std::array<SharedError, 6> kSharedErrors{{{"latency", 0.006},
                                                    {"mount shift", 0.0002},
                                                    {"mount turn", 0.0175},
                                                    {"focal length", 0.034},
                                                    {"target size", 0.02},
                                                    {"encoder zero", 0.045}}};

void AddSharedErrors(std::vector<Belief>& beliefs) {
  for (Belief& belief : beliefs) {
    for (const SharedError& shared : kSharedErrors) {
      if (belief.name.starts_with(shared.names_begin)) {
        belief.sigma = std::hypot(belief.sigma, shared.sigma);
      }
    }
  }
}

// Sets the latency, which too few views or those of a moving target do not tell, from the servo's own
// estimate. At the end of what the servo believes, it is only just known, for the true value may lie beyond.
void TakeLatency(const ServoEstimator& servo, std::vector<Belief>& beliefs) {
  for (Belief& belief : beliefs) {
    if (belief.key == "camera.latency_ms") {
      belief.difference = 1e3 * servo.late().mean_s;
      belief.sigma = std::max(1e3 * servo.late().sigma_s, servo.is_bound() ? belief.sigma_max : 0.0);
    }
  }
}

void SetConfigured(const Configured& configured, std::vector<Belief>& beliefs) {
  for (Belief& belief : beliefs) {
    if (belief.key == "camera.latency_ms") {
      belief.key = configured.latency_key;
      belief.configured = configured.latency_ms;
    } else if (belief.key == "arm.load_mass" && configured.load) {
      belief.configured = configured.load->mass;
    }
  }
}

// The digits after the point with which a number's leading digit is the last one shown.
int DigitsFor(double number) {
  return std::clamp(-static_cast<int>(std::floor(std::log10(std::max(number, 1e-12)))), 0, 6);
}

// "1.9 +- 0.2 deg": down to the standard deviation's leading digit, but not far below what matters.
std::string WithSigma(double value, const Belief& belief) {
  const int digits = std::min(DigitsFor(belief.sigma), DigitsFor(belief.matters) + 1);
  return fmt::format("{:.{}f} +- {:.{}f} {}", value, digits, std::max(belief.sigma, std::pow(0.1, digits)),
                     digits, belief.unit);
}

std::string Sentence(const Belief& belief) {
  if (belief.configured) {
    const double better = std::max(*belief.configured + belief.difference, 0.0);
    return fmt::format("{} is {}, configured {:g}: set {} = {:.{}f}", belief.name, WithSigma(better, belief),
                       *belief.configured, belief.key, better, DigitsFor(belief.matters) + 1);
  }
  return fmt::format("{} is off by {}{}", belief.name, WithSigma(belief.difference, belief),
                     belief.key.empty() ? "" : " (" + belief.key + ")");
}

std::vector<std::string> VerdictOn(const std::vector<Belief>& beliefs) {
  std::vector<Belief> wrong;
  std::copy_if(beliefs.begin(), beliefs.end(), std::back_inserter(wrong),
               [](const Belief& belief) { return belief.IsWrong(); });
  const auto sureness = [](const Belief& belief) { return std::fabs(belief.difference) / belief.sigma; };
  std::stable_sort(wrong.begin(), wrong.end(),
                   [&](const Belief& a, const Belief& b) { return sureness(a) > sureness(b); });
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < std::min(wrong.size(), kMostSentences); ++i) {
    sentences.push_back(Sentence(wrong[i]));
  }
  return sentences;
}

}  // namespace

struct RunWatch::Parts {
  Configured configured;
  EyeEstimator eye;
  ArmEstimator arm;
  ServoEstimator servo;
};

RunWatch::RunWatch(const config::ServoConfig& config, const Configured& configured)
    : parts_(std::make_unique<Parts>(Parts{configured, EyeEstimator(config),
                                           ArmEstimator(config, configured.load.value_or(model::Load{})),
                                           ServoEstimator(config)})) {}

RunWatch::~RunWatch() = default;

void RunWatch::Add(const hal::TickRecord& record) {
  parts_->eye.Add(record);
  parts_->arm.Add(record);
  parts_->servo.Add(record);
}

Findings RunWatch::Finish() const {
  const EyeEstimate eye = parts_->eye.Estimate();
  const ArmEstimate arm = parts_->arm.Estimate();
  Findings findings{eye.views, eye.misfit, arm.windows, eye.beliefs, {}, {}};
  AddSharedErrors(findings.beliefs);
  // Views of a target that did not move, and that still do not fit, have errors that the servo's filter does
  // not know of either.
  const bool may_ask_servo = eye.views == 0 || (!eye.Fits() && parts_->servo.TargetMoved());
  if (may_ask_servo && parts_->servo.HasSettled()) {
    TakeLatency(parts_->servo, findings.beliefs);
  }
  findings.beliefs.insert(findings.beliefs.end(), arm.beliefs.begin(), arm.beliefs.end());
  SetConfigured(parts_->configured, findings.beliefs);
  findings.verdict = VerdictOn(findings.beliefs);
  return findings;
}

EyeEstimate RunWatch::Eye() const { return parts_->eye.Estimate(); }

}  // namespace fovea::beliefs
