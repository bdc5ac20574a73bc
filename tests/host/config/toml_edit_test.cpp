// SPDX-License-Identifier: Apache-2.0
// Editing changes the values and leaves the rest of the text as it is.
#include "firmware/host/config/toml_edit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "firmware/host/config/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::config {
namespace {

using testing::HasSubstr;

const std::vector<NewValue> kMount{{"mount_xyz", "[1.5, 2.0, 3.0]"}, {"rms", "0.25"}};

std::string ErrorOf(const std::string& text) {
  try {
    (void)WithValues(text, "camera", kMount);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SectionTextTest, IsWhatAFileWithoutTheSectionGets) {
  EXPECT_EQ(SectionText("camera", kMount), "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
  EXPECT_EQ(SectionText("camera", kMount), WithValues("", "camera", kMount));
}

TEST(WithValuesTest, ReplacesAValueWhereItStands) {
  EXPECT_EQ(
      WithValues(
          "# robot\n[camera]  # eye\nrate = 30   # Hz\nmount_xyz = [0.0, 0.0, 0.0]  # guessed\nrms = 1\n"
          "[servo]\nlambda = 2\n",
          "camera", kMount),
      "# robot\n[camera]  # eye\nrate = 30   # Hz\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n[servo]\nlambda "
      "= 2\n");
}

TEST(WithValuesTest, ReplacesAListOfSeveralLines) {
  EXPECT_EQ(WithValues("[camera]\nmount_xyz = [\n  0.1,  # x\n  0.2,\n  0.3\n]\nrms = 1\n", "camera", kMount),
            "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
}

TEST(WithValuesTest, AddsKeysToASectionInTheirOrder) {
  EXPECT_EQ(WithValues("[camera]\nrate = 30\n[servo]\n", "camera", kMount),
            "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\nrate = 30\n[servo]\n");
  EXPECT_EQ(WithValues("[camera]", "camera", kMount), "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
}

TEST(WithValuesTest, AddsASectionAtTheEnd) {
  EXPECT_EQ(WithValues("[servo]\nlambda = 2", "camera", kMount),
            "[servo]\nlambda = 2\n\n[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
  EXPECT_EQ(WithValues("", "camera", kMount), "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
}

TEST(WithValuesTest, FindsItsPlaceBehindLettersOfSeveralBytes) {
  EXPECT_EQ(WithValues("[camera]\nname = \"\u00fcber \u2192\"  # \u00e4\nrms = 1\nmount_xyz = [0]\n",
                       "camera", kMount),
            "[camera]\nname = \"\u00fcber \u2192\"  # \u00e4\nrms = 0.25\nmount_xyz = [1.5, 2.0, 3.0]\n");
}

TEST(WithValuesTest, RefusesATableThatIsNotASection) {
  EXPECT_THAT(ErrorOf("camera = {rms = 1}\n"), HasSubstr("by hand"));
  EXPECT_THAT(ErrorOf("camera.rms = 1\n"), HasSubstr("by hand"));
  EXPECT_THAT(ErrorOf("camera = 3\n"), HasSubstr("not a section"));
  EXPECT_THAT(ErrorOf("[[camera]]\nrms = 1\n"), HasSubstr("not a section"));
  EXPECT_THAT(ErrorOf("[camera\n"), HasSubstr("not TOML"));
}

TEST(WriteValuesTest, ReplacesTheFileOrLeavesIt) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "cell.toml";
  const auto content = [&file] {
    std::ifstream in(file);
    return std::string{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  };
  std::ofstream(file) << "[camera]\nrms = 1\n";
  WriteValues(file, "camera", kMount);
  EXPECT_EQ(content(), "[camera]\nmount_xyz = [1.5, 2.0, 3.0]\nrms = 0.25\n");
  std::ofstream(file) << "camera.rms = 1\n";
  EXPECT_THROW(WriteValues(file, "camera", kMount), InputError);
  EXPECT_EQ(content(), "camera.rms = 1\n");
  EXPECT_THROW(WriteValues(folder.path() / "none.toml", "camera", kMount), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace fovea::config
