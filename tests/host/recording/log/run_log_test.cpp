// SPDX-License-Identifier: Apache-2.0
// The log of a run: every loss is counted, and a slow or full disk blocks no thread.
#include "firmware/host/recording/log/run_log.hpp"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <atomic>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <map>
#include <thread>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/tick.pb.h"
#include "foxglove/geometry.pb.h"
#include "foxglove/log.pb.h"
#include "tests/support/temp_folder.hpp"

namespace fovea::log {
namespace {

namespace fs = std::filesystem;

RunLogConfig OneJoint(const fs::path& path) {
  RunLogConfig config;
  config.path = path;
  config.library = "test";
  config.arm.num_joints = 1;
  config.arm.joints[0].X_PJ.p = {0.0, 0.0, 1.0};
  config.frames = {{"root", -1, {}}, {"arm", 0, {model::Mat3::Identity(), {0.5, 0.0, 0.0}}}};
  return config;
}

hal::TickRecord RecordAt(std::uint64_t tick) {
  hal::TickRecord record;
  record.tick = tick;
  record.stamp_ns = static_cast<std::int64_t>(tick) * hal::kTickPeriodNs;
  record.arm.num_joints = record.command.num_joints = 1;
  record.arm.q[0] = 1e-3 * static_cast<double>(tick);
  return record;
}

class RunLogTest : public testing::Test {
 protected:
  template <typename Message>
  std::vector<Message> Messages(const char* topic) const {
    std::vector<Message> messages;
    McapVisitor visitor;
    visitor.on_message = [&](const McapMessage& m) {
      if (m.topic == topic) {
        messages.emplace_back();
        EXPECT_TRUE(messages.back().ParseFromArray(m.data.data(), static_cast<int>(m.data.size())));
      }
    };
    ReadMcap(path_, visitor);
    return messages;
  }

  const test::TempFolder folder_;
  const fs::path path_ = folder_.path() / "log.mcap";
};

TEST_F(RunLogTest, WithoutDroppingItWaitsAndLosesNothing) {
  constexpr std::uint64_t kTicks = 20'000;  // ten times the ring's size
  RunLog log(OneJoint(path_));
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    log.AddTick(RecordAt(i));
    log.AddTruth({static_cast<std::int64_t>(i) * hal::kTickPeriodNs, {}, {}, 1.0, 2.0});
  }
  log.Finish();
  EXPECT_EQ(log.dropped(), 0U);
  const auto ticks = Messages<Tick>(kTickTopic);
  ASSERT_EQ(ticks.size(), kTicks);
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    ASSERT_EQ(ticks[i].tick(), i);
  }
}

// If dropping is allowed, written and dropped ticks add up, and the servo never waits.
TEST_F(RunLogTest, DroppedTicksAreCounted) {
  constexpr std::uint64_t kTicks = 200'000;
  RunLogConfig config = OneJoint(path_);
  config.may_drop = true;
  RunLog log(config);
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    log.AddTick(RecordAt(i));
  }
  log.Finish();
  const auto ticks = Messages<Tick>(kTickTopic);
  EXPECT_GT(log.dropped(), 0U) << "ticks come a hundred times faster than the disk writes";
  EXPECT_EQ(ticks.size() + log.dropped(), kTicks);
}

TEST_F(RunLogTest, WritesModesAndFaultsInWords) {
  RunLog log(OneJoint(path_));
  hal::TickRecord record = RecordAt(0);
  log.AddTick(record);
  record = RecordAt(1);
  record.mode = hal::Mode::kHold;
  record.hold_reason = hal::HoldReason::kNoTarget;
  log.AddTick(record);
  record.tick = 2;
  log.AddTick(record);
  record.mode = hal::Mode::kFault;
  record.hold_reason = hal::HoldReason::kNone;
  record.fault = hal::Fault::kJointVelocity;
  record.fault_joint = 0;
  log.AddTick(record);
  log.Finish();
  std::vector<std::string> words;
  for (const foxglove::Log& line : Messages<foxglove::Log>(kEventTopic)) {
    words.push_back(line.message());
  }
  ASSERT_EQ(words.size(), 3U);
  EXPECT_EQ(words[0], "mode: boot");
  EXPECT_EQ(words[1], "mode: hold, no_target");
  EXPECT_EQ(words[2].rfind("fault: joint_velocity, joint 1", 0), 0U) << words[2];
}

TEST_F(RunLogTest, WritesTheFrameTransforms) {
  RunLog log(OneJoint(path_));
  hal::TickRecord record = RecordAt(0);
  record.arm.q[0] = 1.5707963267948966;
  log.AddTick(record);
  log.Finish();
  const auto transforms = Messages<foxglove::FrameTransforms>(kTransformTopic);
  ASSERT_EQ(transforms.size(), 1U);
  ASSERT_EQ(transforms[0].transforms_size(), 2) << "no transform of an unknown target";
  const foxglove::FrameTransform& arm = transforms[0].transforms(1);
  EXPECT_EQ(arm.child_frame_id(), "arm");
  EXPECT_EQ(arm.parent_frame_id(), kBaseFrame);
  EXPECT_NEAR(arm.translation().x(), 0.0, 1e-12);
  EXPECT_NEAR(arm.translation().y(), 0.5, 1e-12);
  EXPECT_NEAR(arm.translation().z(), 1.0, 1e-12);
  EXPECT_NEAR(arm.rotation().z(), 0.7071067811865476, 1e-12);
}

