// SPDX-License-Identifier: Apache-2.0
// fovea-bench mcu reports every figure and compares them with another run.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea {
namespace {

TEST(McuBudget, BenchReportsAndComparesTheBudget) {
  const test::ProgramResult run = test::RunProgram({FOVEA_BENCH_PROGRAM, "mcu", "--seconds", "0.4", "--json"},
                                                   {}, std::chrono::seconds(300));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> figures;
  for (const auto& figure : nlohmann::json::parse(run.out)) {
    figures[figure["name"]] = figure["value"];
  }
  for (const char* name :
       {"mcu_ball_tick_p50", "mcu_ball_boot_p50", "mcu_ball_hold_max", "mcu_ball_stage_model_p50",
        "mcu_square_stage_predict_max", "mcu_ball_link_p50", "mcu_stack_bytes", "mcu_flash_servo",
        "mcu_flash_features", "mcu_flash_model", "mcu_flash_link", "mcu_flash_board_driver",
        "mcu_flash_arm_table", "mcu_flash_newlib", "mcu_ram_program", "mcu_flash_total", "mcu_ram_total",
        "mcu_ball_clock_mhz_at_1_cycles"}) {
    EXPECT_GT(figures[name], 0.0) << name;
  }
  EXPECT_LE(figures["mcu_ball_tick_min"], figures["mcu_ball_tick_p50"]);
  EXPECT_LE(figures["mcu_ball_tick_p50"], figures["mcu_ball_tick_max"]);
  EXPECT_NEAR(figures["mcu_ball_clock_mhz_at_1_cycles"],
              2e-3 * (figures["mcu_ball_tick_max"] + figures["mcu_ball_link_max"]), 1e-9);

  const test::TempFolder folder;
  const std::string file = folder.path() / "mcu.json";
  std::ofstream(file) << run.out;
  const test::ProgramResult compared =
      test::RunProgram({FOVEA_BENCH_PROGRAM, "compare", file, file, "--most", "1.0"});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  std::cout << compared.out;
}

}  // namespace
}  // namespace fovea
