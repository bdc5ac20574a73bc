// SPDX-License-Identifier: Apache-2.0
// The files that a run leaves in its folder, and the effect of a failed film.
#include "firmware/host/run/run_book.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::run {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

constexpr int kTicks = 200;
constexpr std::int64_t kStartNs = 5'000'000'000;

class RunBookTest : public testing::Test {
 protected:
  // Runs for 0.2 s with frames of that size and returns the log's figures.
  // Removes the file `removed` from the folder after the start.
  BookFigures Run(int width_px, int height_px, const std::string& removed = "") {
    RunBook files(folder_.path(), Facts(), options_);
    if (!removed.empty()) {
      EXPECT_TRUE(fs::remove(folder_.path() / removed));
    }
    const std::vector<std::uint8_t> pixels(
        static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), 90);
    for (int tick = 0; tick < kTicks; ++tick) {
      flight::FlightRecord entry;
      hal::TickRecord& record = entry.record;
      record.tick = static_cast<std::uint64_t>(tick);
      record.stamp_ns = kStartNs + tick * hal::kTickPeriodNs;
      record.arm.num_joints = record.command.num_joints = Facts().servo.arm.num_joints;
      files.AddRecord(entry);
      if (frame_ticks_.contains(tick)) {
        hal::Frame frame;
        frame.stamp_ns = record.stamp_ns;
        frame.width_px = width_px;
        frame.height_px = height_px;
        frame.stride_bytes = width_px;
        frame.format = hal::PixelFormat::kMono8;
        frame.pixels = pixels;
        files.AddFrame(frame, {});
      }
    }
    return End(files);
  }
  static BookFigures End(RunBook& book) {
    const BookFigures figures = book.EndFilm();
    RunFigures all;
    FillBook(figures, all);
    nlohmann::ordered_json summary;
    BeginSummary(summary);
    AddFigures(all, summary);
    book.Write(summary.dump(), {});
    return figures;
  }
  static RunFacts Facts() {
    RunFacts facts;
    facts.keys = {{"a.b", "1"}, {"a.c", "2"}, {"d.e", "3"}};
    facts.default_keys = {{"a.b", "1"}, {"a.c", "5"}, {"of.another", "6"}};
    facts.command = "fovea-sim run test";
    facts.name = "test";
    facts.servo = test::PandaConfig();
    facts.joint_names = test::Panda().joint_names;
    facts.intrinsics = {640, 480, 554.0, 554.0, 319.5, 239.5, {}};
    facts.target_radius = 0.04;
    return facts;
  }
  [[nodiscard]] std::set<std::string> Files() const {
    std::set<std::string> names;
    for (const fs::directory_entry& file : fs::directory_iterator(folder_.path())) {
      names.insert(file.path().filename());
    }
    return names;
  }
  // Checks that the log is complete, and its ticks and attachments.
  void ExpectLog(const std::vector<std::string>& attachments) const {
    int ticks = 0;
    std::vector<std::string> found;
    log::McapVisitor visitor;
    visitor.on_message = [&](const log::McapMessage& m) { ticks += m.topic == log::kTickTopic ? 1 : 0; };
    visitor.on_attachment = [&](const log::McapAttachment& a) {
      found.emplace_back(a.name);
      EXPECT_FALSE(a.data.empty()) << a.name;
    };
    EXPECT_TRUE(log::ReadMcap(folder_.path() / "log.mcap", visitor).complete);
    EXPECT_EQ(ticks, kTicks);
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(attachments));
  }

  const test::TempFolder folder_;
  std::set<int> frame_ticks_{10, 80, 150};
  RunBookOptions options_;
};

TEST_F(RunBookTest, RunWritesFilmLogReportAndSummary) {
  const BookFigures log = Run(640, 480);
  EXPECT_THAT(log.film_errors, testing::IsEmpty());
  EXPECT_EQ(log.pictures + log.pictures_dropped, 3U);
  EXPECT_THAT(Files(), ElementsAre("camera.mp4", "log.mcap", "report.html", "summary.json"));
  ExpectLog({"summary.json", "camera.mp4"});
}

TEST_F(RunBookTest, LogNamesCommandAndDefaultsThatDiffer) {
  Run(640, 480);
  std::map<std::string, std::map<std::string, std::string>> found;
  log::McapVisitor visitor;
  visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
    found[std::string(name)] = entries;
  };
  EXPECT_TRUE(log::ReadMcap(folder_.path() / "log.mcap", visitor).complete);
  EXPECT_EQ(found["run"]["command"], "fovea-sim run test");
  EXPECT_EQ(found["defaults"], (std::map<std::string, std::string>{{"a.c", "5"}}));
}

TEST_F(RunBookTest, TapGetsEveryMessageOfTheLog) {
  std::map<std::string, int> tapped;
  options_.tap = [&tapped](std::string_view topic, const google::protobuf::Descriptor& /*type*/,
                           std::int64_t /*time_ns*/, std::string_view bytes) {
    tapped[std::string(topic)] += static_cast<int>(bytes.size());
  };
  Run(640, 480);
  std::map<std::string, int> written;
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& m) {
    written[std::string(m.topic)] += static_cast<int>(m.data.size());
  };
  EXPECT_TRUE(log::ReadMcap(folder_.path() / "log.mcap", visitor).complete);
  EXPECT_GT(written.size(), 5U);
  EXPECT_EQ(tapped, written);
}

TEST_F(RunBookTest, FailedFilmKeepsTheOtherFiles) {
  const BookFigures log = Run(640, 480, ".camera.mp4.partial");
  EXPECT_THAT(log.film_errors,
              ElementsAre("camera.mp4: the film cannot be written: the index: No such file or directory"));
  EXPECT_THAT(Files(), ElementsAre("log.mcap", "report.html", "summary.json"));
  ExpectLog({"summary.json"});
  std::ifstream stream(folder_.path() / "summary.json");
  EXPECT_EQ(nlohmann::json::parse(stream)["film_errors"], log.film_errors);
}

// Ended before the first tick: the log is complete and holds the summary.
TEST_F(RunBookTest, RunWithoutATickWritesOnlyLogAndSummary) {
  {
    RunBook files(folder_.path(), Facts(), options_);
    End(files);
  }
  EXPECT_THAT(Files(), ElementsAre("log.mcap", "summary.json"));
  std::vector<std::string> found;
  log::McapVisitor visitor;
  visitor.on_attachment = [&](const log::McapAttachment& a) { found.emplace_back(a.name); };
  EXPECT_TRUE(log::ReadMcap(folder_.path() / "log.mcap", visitor).complete);
  EXPECT_THAT(found, ElementsAre("summary.json"));
}

// The film takes only frames of the calibrated size.
TEST_F(RunBookTest, RunWithoutAFrameWritesNoFilm) {
  const BookFigures log = Run(320, 240);
  EXPECT_THAT(log.film_errors, testing::IsEmpty());
  EXPECT_EQ(log.film_frames_dropped, 0U);
  EXPECT_THAT(Files(), ElementsAre("log.mcap", "report.html", "summary.json"));
  ExpectLog({"summary.json"});
}

// Never more pictures than the limit, neither at first nor after a gap: at 20 Hz those at 10, 130 and 180 ms.
TEST_F(RunBookTest, LogKeepsThePictureRateLimit) {
  options_.picture_rate_hz = 20.0;
  frame_ticks_ = {10, 20, 30, 40, 130, 140, 150, 160, 170, 180, 190};
  const BookFigures log = Run(640, 480);
  EXPECT_EQ(log.pictures + log.pictures_dropped, 3U);
}

}  // namespace
}  // namespace fovea::run