// An added tick reaches the file soon, even if nothing follows and Finish is not called.
TEST_F(RunLogTest, AddedTicksReachTheFileSoon) {
  RunLog log(OneJoint(path_));
  std::size_t added = 0;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 10; ++i) {
      log.AddTick(RecordAt(added++));
    }
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (Messages<Tick>(kTickTopic).size() < added) {
      ASSERT_LT(std::chrono::steady_clock::now(), deadline);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

// Finish reports a log that could not be written. Until then the log accepts all data and blocks no thread.
TEST_F(RunLogTest, FullDiskBlocksNobodyAndFinishThrows) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  RunLog log(OneJoint("/dev/full"));
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    log.AddTick(RecordAt(i));
  }
  for (int i = 0; i < 100; ++i) {
    log.AddAttachment("a", "text/plain", std::string(100'000, 'x'));
  }
  EXPECT_THROW(log.Finish(), std::runtime_error);
  EXPECT_TRUE(log.failed());
}

// So little data that only the last write, in Finish, meets the full disk.
TEST_F(RunLogTest, FailureOfTheLastWriteIsAFailureOfTheLog) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  RunLog log(OneJoint("/dev/full"));
  log.AddTick(RecordAt(0));
  EXPECT_THROW(log.Finish(), std::runtime_error);
  EXPECT_TRUE(log.failed());
}

// Data that was pending at the failure is counted, like all later data.
TEST_F(RunLogTest, FullDiskCountsEveryLostAttachment) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  constexpr int kAttachments = 50;
  RunLog log(OneJoint("/dev/full"));
  for (int i = 0; i < kAttachments; ++i) {
    log.AddAttachment("a", "text/plain", std::string(100'000, 'x'));
  }
  EXPECT_THROW(log.Finish(), std::runtime_error);
  EXPECT_EQ(log.dropped(), static_cast<std::uint64_t>(kAttachments));
}

// Ticks that stay in their ring after the failure are counted too.
TEST_F(RunLogTest, TicksAfterAFullDiskAreCounted) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  constexpr std::uint64_t kTicks = 100;
  RunLog log(OneJoint("/dev/full"));
  std::uint64_t added = 0;
  while (!log.failed()) {
    log.AddAttachment("a", "text/plain", std::string(100'000, 'x'));
    ++added;
  }
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    log.AddTick(RecordAt(i));
  }
  EXPECT_THROW(log.Finish(), std::runtime_error);
  std::cout << added << " attachments and " << kTicks << " ticks\n";
  EXPECT_EQ(log.dropped(), added + kTicks);
}

// Who watches the run goes on to see it.
TEST_F(RunLogTest, TapGetsTicksAfterAFullDisk) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "this system has no /dev/full";
  }
  RunLogConfig config = OneJoint("/dev/full");
  std::atomic<int> ticks{0};
  config.tap = [&](std::string_view topic, const auto& /*type*/, std::int64_t /*time_ns*/,
                   std::string_view /*bytes*/) { ticks += topic == kTickTopic ? 1 : 0; };
  RunLog log(config);
  while (!log.failed()) {
    log.AddAttachment("a", "text/plain", std::string(100'000, 'x'));
  }
  for (std::uint64_t i = 0; i < 10; ++i) {
    log.AddTick(RecordAt(i));
  }
  EXPECT_THROW(log.Finish(), std::runtime_error);
  EXPECT_EQ(ticks, 10);
}

// The disk becomes full during the run: the file is readable up to there, and every tick is written or
// counted, except for those of the last second before.
TEST_F(RunLogTest, FullDiskKeepsTheLogReadableUpToThere) {
  constexpr std::uint64_t kTicks = 60'000;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 1'000'000;  // bytes: beyond it a write fails as on a full disk
  setrlimit(RLIMIT_FSIZE, &small);
  RunLog log(OneJoint(path_));
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    log.AddTick(RecordAt(i));
  }
  EXPECT_THROW(log.Finish(), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(log.failed());
  EXPECT_LE(fs::file_size(path_), 1'000'000U);
  const auto ticks = Messages<Tick>(kTickTopic);
  std::cout << ticks.size() << " ticks written, " << log.dropped() << " counted\n";
  ASSERT_GT(ticks.size(), 1000U);
  for (std::uint64_t i = 0; i < ticks.size(); ++i) {
    ASSERT_EQ(ticks[i].tick(), i);
  }
  EXPECT_GT(log.dropped(), 0U);
  EXPECT_LE(ticks.size() + log.dropped(), kTicks);
}

TEST_F(RunLogTest, FileIsAttachedByteExactOrRefused) {
  const std::string bytes("\0\r\n\xff film", 9);
  std::ofstream(folder_.path() / "film", std::ios::binary) << bytes;
  RunLog log(OneJoint(path_));
  log.AddFile("camera.mp4", "video/mp4", folder_.path() / "film");
  EXPECT_THROW(log.AddFile("other.mp4", "video/mp4", folder_.path() / "nothing"), std::runtime_error);
  log.Finish();
  int attachments = 0;
  McapVisitor visitor;
  visitor.on_attachment = [&](const McapAttachment& a) {
    ++attachments;
    EXPECT_EQ(a.name, "camera.mp4");
    EXPECT_EQ(a.media_type, "video/mp4");
    EXPECT_EQ(a.data, bytes);
  };
  ReadMcap(path_, visitor);
  EXPECT_EQ(attachments, 1);
}

TEST_F(RunLogTest, UncreatableFileIsRefusedAtOnce) {
  EXPECT_THROW(RunLog(OneJoint("/nowhere/log.mcap")), std::runtime_error);
}

}  // namespace
}  // namespace fovea::log
