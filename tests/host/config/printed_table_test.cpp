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

TEST(PrintedTableTest, PaintEndsBeforeEachLineEnd) {
  PrintedTable table({.width = 60, .colour = true});
  table.Row("verdict", "not converged: the target was lost in the last second", Paint::kBad);
  EXPECT_EQ(table.text(),
            "  verdict                 \033[31mnot converged: the target was lost\033[0m\n"
            "                          \033[31min the last second\033[0m\n");
}

TEST(PrintedTableTest, NameMayBeLongerThanItsColumn) {
  PrintedTable table({});
  table.Row("a name of 23 characters", "1");
  table.Row("a name of 24 characters.", "2");
  table.WholeRow("a name of 25 characters..", "3");
  EXPECT_EQ(table.text(),
            "  a name of 23 characters 1\n"
            "  a name of 24 characters. 2\n"
            "  a name of 25 characters.. 3\n");
}

}  // namespace
}  // namespace fovea::config
