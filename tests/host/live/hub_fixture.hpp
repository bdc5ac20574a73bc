// SPDX-License-Identifier: Apache-2.0
// A hub with viewers, without sockets: what they say, and what waits for them.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/host/live/hub.hpp"
#include "tests/host/live/live_messages.hpp"

namespace fovea::live {

inline Catalogue Everything() {
  Catalogue catalogue;
  catalogue.name = "test";
  catalogue.channels = {{"/plot", "A", "schema", Weight::kPlot},
                        {"/once", "B", "schema", Weight::kEssential, true},
                        {"/picture", "C", "schema", Weight::kPicture},
                        {"/fast", "D", "schema", Weight::kPlot, false, 100.0}};
  catalogue.parameters = {{"servo.lambda", "1/s", "decay", 0.1, 10.0, 2.0, 2.0}};
  catalogue.tune = true;
  catalogue.services = {Service::kHold, Service::kTrack, Service::kSave};
  catalogue.target = true;
  return catalogue;
}

class HubTest : public testing::Test {
 protected:
  void Text(std::uint64_t viewer, const nlohmann::json& message) {
    EXPECT_FALSE(hub_.Receive(viewer, true, message.dump(), now_).has_value());
  }
  void CallService(std::uint64_t viewer, Service service, const std::string& payload = "{}") {
    const std::string bytes = test::BinaryServiceCall(1 + static_cast<std::uint32_t>(service), 77, payload);
    EXPECT_FALSE(hub_.Receive(viewer, false, bytes, now_).has_value());
  }
  void Subscribe(std::uint64_t viewer, std::uint32_t id, std::uint32_t channel) {
    Text(viewer, {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}});
  }
  // All that waits for the viewer: texts as JSON, binary messages as {"binary": op, ...}.
  std::vector<nlohmann::json> TakeAll(std::uint64_t viewer) {
    std::vector<nlohmann::json> messages;
    while (const auto out = hub_.Next(viewer)) {
      messages.push_back(test::Readable(out->is_text, out->head + (out->payload ? *out->payload : "")));
    }
    return messages;
  }
  // The messages with that value in that field.
  std::vector<nlohmann::json> Take(std::uint64_t viewer, const char* field, const nlohmann::json& value) {
    std::vector<nlohmann::json> wanted;
    for (const nlohmann::json& message : TakeAll(viewer)) {
      if (message.value(field, nlohmann::json()) == value) {
        wanted.push_back(message);
      }
    }
    return wanted;
  }
  // A viewer whose first messages were read.
  std::uint64_t Join() {
    const std::uint64_t viewer = hub_.Join();
    TakeAll(viewer);
    return viewer;
  }
  // The run: answers all calls with this answer, and returns the requests.
  std::vector<Request> AnswerCalls(const Answer& answer = {}) {
    std::vector<Request> requests;
    for (const PendingCall& pending : calls_.TakeAll()) {
      requests.push_back(pending.call.request);
      calls_.AddAnswer({pending.from, pending.call.request, answer});
    }
    hub_.SendAnswers();
    return requests;
  }
  void Pulse(std::chrono::milliseconds later) {
    now_ += later;
    hub_.Pulse(5, now_);
  }

  Limits limits_;
  CallQueue calls_{8};
  Clock::time_point now_ = Clock::now();
  Hub hub_{limits_, Everything(), calls_};
};

}  // namespace fovea::live
