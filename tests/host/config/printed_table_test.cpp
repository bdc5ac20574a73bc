// SPDX-License-Identifier: Apache-2.0
// Rows of a table break at the style's width, and only their values have colours.
#include "firmware/host/config/printed_table.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fovea::config {
namespace {

TEST(PrintedTableTest, LongValueContinuesInItsColumn) {
  PrintedTable table({.width = 60, .colour = false});
  table.Row("limits used", "joint_position 83 %, joint_velocity 100 %, torque 41 %");
  table.Row("speed", "fast");
  EXPECT_EQ(table.text(),
            "  limits used             joint_position 83 %,\n"
            "                          joint_velocity 100 %, torque 41 %\n"
            "  speed                   fast\n");
}

TEST(PrintedTableTest, PaintSurroundsTheValueAndDoesNotCountAsWidth) {
  PrintedTable table({.width = 60, .colour = true});
  table.Row("verdict", "not converged: the target was lost", Paint::kBad);
  table.Row("faults", "", Paint::kBad);
  EXPECT_EQ(table.text(),
            "  verdict                 \033[31mnot converged: the target was lost\033[0m\n"
            "  faults                  \n");
}

TEST(PrintedTableTest, NameMayBeLongerThanItsColumn) {
  PrintedTable table({}, 4);
  table.Row("a name", "1");
  EXPECT_EQ(table.text(), "  a name1\n");
}

}  // namespace
}  // namespace fovea::config
