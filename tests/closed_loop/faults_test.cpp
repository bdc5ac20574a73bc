// SPDX-License-Identifier: Apache-2.0
// Whole runs with injected faults: the servo rides out transient ones. The same seed repeats a run exactly.
#include <gmock/gmock.h>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

struct Case {
  const char* name;
  std::vector<std::string> assignments;
};

// Each begins at 0.6 s or later, during the approach, and lasts at most 1.8 s. The run lasts 5 s.
class TransientFault : public testing::TestWithParam<Case> {};

TEST_P(TransientFault, RunStillConverges) {
  std::vector<std::string> assignments = GetParam().assignments;
  assignments.emplace_back("run.duration_s=5");
  const sim::Summary s = RunShipped("ball", assignments);
  std::cout << GetParam().name << ": " << s.frames << " frames, " << s.frames_detected << " detected, "
            << s.modes.size() << " modes; ";
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  ExpectSound(s);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, TransientFault,
    testing::Values(Case{"FrameLoss", {"faults.frame_loss_s=[0.6, 2.4]", "faults.frame_loss=0.6"}},
                    Case{"Freeze", {"faults.freeze_s=[0.6, 0.8]"}},
                    Case{"Latency", {"faults.latency_s=[0.6, 2.4]", "faults.latency_ms=60"}},
                    Case{"GlareAndOccluder",
                         {"faults.glare_s=[0.6, 1.6]", "faults.glare_px=[340, 260, 30]",
                          "faults.occluder_s=[0.6, 1.6]", "faults.occluder_px=[300, 240, 20, 480]"}},
                    Case{"WrongDetections",
                         {"faults.wrong_detection_s=[0.6, 2.4]", "faults.wrong_detection=0.3",
                          "faults.wrong_detection_shift=[3, -2, 1]"}},
                    Case{"Line",
                         {"faults.packet_loss_s=[0.6, 2.4]", "faults.packet_loss=0.2",
                          "faults.deadline_miss_s=[0.6, 2.4]", "faults.deadline_miss=0.2",
                          "faults.encoder_noise_s=[1.0, 1.2]", "faults.encoder_noise=2e-4",
                          "faults.velocity_noise=0.01"}},
                    Case{"Load", {"faults.load_s=[0.6, 2.4]", "faults.load_mass=1"}}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST(InjectedFaults, LostFramesAreCounted) {
  const sim::Summary all = RunShipped("ball", {"run.duration_s=1.2"});
  EXPECT_EQ(all.frames_lost, 0U);
  const sim::Summary some =
      RunShipped("ball", {"run.duration_s=1.2", "faults.frame_loss_s=[0.2, 0.8]", "faults.frame_loss=0.6"});
  std::cout << some.frames << " frames, " << some.frames_lost << " lost\n";
  EXPECT_GT(some.frames_lost, 0U);
  EXPECT_EQ(some.frames + some.frames_lost, all.frames);
}

TEST(InjectedFaults, MissedTicksDoNotOutlastTheRun) {
  const sim::Summary s = RunShipped("ball", {"run.duration_s=0.6", "faults.deadline_miss_s=[0.3, 2]"});
  EXPECT_EQ(s.ticks, 300U);
  EXPECT_NEAR(s.sim_time_s, 0.6, 1e-9);
}

std::string HashOf(int seed) {
  const sim::Summary s = RunShipped(
      "ball", {"run.duration_s=1.2", "run.seed=" + std::to_string(seed), "faults.frame_loss_s=[0.2, 1]",
               "faults.packet_loss_s=[0.2, 1]", "faults.packet_loss=0.1", "faults.encoder_noise_s=[0.5, 0.6]",
               "faults.encoder_noise=1e-4", "faults.wrong_detection_s=[0.2, 1]", "faults.wrong_detection=0.2",
               "faults.deadline_miss_s=[0.2, 1]", "faults.deadline_miss=0.05"});
  return s.log_hash;
}

TEST(InjectedFaults, RunRepeatsForTheSameSeedOnly) {
  const std::string first = HashOf(3);
  EXPECT_EQ(HashOf(3), first);
  EXPECT_NE(HashOf(4), first);
}

}  // namespace
}  // namespace fovea::test
