// SPDX-License-Identifier: Apache-2.0
// Checks that the code of the tick calls nothing that could allocate, lock, throw or make a system call.
// Reads the symbols that the tick's libraries need: these libraries would link on bare metal.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/arch/source_tree.hpp"

namespace fovea {
namespace {

const char* const kLibraries[] = {FOVEA_HAL_LIBRARY, FOVEA_MODEL_LIBRARY, FOVEA_FEATURES_LIBRARY,
                                  FOVEA_SERVO_LIBRARY, FOVEA_LINK_LIBRARY};

// The last word of each line of `nm`.
std::set<std::string> Symbols(const std::string& options) {
  std::set<std::string> symbols;
  for (const char* library : kLibraries) {
    std::istringstream lines(test::OutputOf("nm " + options + " '" + library + "' 2>&1"));
    for (std::string line; std::getline(lines, line);) {
      const auto space = line.find_last_of(' ');
      if (space != std::string::npos && line.find(':') == std::string::npos) {
        symbols.insert(line.substr(space + 1));
      }
    }
  }
  return symbols;
}

TEST(TickSymbolsTest, TickCallsOnlyAllowedSymbols) {
#ifdef FOVEA_SANITIZED
  GTEST_SKIP() << "a sanitizer adds calls of its own";
#endif
  const std::set<std::string> defined = Symbols("--defined-only");
  const std::set<std::string> needed = Symbols("--undefined-only");
  ASSERT_GT(defined.size(), 50U) << "nm printed no symbols: is it installed?";
  const std::set<std::string> allowed = {"memcpy",
                                         "memset",
                                         "memmove",
                                         "memcmp",
                                         "_GLOBAL_OFFSET_TABLE_",
                                         "__stack_chk_fail",
                                         "__cxa_pure_virtual"};
  for (const std::string& symbol : needed) {
    EXPECT_TRUE(defined.count(symbol) == 1 || allowed.count(symbol) == 1) << "the tick needs " << symbol;
  }
}

// The hardware target's libraries do not need the simulator's.
TEST(SharedLibrariesTest, FirmwareProgramNeedsNoBulletOrEgl) {
  const std::string needed = test::OutputOf("readelf -d '" FOVEA_FIRMWARE_PROGRAM "' | grep NEEDED");
  ASSERT_NE(needed.find("libopencv_imgproc"), std::string::npos)
      << "readelf printed no OpenCV library: is it installed?";
  for (const char* name : {"Bullet", "LinearMath", "libEGL", "libepoxy", "libGL"}) {
    EXPECT_EQ(needed.find(name), std::string::npos) << name;
  }
}

#ifdef FOVEA_SIM_PROGRAM
// The simulator plays no recorded pictures.
TEST(SharedLibrariesTest, SimulatorNeedsNoVideoFiles) {
  const std::string needed = test::OutputOf("readelf -d '" FOVEA_SIM_PROGRAM "' | grep NEEDED");
  ASSERT_NE(needed.find("libopencv_imgproc"), std::string::npos)
      << "readelf printed no OpenCV library: is it installed?";
  EXPECT_EQ(needed.find("libopencv_videoio"), std::string::npos);
}
#endif

}  // namespace
}  // namespace fovea
