// A file is there whole or not at all.
#include "sim/app/output_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "fovea/config/input_error.hpp"
#include "support/temp_folder.hpp"

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;

std::string Read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(OutputFolderTest, WritesReplacesAndLeavesNothingElse) {
  const test::TempFolder temp;
  const OutputFolder folder(temp.path() / "a" / "b");
  folder.Write("x.json", "one");
  folder.Write("x.json", "two");
  EXPECT_EQ(Read(folder.path() / "x.json"), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(OutputFolderTest, AWriteThatFailsLeavesTheOldFile) {
  const test::TempFolder temp;
  const OutputFolder folder(temp.path());
  folder.Write("x.json", "one");
  fs::create_directory(temp.path() / ".x.json.partial");  // the file beside it cannot be made
  EXPECT_THROW(folder.Write("x.json", "two"), config::InputError);
  EXPECT_EQ(Read(temp.path() / "x.json"), "one");
}

TEST(OutputFolderTest, AFolderThatCannotBeIsRefusedAtOnce) {
  const test::TempFolder temp;
  std::ofstream(temp.path() / "file") << "x";
  EXPECT_THROW(OutputFolder(temp.path() / "file"), config::InputError);
  EXPECT_THROW(OutputFolder(temp.path() / "file" / "below"), config::InputError);
}

}  // namespace
}  // namespace fovea::sim
