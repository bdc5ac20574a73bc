// SPDX-License-Identifier: Apache-2.0
// Feeds a live page from a run's records and frames: the messages of its log, by the same encoders.
//
// Ticks arrive at 1 kHz and no viewer needs them all. A tick is sent when 10 ms of wall time have passed
// since the last one, when mode, fault or hold reason changes, or when it took a measurement. So a run in
// slow motion shows each tick. Features and events are all sent; /tf with each sent tick, at most at 50 Hz.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "firmware/host/live/server.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/tick_writer.hpp"
#include "firmware/host/run/run_book.hpp"

namespace google::protobuf {
class Descriptor;
class Message;
}  // namespace google::protobuf

namespace fovea::live {

// A protobuf channel beside those of every run.
struct MessageChannel {
  std::string topic;
  const google::protobuf::Descriptor* type = nullptr;
  Weight weight = Weight::kEssential;
  bool latched = false;
};

// The channels of a run with these facts: /servo/..., /setup, /tf, /scene, and /camera/... where it has a
// camera; then `more`, e.g. /truth of a simulated run. For Catalogue::channels.
std::vector<Channel> ChannelsOf(const run::RunFacts& facts, const std::vector<MessageChannel>& more);

class LiveFeed {
 public:
  // Borrows the server, whose catalogue begins with ChannelsOf(facts, more). Ends its thread when destroyed.
  LiveFeed(Server& server, const run::RunFacts& facts, const std::vector<Channel>& channels);
  ~LiveFeed();
  LiveFeed(const LiveFeed&) = delete;
  LiveFeed& operator=(const LiveFeed&) = delete;

  // Call before the run's threads start: takes the pictures that this log encodes, so that none is encoded
  // twice.
  void ShareEncoder(log::RunLog& log);

  // The next three from one thread, the one that takes the records, in order.
  // The messages that a log has once; at the start, and after a reset.
  void Begin(std::int64_t start_ns);
  void AddRecord(const flight::FlightRecord& record);
  // Sends the last record if it was not sent: when the run pauses, or has stepped.
  void ShowLast();

  // From the vision thread. `encoded`: the log encodes this picture (RunBook::AddFrame says so), and
  // ShareEncoder was called.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                const foxglove::ImageAnnotations& more, bool encoded);
  // From any thread that is not real-time, for all other topics. Plots: at most 100 a second of wall time.
  void Add(const std::string& topic, std::int64_t time_ns, const google::protobuf::Message& message);

 private:
  class Sink;
  class Encoder;
  std::unique_ptr<Sink> sink_;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace fovea::live
