// SPDX-License-Identifier: Apache-2.0
// The reader of the linker's map, with a small map of known sums.
#include "tools/bench/mcu/link_map.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>

#include "tests/support/temp_folder.hpp"

namespace fovea::bench {
namespace {

constexpr const char* kMap = R"(Archive member included to satisfy reference by file (symbol)

.text          0x00000000      0x999 not yet the map

Linker script and memory map

                0x00010000                        STACK_BYTES = 0x10000

.text           0x00000000       0xd0
 *(.text .text.*)
 .text.Step     0x00000000       0x40 lib/libfovea_servo.a(servo_task.cpp.obj)
                0x00000000                Step
 .text._ZN5fovea9cortex_m712EnableFaultsEv
                0x00000040       0x20 hal/drivers/cortex_m7/CMakeFiles/x.dir/faults.cpp.obj
 *fill*         0x00000060        0x4 
 .rodata._ZN5fovea4arms10panda_data7kJointsE
                0x00000064       0x6c targets/cortex_m7/CMakeFiles/x.dir/main.cpp.obj

.stack          0x20000000      0x100
                0x20000000                stack_bottom = .
                0x20000080                . = (. + STACK_BYTES)
 *fill*         0x20000000      0x100 

.data           0x20000100        0x8 load address 0x000000d0
 .data.value    0x20000100        0x8 lib/libfovea_link.a(frame.cpp.obj)

.bss            0x20000108       0x10
 .bss.state     0x20000108       0x10 lib/libfovea_servo.a(servo_task.cpp.obj)

.debug_info     0x00000000     0x4000
 .debug_info    0x00000000     0x4000 lib/libfovea_servo.a(servo_task.cpp.obj)
)";

TEST(LinkMap, SizesAddUpByModule) {
  const test::TempFolder folder;
  const auto file = folder.path() / "image.map";
  std::ofstream(file) << kMap;
  const LinkMap map = ReadLinkMap(file);
  EXPECT_EQ(map.total.flash, 0xd0U + 0x8U);
  EXPECT_EQ(map.total.ram, 0x100U + 0x8U + 0x10U);
  EXPECT_EQ(map.modules.at("servo").flash, 0x40U);
  EXPECT_EQ(map.modules.at("servo").ram, 0x10U);
  EXPECT_EQ(map.modules.at("board driver").flash, 0x20U);
  EXPECT_EQ(map.modules.at("arm table").flash, 0x6cU);
  EXPECT_EQ(map.modules.at("alignment").flash, 0x4U);
  EXPECT_EQ(map.modules.at("link").flash, 0x8U);
  EXPECT_EQ(map.modules.at("link").ram, 0x8U);
  EXPECT_EQ(map.modules.at("stacks").ram, 0x100U);
}

TEST(LinkMap, MissingMapFileIsRefused) {
  const test::TempFolder folder;
  EXPECT_THROW(ReadLinkMap(folder.path() / "none.map"), std::runtime_error);
}

}  // namespace
}  // namespace fovea::bench
