// SPDX-License-Identifier: Apache-2.0
// servo.learn: what the servo should be told while it runs, from what a run has told so far.
//
// Each quantity has a key that may change in motion, so a correction is a request like an operator's:
// bounded, recorded, ramped by the tick, and replayed from the log.
//
//   latency   servo.stamp_offset   the servo gets stamps, so a wrong latency is a known offset of the stamps
//   payload   servo.load_offset    a mass at arm.load_com; its centre stays as configured, because a wrong
//                                  centre of a load of a few hundred grams costs less than its weight
//
// A finding counts if it is known, and differs from what is in force by more than three standard deviations
// and by enough to matter. The step d is then shortened to d (1 - (3 sigma / d)^2), the positive part of
// James and Stein (Estimation with quadratic loss, 1961): a finding that barely counts hardly moves the key,
// so that the key does not follow the noise, and a sure one moves it at once. Nothing is asked while the
// servo has a fault, doubts its eye or keeps the brakes closed.
#pragma once

#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/config/tuning.hpp"
#include "firmware/host/beliefs/belief.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::beliefs {

// The quantities of servo.learn.
struct Learns {
  bool latency = false;
  bool payload = false;
  [[nodiscard]] bool Any() const { return latency || payload; }
};

class Learner {
 public:
  Learner(const config::ServoConfig& config, const Learns& learns);

  // What to ask of the servo, given what the run has told so far: nothing, or a request for each key.
  [[nodiscard]] std::vector<config::Tuning> Decide(const Findings& findings);
  // A tick's record, in their order: the servo's answer, and changes by an operator.
  void Note(const hal::TickRecord& record);
  // The corrections that the servo has taken, in order of time.
  [[nodiscard]] const std::vector<Correction>& corrections() const { return corrections_; }

 private:
  struct Quantity {
    const char* name;    // for people
    const char* belief;  // its name
    const char* key;     // that is asked for
    const char* unit;    // of that key
    int number;          // of that key
    double per_unit;     // of the belief's unit
    double min;          // allowed, in the unit of the key
    double max;
    double in_force;  // or soon
    double asked;     // last; NaN: nothing is
  };

  std::vector<Quantity> quantities_;
  bool may_learn_ = true;  // as the last record says
  std::vector<Correction> corrections_;
};

}  // namespace fovea::beliefs
