// SPDX-License-Identifier: Apache-2.0
// Checks that every test and every fuzz target that SECURITY.md names exists.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "tests/arch/source_tree.hpp"

namespace fovea {
namespace {

std::string Text(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(SecurityPage, NamesOnlyExistingTests) {
  const std::filesystem::path root = test::SourceRoot();
  const std::string page = Text(root / "SECURITY.md");
  std::string tests;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "tests")) {
    const std::string extension = entry.path().extension().string();
    if ((extension == ".cpp" || extension == ".py" || extension == ".txt") &&
        entry.path().string().find("node_modules") == std::string::npos) {
      tests += Text(entry.path());
    }
  }
  int suites = 0;
  const std::regex suite("`([A-Z][A-Za-z]+)[.]([A-Za-z_*]+)`");
  for (std::sregex_iterator it(page.begin(), page.end(), suite), end; it != end; ++it) {
    const std::string name = (*it)[1];
    const std::string what = (*it)[2];
    bool there = false;
    for (const char* before : {"TEST(", "TEST_F(", "TEST_P(", "class "}) {
      const char* after = std::string(before) == "class " ? "(" : ",";
      there = there || tests.find(before + name + after) != std::string::npos;
    }
    EXPECT_TRUE(there) << name;
    EXPECT_TRUE(what == "*" || tests.find(what) != std::string::npos) << name << "." << what;
    ++suites;
  }
  int targets = 0;
  const std::regex target("`([a-z]+_[a-z]+|settings)`");
  for (std::sregex_iterator it(page.begin(), page.end(), target), end; it != end; ++it) {
    EXPECT_NE(tests.find("fovea_add_fuzz(" + (*it)[1].str()), std::string::npos) << (*it)[1];
    ++targets;
  }
  EXPECT_GT(suites, 10);
  EXPECT_GT(targets, 8);
}

}  // namespace
}  // namespace fovea
