// SPDX-License-Identifier: Apache-2.0
// An output file is either complete or absent.
#include "firmware/host/config/output_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "firmware/host/config/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::config {
namespace {

namespace fs = std::filesystem;

std::string Read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(OutputFolderTest, ReplaceWritesNewFilesAndRemovesOldOnes) {
  const test::TempFolder temp;
  const OutputFolder folder(temp.path() / "a" / "b");
  const std::vector<std::string> names{"x.json", "y.png"};
  folder.Replace({{"y.png", "picture"}, {"x.json", "one"}}, names);
  std::ofstream(folder.path() / "mine.txt") << "a person's own";
  folder.Replace({{"x.json", "two"}}, names);
  EXPECT_EQ(Read(folder.path() / "x.json"), "two");
  EXPECT_FALSE(fs::exists(folder.path() / "y.png")) << "a picture of an earlier run is left";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(OutputFolderTest, FailedWriteKeepsTheOldFiles) {
  const test::TempFolder temp;
  const OutputFolder folder(temp.path());
  const std::vector<std::string> names{"a.png", "b.png", "x.json"};
  folder.Replace({{"a.png", "one"}, {"x.json", "one"}}, names);
  fs::create_directory(temp.path() / "b.png");
  EXPECT_THROW(folder.Replace({{"a.png", "two"}, {"b.png", "two"}, {"x.json", "two"}}, names), InputError);
  EXPECT_EQ(Read(temp.path() / "a.png"), "one");
  EXPECT_EQ(Read(temp.path() / "x.json"), "one");
  EXPECT_EQ(std::distance(fs::directory_iterator(temp.path()), fs::directory_iterator()), 3);
}

TEST(OutputFolderTest, FailedRenameKeepsTheOldFilesAndTheBegunOnes) {
  const test::TempFolder temp;
  OutputFolder folder(temp.path());
  const std::vector<std::string> names{"log.mcap", "film.mp4", "x.json"};
  folder.Replace({{"log.mcap", "one"}, {"film.mp4", "one"}, {"x.json", "one"}}, names);
  std::ofstream(folder.Begin("log.mcap")) << "two";
  static_cast<void>(folder.Begin("film.mp4"));  // never written: its rename fails
  EXPECT_THROW(
      folder.Replace({{"log.mcap", std::nullopt}, {"film.mp4", std::nullopt}, {"x.json", "two"}}, names),
      InputError);
  for (const std::string& name : names) {
    EXPECT_EQ(Read(temp.path() / name), "one") << name;
  }
  folder.Keep("log.mcap", names);
  EXPECT_EQ(Read(temp.path() / "log.mcap"), "two") << "a begun file can still be kept";
  EXPECT_EQ(std::distance(fs::directory_iterator(temp.path()), fs::directory_iterator()), 1);
}

TEST(OutputFolderTest, BegunFileIsPutInPlaceOrRemoved) {
  const test::TempFolder temp;
  {
    OutputFolder folder(temp.path());
    std::ofstream(folder.Begin("film.mp4")) << "film";
    EXPECT_FALSE(fs::exists(temp.path() / "film.mp4"));
    folder.Replace({{"film.mp4", std::nullopt}, {"x.json", "one"}}, {"film.mp4", "x.json"});
    EXPECT_EQ(Read(temp.path() / "film.mp4"), "film");
    std::ofstream(folder.Begin("film.mp4")) << "half a fil";
  }
  EXPECT_EQ(Read(temp.path() / "film.mp4"), "film");
  EXPECT_EQ(std::distance(fs::directory_iterator(temp.path()), fs::directory_iterator()), 2);
}

// A begun file that is missing at the end cannot be put in place; the error names it.
TEST(OutputFolderTest, MissingOrUnwritableFileIsNamed) {
  const test::TempFolder temp;
  const OutputFolder folder(temp.path());
  const auto refusal = [&folder](const std::vector<OutputFile>& files) -> std::string {
    try {
      folder.Replace(files, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({{"film.mp4", std::nullopt}}),
              testing::HasSubstr("film.mp4: cannot be written: No such file"));
  fs::create_directory(temp.path() / ".x.json.partial");  // the write fails, as on a full disk
  EXPECT_THAT(refusal({{"y.json", "one"}, {"x.json", "one"}}),
              testing::HasSubstr("x.json: cannot be written"));
  EXPECT_FALSE(fs::exists(temp.path() / "y.json")) << "all files or none";
}

TEST(OutputFolderTest, ImpossibleFolderIsRefusedAtOnce) {
  const test::TempFolder temp;
  std::ofstream(temp.path() / "file") << "x";
  EXPECT_THROW(OutputFolder(temp.path() / "file"), InputError);
  EXPECT_THROW(OutputFolder(temp.path() / "file" / "below"), InputError);
}

// A second run is refused, and the first one's files stay complete.
TEST(OutputFolderTest, IsHeldByOneRunAtATime) {
  const test::TempFolder temp;
  {
    OutputFolder first(temp.path());
    std::ofstream(first.Begin("log.mcap")) << "the first one's";
    std::string refusal;
    try {
      const OutputFolder second(temp.path());
    } catch (const InputError& error) {
      refusal = error.what();
    }
    EXPECT_THAT(refusal, testing::AllOf(testing::HasSubstr("--out " + temp.path().string()),
                                        testing::HasSubstr("another run writes there")));
    first.Replace({{"log.mcap", std::nullopt}}, {"log.mcap"});
    EXPECT_EQ(Read(temp.path() / "log.mcap"), "the first one's");
  }
  EXPECT_NO_THROW(OutputFolder(temp.path())) << "the folder is released";
}

// A killed process releases the folder.
TEST(OutputFolderTest, IsFreeWhenItsHolderIsKilled) {
  const test::TempFolder temp;
  int holds[2];
  ASSERT_EQ(pipe(holds), 0);
  const pid_t child = fork();
  if (child == 0) {
    const OutputFolder folder(temp.path());
    const bool said = write(holds[1], "x", 1) == 1;
    pause();
    _exit(said ? 0 : 1);
  }
  char word = 0;
  ASSERT_EQ(read(holds[0], &word, 1), 1);
  EXPECT_THROW(OutputFolder(temp.path()), InputError);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(OutputFolder(temp.path()));
  close(holds[0]);
  close(holds[1]);
}

// No file of an earlier run stays beside the kept one.
TEST(OutputFolderTest, KeepLeavesOnlyTheBegunFile) {
  const test::TempFolder temp;
  {
    OutputFolder folder(temp.path());
    folder.Replace({{"log.mcap", "of before"}, {"x.json", "of before"}}, {});
    std::ofstream(folder.Begin("log.mcap")) << "half a lo";
    EXPECT_EQ(folder.Keep("log.mcap", {"log.mcap", "x.json"}), temp.path() / "log.mcap");
  }
  EXPECT_EQ(Read(temp.path() / "log.mcap"), "half a lo");
  EXPECT_EQ(std::distance(fs::directory_iterator(temp.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace fovea::config
