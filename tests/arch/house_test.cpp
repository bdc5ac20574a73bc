// SPDX-License-Identifier: Apache-2.0
// Keeps the tree easy to read: short files, small folders, and namespaces named after their folder.
#include <gtest/gtest.h>

#include <map>

#include "tests/arch/source_tree.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLines = 400;
constexpr std::size_t kMostSources = 25;  // per folder; a header and its source count as one

const char* const kTrees[] = {"hal", "firmware", "sim", "tools", "tests"};

std::size_t LinesOf(const fs::path& file) {
  std::ifstream in(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) {
    ++lines;
  }
  return lines;
}

TEST(SourceTree, NoFileExceedsTheLineLimit) {
  std::size_t longest = 0;
  for (const char* tree : kTrees) {
    for (const fs::path& file : test::SourcesIn(tree)) {
      const std::size_t lines = LinesOf(file);
      longest = std::max(longest, lines);
      EXPECT_LE(lines, kMostLines) << fs::relative(file, test::SourceRoot()).string();
    }
  }
  std::printf("longest: %zu lines\n", longest);
  EXPECT_GT(longest, 100U);
}

TEST(SourceTree, NoFolderExceedsTheFileLimit) {
  std::map<fs::path, std::set<std::string>> rooms;
  for (const char* tree : kTrees) {
    for (const fs::path& file : test::SourcesIn(tree)) {
      rooms[file.parent_path()].insert(file.stem().string());
    }
  }
  std::size_t fullest = 0;
  for (const auto& [room, sources] : rooms) {
    fullest = std::max(fullest, sources.size());
    EXPECT_LE(sources.size(), kMostSources) << fs::relative(room, test::SourceRoot()).string();
  }
  std::printf("fullest: %zu sources\n", fullest);
  EXPECT_GT(fullest, 5U);
}

// The last namespace that a file opens below fovea; "" if it opens none.
std::string NamespaceOf(const fs::path& file) {
  static const std::regex kNamespace(R"(^namespace fovea::(\w+)(::\w+)? \{)");
  std::ifstream in(file);
  std::smatch match;
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (std::regex_search(line, match, kNamespace)) {
      last = match[1];  // forward declarations of other modules stand before the file's own namespace
    }
  }
  return last;
}

TEST(SourceTree, NamespacesMatchTheirFolders) {
  for (const char* folder : {"firmware/core", "firmware/host", "firmware/vision"}) {
    for (const fs::path& file : test::SourcesIn(folder)) {
      const std::string space = NamespaceOf(file);
      const std::string room =
          std::string(folder) == "firmware/vision" ? "vision" : file.parent_path().filename().string();
      EXPECT_TRUE(space == room || room == "host")
          << fs::relative(file, test::SourceRoot()).string() << ": " << space;
    }
  }
}

}  // namespace
}  // namespace fovea
