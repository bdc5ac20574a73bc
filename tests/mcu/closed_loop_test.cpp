// Whole runs with the servo on the emulated board: it converges, and to the last bit as on this computer.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace fovea {
namespace {

nlohmann::json RunWith(std::vector<std::string> arguments, const std::string& servo) {
  const test::TempFolder folder;
  arguments.insert(arguments.begin(), {FOVEA_SIM_PROGRAM, "run"});
  arguments.insert(arguments.end(),
                   {"--servo", servo, "--no-report", "--json", "--out", (folder.path() / "out").string()});
  const test::ProgramResult result = test::RunProgram(arguments, {}, std::chrono::seconds(600));
  EXPECT_NE(result.exit_code, 2) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

struct McuCase {
  std::string name;
  std::vector<std::string> arguments;
  bool converges;
};
void PrintTo(const McuCase& c, std::ostream* out) { *out << c.name; }

class McuLoop : public testing::TestWithParam<McuCase> {};

TEST_P(McuLoop, IsTheComputersToTheLastBit) {
  const nlohmann::json here = RunWith(GetParam().arguments, "pc");
  const nlohmann::json there = RunWith(GetParam().arguments, "mcu");
  ASSERT_TRUE(here.is_object() && there.is_object());
  EXPECT_EQ(there["log_hash"], here["log_hash"]);
  EXPECT_EQ(there["heap_allocations_in_tick"], 0);
  EXPECT_EQ(there["mcu"]["frames_sent_again"], 0);
  if (GetParam().converges) {
    EXPECT_EQ(there["converged"], true) << there["verdict"];
  }
  std::cout << there["ticks"] << " ticks, the same " << here["log_hash"] << "; on the board " << there["mcu"]
            << '\n';
}

INSTANTIATE_TEST_SUITE_P(
    Scenarios, McuLoop,
    testing::Values(McuCase{"Ball", {"ball"}, true},
                    McuCase{"BallMoving", {"ball-moving", "--set", "run.duration_s=3"}, false},
                    McuCase{"Square", {"square", "--set", "run.duration_s=1.5"}, false},
                    McuCase{"FramesAndStatesLost",
                            {"ball", "--set", "run.duration_s=3", "--set", "faults.camera_outage_s=[1,1.3]",
                             "--set", "faults.packet_loss_s=[1.5,2]", "--set", "faults.packet_loss=0.3"},
                            false}),
    [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace fovea
