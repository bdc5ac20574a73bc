// SPDX-License-Identifier: Apache-2.0
// The feed as a tap on a log: viewers get the very bytes that the log writes.
#include "firmware/host/live/live_feed.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "tests/host/live/live_server.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

std::string FromBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char digit : text.substr(0, text.find('='))) {
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(digit));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(bits >> count & 0xFFU));
    }
  }
  return bytes;
}

TEST(LogChannels, SchemasAreThoseOfTheMessages) {
  const std::vector<Channel> channels = LogChannels({.truth = true, .theory = true});
  EXPECT_EQ(channels.size(), 13U);
  for (const Channel& channel : channels) {
    google::protobuf::FileDescriptorSet set;
    ASSERT_TRUE(set.ParseFromString(FromBase64(channel.schema))) << channel.topic;
    google::protobuf::DescriptorPool pool;
    for (const auto& file : set.file()) {
      ASSERT_NE(pool.BuildFile(file), nullptr) << channel.topic << ": each file follows what it imports";
    }
    EXPECT_NE(pool.FindMessageTypeByName(channel.schema_name), nullptr) << channel.topic;
    EXPECT_EQ(channel.encoding, "protobuf");
    EXPECT_EQ(channel.schema_encoding, "protobuf");
  }
  EXPECT_EQ(LogChannels({.camera = false, .configuration = false}).size(), 7U);
}

class LiveFeedTest : public LiveServerTest {};

TEST_F(LiveFeedTest, ViewersGetTheBytesOfTheLog) {
  Catalogue catalogue;
  catalogue.channels = LogChannels({.truth = true});
  server_ = std::make_unique<Server>(config_, catalogue);
  LiveFeed feed(*server_, catalogue.channels);
  const auto channel_of = [&](std::string_view topic) {
    return static_cast<std::size_t>(std::find_if(catalogue.channels.begin(), catalogue.channels.end(),
                                                 [&](const Channel& c) { return c.topic == topic; }) -
                                    catalogue.channels.begin());
  };
  test::LiveClient viewer(Port());
  ASSERT_EQ(viewer.Open(kTarget).status, 101);
  const std::vector<std::string> topics{log::kTickTopic, log::kEventTopic, log::kTransformTopic,
                                        log::kImageTopic};
  for (const std::string& topic : topics) {
    Subscribe(viewer, channel_of(topic));
  }

  log::RunLogConfig config;
  config.path = folder_.path() / "log.mcap";
  config.arm.num_joints = 1;
  config.frames = {{"root", -1, {}}};
  config.tap = [&feed](std::string_view topic, const google::protobuf::Descriptor& type, std::int64_t time_ns,
                       std::string_view bytes) { feed.Take(topic, type, time_ns, bytes); };
  log::RunLog log(config);
  const std::vector<std::uint8_t> pixels(64 * 48, 90);
  hal::Frame frame;
  frame.width_px = frame.stride_bytes = 64;
  frame.height_px = 48;
  frame.format = hal::PixelFormat::kMono8;
  frame.pixels = pixels;
  log.AddImage(frame);
  log.Add(log::kSetupTopic, 0, log::Setup());
  for (int tick = 0; tick < 50; ++tick) {
    hal::TickRecord record;
    record.tick = static_cast<std::uint64_t>(tick);
    record.stamp_ns = tick * hal::kTickPeriodNs;
    record.arm.num_joints = record.command.num_joints = 1;
    record.mode = tick < 25 ? hal::Mode::kBoot : hal::Mode::kHold;
    log.AddTick(record);
  }
  log.Finish();

  std::map<std::string, std::vector<std::string>> written;
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& m) { written[std::string(m.topic)].emplace_back(m.data); };
  EXPECT_TRUE(log::ReadMcap(config.path, visitor).complete);
  ASSERT_EQ(written[log::kTickTopic].size(), 50U);

  // Subscribed only now, and latched.
  Subscribe(viewer, channel_of(log::kSetupTopic));
  std::map<std::string, std::vector<std::string>> shown;
  do {
    const json message = viewer.Await("binary", 1);
    ASSERT_NE(message, nullptr);
    const std::size_t channel = message["subscription"].get<std::size_t>() - 100;
    shown[catalogue.channels[channel].topic].push_back(message["payload"].get<std::string>());
  } while (shown[log::kTickTopic].empty() ||
           shown[log::kTickTopic].back() != written[log::kTickTopic].back() ||
           shown[log::kSetupTopic].empty());
  for (const std::string& topic : topics) {
    if (topic != log::kTickTopic) {
      EXPECT_EQ(shown[topic], written[topic]) << topic;
    }
  }
  EXPECT_EQ(shown[log::kEventTopic].size(), 2U);
  EXPECT_EQ(shown[log::kImageTopic].size(), 1U);
  EXPECT_LT(shown[log::kTickTopic].size(), 50U) << "ticks are thinned";
  EXPECT_EQ(viewer.Await("stamp", 49 * hal::kTickPeriodNs)["binary"], 2) << "the ticks set the time";
}

TEST_F(LiveFeedTest, OtherTopicsAndTypesAreLeftOut) {
  Catalogue catalogue;
  catalogue.channels = {MessageChannel("/own", *log::Setup::descriptor(), Weight::kEssential, true)};
  server_ = std::make_unique<Server>(config_, catalogue);
  LiveFeed feed(*server_, catalogue.channels);
  feed.Take("/servo/keyframe", *log::Keyframe::descriptor(), 1, "a");
  feed.Take("/own", *log::Tick::descriptor(), 2, "b");
  feed.Take("/own", *log::Setup::descriptor(), 3, "c");
  test::LiveClient viewer(Port());
  ASSERT_EQ(viewer.Open(kTarget).status, 101);
  Subscribe(viewer, 0);
  EXPECT_EQ(viewer.Await("binary", 1)["payload"], "c");
}

}  // namespace
}  // namespace fovea::live
