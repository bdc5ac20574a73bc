// SPDX-License-Identifier: Apache-2.0
// Which files the live page's server has, and under which paths.
#include "firmware/host/live/page_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_folder.hpp"

namespace fovea::live {
namespace {

class PageFilesTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& content) const {
    const auto path = folder_.path() / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << content;
  }
  [[nodiscard]] PageFiles Read() const { return {folder_.path() / "page", folder_.path() / "shared"}; }

  const test::TempFolder folder_;
};

TEST_F(PageFilesTest, FilesHaveTheirPathsAndTypes) {
  Write("page/index.html",
        R"(<link href="/lib/dygraphs/dygraph.min.css"><script src="lib/three/three.min.js">)");
  Write("page/parts/a.js", "a");
  Write("page/b.css", "b");
  Write("page/c.bin", "c");
  Write("shared/d.js", "d");
  Write("other/e.js", "e");
  const PageFiles files = Read();
  EXPECT_STREQ(files.Find("/")->type, "text/html; charset=utf-8");
  EXPECT_EQ(files.Find("/index.html"), nullptr);
  EXPECT_EQ(files.Find("/parts/a.js")->content, "a");
  EXPECT_STREQ(files.Find("/parts/a.js")->type, "text/javascript; charset=utf-8");
  EXPECT_STREQ(files.Find("/b.css")->type, "text/css; charset=utf-8");
  EXPECT_STREQ(files.Find("/c.bin")->type, "application/octet-stream");
  EXPECT_EQ(files.Find("/shared/d.js")->content, "d");
  EXPECT_EQ(files.Find("/../other/e.js"), nullptr);
  EXPECT_NE(files.Find("/lib/three/three.min.js"), nullptr);
  EXPECT_NE(files.Find("/lib/dygraphs/dygraph.min.css"), nullptr);
  EXPECT_EQ(files.Find("/lib/three/three.js"), nullptr);
}

TEST_F(PageFilesTest, MissingFilesAreNamed) {
  EXPECT_THROW(static_cast<void>(Read()), std::runtime_error);
  Write("page/index.html", R"(<script src="lib/three/missing.js">)");
  try {
    static_cast<void>(Read());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("three/missing.js: missing; the live page needs it"));
  }
  Write("page/index.html", R"(<script src="lib/../../../etc/passwd">)");
  EXPECT_THROW(static_cast<void>(Read()), std::runtime_error);
}

}  // namespace
}  // namespace fovea::live
