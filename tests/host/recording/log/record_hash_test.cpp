// SPDX-License-Identifier: Apache-2.0
// The hash of the records changes with any bit of a record.
#include "firmware/host/recording/log/record_hash.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace fovea::log {
namespace {

std::string HashOf(const std::function<void(hal::TickRecord&)>& change) {
  hal::TickRecord record;
  record.arm.num_joints = record.command.num_joints = 7;
  record.dim = record.feature.dim = 3;
  change(record);
  RecordHash hash;
  hash.Add(record);
  return hash.Finish();
}

TEST(RecordHashTest, EveryFieldChangesTheHash) {
  const std::vector<std::function<void(hal::TickRecord&)>> changes = {
      [](hal::TickRecord&) {},
      [](hal::TickRecord& r) { r.tick = 1; },
      [](hal::TickRecord& r) { r.stamp_ns = 1; },
      [](hal::TickRecord& r) { r.missed_ticks = 1; },
      [](hal::TickRecord& r) { r.arm.stamp_ns = 1; },
      [](hal::TickRecord& r) { r.arm.sequence = 1; },
      [](hal::TickRecord& r) { r.arm.q[6] = 1e-300; },
      [](hal::TickRecord& r) { r.arm.dq[0] = 1e-300; },
      [](hal::TickRecord& r) { r.arm.tau_meas[0] = 1e-300; },
      [](hal::TickRecord& r) { r.arm.tau_applied[0] = 1e-300; },
      [](hal::TickRecord& r) { r.has_feature = true; },
      [](hal::TickRecord& r) { r.feature.stamp_ns = 1; },
      [](hal::TickRecord& r) { r.feature.sequence = 1; },
      [](hal::TickRecord& r) { r.feature.found = true; },
      [](hal::TickRecord& r) { r.feature.confidence = 0.5; },
      [](hal::TickRecord& r) { r.feature.s[2] = 1e-300; },
      [](hal::TickRecord& r) { r.feature.cov_s[0] = 1e-300; },
      [](hal::TickRecord& r) { r.feature.num_poses = 1; },
      [](hal::TickRecord& r) { r.feature.same_for_ns = 1; },
      [](hal::TickRecord& r) { r.intake = hal::Intake::kOutlier; },
      [](hal::TickRecord& r) { r.tuning.result = hal::TuningResult::kTaken; },
      [](hal::TickRecord& r) { r.tuning.result = hal::TuningResult::kNotFinite; },
      [](hal::TickRecord& r) {
        r.tuning = {hal::TuningResult::kTaken, 3, 0.0, 0.0};
      },
      [](hal::TickRecord& r) {
        r.tuning = {hal::TuningResult::kTaken, -1, 1e-300, 0.0};
      },
      [](hal::TickRecord& r) {
        r.tuning = {hal::TuningResult::kTaken, -1, 0.0, 1e-300};
      },
      [](hal::TickRecord& r) { r.feature.num_poses = 1, r.feature.poses[0].first = 1; },
      [](hal::TickRecord& r) { r.feature.num_poses = 1, r.feature.poses[0].p_CO_C[0] = 1e-300; },
      [](hal::TickRecord& r) { r.feature.num_poses = 1, r.feature.poses[0].q_CO[3] = 1e-300; },
      [](hal::TickRecord& r) { r.mode = hal::Mode::kTrack; },
      [](hal::TickRecord& r) { r.hold_reason = hal::HoldReason::kNoTarget; },
      [](hal::TickRecord& r) { r.fault = hal::Fault::kArmLost; },
      [](hal::TickRecord& r) { r.fault_joint = 2; },
      [](hal::TickRecord& r) { r.limits_active = 4; },
      [](hal::TickRecord& r) { r.target_known = true; },
      [](hal::TickRecord& r) { r.feature_age_ns = 1; },
      [](hal::TickRecord& r) { r.p_BO[0] = 1e-300; },
      [](hal::TickRecord& r) { r.q_BO[3] = 1e-300; },
      [](hal::TickRecord& r) { r.v_BO[0] = 1e-300; },
      [](hal::TickRecord& r) { r.stamp_late_s = 1e-300; },
      [](hal::TickRecord& r) { r.stamp_late_sigma_s = 1e-300; },
      [](hal::TickRecord& r) { r.s[0] = 1e-300; },
      [](hal::TickRecord& r) { r.s_star[0] = 1e-300; },
      [](hal::TickRecord& r) { r.e[0] = 1e-300; },
      [](hal::TickRecord& r) { r.V_BC_C_cmd[5] = 1e-300; },
      [](hal::TickRecord& r) { r.way.way = hal::Way::kPlan; },
      [](hal::TickRecord& r) { r.way.event = hal::PlanEvent::kTaken; },
      [](hal::TickRecord& r) { r.way.plans_asked = 1; },
      [](hal::TickRecord& r) { r.way.tries = 1; },
      [](hal::TickRecord& r) { r.way.outcome = 1; },
      [](hal::TickRecord& r) { r.way.normal_B[2] = 1e-300; },
      [](hal::TickRecord& r) { r.q_cmd[0] = 1e-300; },
      [](hal::TickRecord& r) { r.dq_cmd[0] = 1e-300; },
      [](hal::TickRecord& r) { r.ddq_cmd[0] = 1e-300; },
      [](hal::TickRecord& r) { r.tau_ext[0] = 1e-300; },
      [](hal::TickRecord& r) { r.command.tau_cmd[6] = -0.0; },
      [](hal::TickRecord& r) { r.command.engage_brakes = true; },
      [](hal::TickRecord& r) { r.command.state_sequence = 1; },
  };
  std::set<std::string> hashes;
  for (const auto& change : changes) {
    hashes.insert(HashOf(change));
  }
  EXPECT_EQ(hashes.size(), changes.size());
}

TEST(RecordHashTest, EqualRecordsHaveEqualHashes) {
  const auto change = [](hal::TickRecord& r) { r.arm.q[0] = 0.3; };
  EXPECT_EQ(HashOf(change), HashOf(change));
  EXPECT_EQ(HashOf(change).size(), 64U);
}

}  // namespace
}  // namespace fovea::log
