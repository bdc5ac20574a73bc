// SPDX-License-Identifier: Apache-2.0
// Feeds a live page from a run's log: every message as the log encodes it, with the log's topics and types.
//
// A run gives it to its log as a tap (RunBookOptions::tap). Viewers get ticks, truth and theory at 100 Hz of
// wall time at most, so that a run in slow motion shows each tick; /tf, events, features and pictures as the
// log writes them. Keyframes and the tick times are for replays and reports; viewers do not get them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/live/catalogue.hpp"

namespace google::protobuf {
class Descriptor;
}

namespace fovea::live {

class Server;

// A channel of protobuf messages.
Channel MessageChannel(std::string topic, const google::protobuf::Descriptor& type,
                       Weight weight = Weight::kEssential, bool latched = false, double most_hz = 0.0);

// What of a log depends on the kind of run.
struct LogContents {
  bool servo = true;          // /servo/..., /operator, and what the servo finds in the pictures
  bool camera = true;         // /camera/image, /camera/annotations, /camera/calibration
  bool truth = false;         // /truth: of a simulator
  bool theory = false;        // /theory: of an arm with an analytic solution
  bool configuration = true;  // /servo/configuration: of a servo whose run can be replayed
};
// The channels of the log of such a run, for Catalogue::channels. A program appends those of its own topics.
std::vector<Channel> LogChannels(const LogContents& contents);

// The tap. Any one thread calls it; it never waits.
class LiveFeed {
 public:
  // Borrows the server, whose catalogue has these channels.
  LiveFeed(Server& server, const std::vector<Channel>& channels);

  // A message of the log; see log::LogTap. Messages of other topics, or of another type than the channel's,
  // are left out. The stamps of ticks set the server's time.
  void Take(std::string_view topic, const google::protobuf::Descriptor& type, std::int64_t time_ns,
            std::string_view bytes);
  // Whether a viewer would get a message of this topic. From any thread; lock-free.
  [[nodiscard]] bool Wants(std::string_view topic) const;

 private:
  struct Place {
    std::size_t channel = 0;
    std::string type;
  };

  Server& server_;
  std::map<std::string, Place, std::less<>> places_;  // by topic
};

}  // namespace fovea::live
