// SPDX-License-Identifier: Apache-2.0
// Whole runs with the servo on the emulated board: they converge, and match this computer bit-exactly.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/sim/mcu/run_sim.hpp"

namespace fovea {
namespace {

struct McuCase {
  std::string name;
  std::vector<std::string> arguments;
  bool converges;
};
void PrintTo(const McuCase& c, std::ostream* out) { *out << c.name; }

class McuLoop : public testing::TestWithParam<McuCase> {};

TEST_P(McuLoop, RunMatchesTheComputerBitExact) {
  const nlohmann::json here = test::RunSim(GetParam().arguments, "pc");
  const nlohmann::json there = test::RunSim(GetParam().arguments, "mcu");
  ASSERT_TRUE(here.is_object() && there.is_object());
  EXPECT_EQ(there["log_hash"], here["log_hash"]);
  EXPECT_EQ(there["heap_allocations_in_tick"], 0);
  EXPECT_EQ(there["mcu"]["frames_sent_again"], 0);
  EXPECT_EQ(there["mcu"]["line"]["damaged_frames"], 0);
  EXPECT_EQ(there["mcu"]["line"]["lost_bytes"], 0);
  if (GetParam().converges) {
    EXPECT_EQ(there["converged"], true) << there["verdict"];
  }
  std::cout << there["ticks"] << " ticks, the same " << here["log_hash"] << "; on the board "
            << there["mcu"]["instructions"]["tick"] << " instructions, " << there["mcu"]["stack_bytes"]
            << " bytes of stack\n";
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, McuLoop,
    testing::Values(McuCase{"Ball", {"ball", "--set", "run.duration_s=2.4"}, true},
                    McuCase{"BallMoving", {"ball-moving", "--set", "run.duration_s=0.6"}, false},
                    McuCase{"Square", {"square", "--set", "run.duration_s=1.5"}, false},
                    McuCase{
                        "FramesAndStatesLost",
                        {"ball", "--set", "run.duration_s=0.9", "--set", "faults.camera_outage_s=[0.3,0.5]",
                         "--set", "faults.packet_loss_s=[0.6,0.8]", "--set", "faults.packet_loss=0.3"},
                        false}),
    [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace fovea
