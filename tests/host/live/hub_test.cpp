// SPDX-License-Identifier: Apache-2.0
// The protocol without sockets: channels, parameters, services, control, and what a slow viewer loses.
#include "firmware/host/live/hub.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/host/live/server_messages.hpp"
#include "tests/host/live/hub_fixture.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

TEST_F(HubTest, ConnectionBeginsWithWhatIsOffered) {
  const std::uint64_t viewer = hub_.Join();
  const std::vector<json> first = TakeAll(viewer);
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(first[0]["op"], "serverInfo");
  EXPECT_EQ(first[0]["name"], "fovea: test");
  EXPECT_EQ(first[0]["capabilities"],
            json({"time", "parameters", "parametersSubscribe", "services", "clientPublish"}));
  EXPECT_EQ(first[0]["supportedEncodings"], json::array({"json"}));
  EXPECT_EQ(first[1]["op"], "advertise");
  ASSERT_EQ(first[1]["channels"].size(), 6U);
  EXPECT_EQ(first[1]["channels"][0]["id"], 1);
  EXPECT_EQ(first[1]["channels"][0]["schemaEncoding"], "protobuf");
  EXPECT_EQ(first[1]["channels"][4]["topic"], "/live/state");
  EXPECT_EQ(first[1]["channels"][4]["encoding"], "json");
  EXPECT_EQ(first[2]["op"], "advertiseServices");
  EXPECT_EQ(first[2]["services"].size(), 5U);  // and the two of control
  EXPECT_EQ(first[2]["services"][0]["name"], "/servo/hold");
}

TEST_F(HubTest, OnlySubscribersGetMessages) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  EXPECT_FALSE(hub_.IsWanted(0));
  Subscribe(one, 9, 1);
  EXPECT_TRUE(hub_.IsWanted(0));
  hub_.Distribute(0, 1234, "payload", now_);
  const auto got = TakeAll(one);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0], (json{{"binary", 1}, {"subscription", 9}, {"stamp", 1234}, {"payload", "payload"}}));
  EXPECT_TRUE(TakeAll(two).empty());
  Text(one, {{"op", "unsubscribe"}, {"subscriptionIds", {9, 10}}});
  EXPECT_FALSE(hub_.IsWanted(0));
  Subscribe(one, 9, 1);
  hub_.Leave(one);
  EXPECT_FALSE(hub_.IsWanted(0));
}

TEST_F(HubTest, LatchedMessagesComeAtOnceAndWhenSubscribedLater) {
  hub_.Distribute(1, 5, "first", now_);
  hub_.Distribute(1, 6, "last", now_);
  const std::uint64_t viewer = Join();
  Subscribe(viewer, 1, 2);
  Subscribe(viewer, 2, 1);  // not latched
  const auto got = TakeAll(viewer);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0]["payload"], "last");
  EXPECT_EQ(got[0]["stamp"], 6);
}

TEST_F(HubTest, FastChannelIsThinnedAndShowsItsLastMessage) {
  const std::uint64_t viewer = Join();
  Subscribe(viewer, 1, 4);
  for (int i = 0; i < 25; ++i) {
    hub_.Distribute(3, i, std::to_string(i), now_ + i * 1ms);
  }
  std::vector<std::string> sent;
  for (const json& message : TakeAll(viewer)) {
    sent.push_back(message["payload"].get<std::string>());
  }
  EXPECT_THAT(sent, testing::ElementsAre("0", "10", "20"));
  hub_.Pulse(0, now_ + 30ms);
  EXPECT_TRUE(Take(viewer, "binary", 1).empty()) << "nothing newer may come within 20 ms";
  hub_.Pulse(0, now_ + 50ms);
  const auto last = Take(viewer, "binary", 1);
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0]["payload"], "24");
  hub_.Pulse(0, now_ + 100ms);
  EXPECT_TRUE(Take(viewer, "binary", 1).empty());
}

TEST_F(HubTest, WrongSubscriptionsAreNamed) {
  const std::uint64_t viewer = Join();
  Subscribe(viewer, 1, 0);
  Subscribe(viewer, 1, 7);
  Subscribe(viewer, 1, 1);
  Subscribe(viewer, 1, 2);
  const auto said = Take(viewer, "op", "status");
  ASSERT_EQ(said.size(), 3U);
  EXPECT_EQ(said[0]["message"], "there is no channel 0");
  EXPECT_EQ(said[1]["message"], "there is no channel 7");
  EXPECT_EQ(said[2]["message"], "the subscription 1 exists already");
  EXPECT_EQ(said[2]["level"], 2);
}

TEST_F(HubTest, StateShowsTheViewersOwnPart) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  Subscribe(one, 1, 5);
  Subscribe(two, 1, 5);
  EXPECT_TRUE(TakeAll(one).empty()) << "there is no state yet";
  State state;
  state.mode = "track";
  state.target = TargetState{{0.5, 0.0, 0.1}, {1.0, 0.0, 0.0, 0.0}, false};
  hub_.SetState(state);
  CallService(one, Service::kTakeControl, R"({"name":"Ada"})");
  json seen = json::parse(std::string(Take(one, "binary", 1).back()["payload"]));
  EXPECT_EQ(seen["mode"], "track");
  EXPECT_EQ(seen["controller"], "Ada");
  EXPECT_EQ(seen["you"], true);
  EXPECT_EQ(seen["viewers"], 2);
  EXPECT_EQ(seen["target"]["p_BO"], json({0.5, 0.0, 0.1}));
  EXPECT_EQ(seen["pull"], nullptr);
  EXPECT_EQ(seen["may"]["track"], true);
  EXPECT_EQ(seen["may"]["pause"], false);
  EXPECT_EQ(seen["dropped"], (json{{"pictures", 0}, {"plots", 0}}));
  seen = json::parse(std::string(Take(two, "binary", 1).back()["payload"]));
  EXPECT_EQ(seen["you"], false);
  EXPECT_EQ(seen["controller"], "Ada");
}

TEST(LiveState, ShowsTheFaultsWithTheirSizes) {
  Catalogue catalogue;
  catalogue.faults = {{"nan",
                       "an encoder fails",
                       {{"nan_joint", "which joint", "", 1.0, 7.0, 1.0, true},
                        {"nan_share", "how often", "", 0.0, 1.0, 0.5}}}};
  State state;
  state.faults = {{true, {3.0, 0.25}}};
  const json fault = json::parse(StateJson(state, catalogue) + "}")["faults"][0];
  EXPECT_EQ(fault["active"], true);
  EXPECT_EQ(fault["settings"][0], (json{{"name", "nan_joint"},
                                        {"words", "which joint"},
                                        {"unit", ""},
                                        {"min", 1.0},
                                        {"max", 7.0},
                                        {"whole", true},
                                        {"value", 3.0}}));
  EXPECT_EQ(fault["settings"][1]["whole"], false);
  EXPECT_EQ(fault["settings"][1]["value"], 0.25);
}

TEST(LiveState, ShowsWhatIsFoundOutAndWhatIsUnknown) {
  State state;
  state.findings = {{"latency", "camera.latency_ms", "ms", 40.0, true, 18.0, 0.4},
                    {"focal length", "camera.f_u_px", "%", std::nullopt, false, 3.0, 20.0}};
  const json findings = json::parse(StateJson(state, Catalogue{}) + "}")["findings"];
  EXPECT_EQ(findings[0], (json{{"name", "latency"},
                               {"key", "camera.latency_ms"},
                               {"unit", "ms"},
                               {"configured", 40.0},
                               {"known", true},
                               {"difference", 18.0},
                               {"sigma", 0.4}}));
  EXPECT_EQ(findings[1]["known"], false);
  EXPECT_EQ(findings[1]["configured"], nullptr);
  EXPECT_EQ(findings[1]["difference"], nullptr) << "no number of what is unknown";
  EXPECT_EQ(findings[1]["sigma"], nullptr);
}

TEST_F(HubTest, StateComesAtOnceForEventsElseAtTenHertz) {
  const std::uint64_t viewer = Join();
  State state;
  hub_.SetState(state);
  Pulse(0ms);
  Subscribe(viewer, 1, 5);
  EXPECT_EQ(Take(viewer, "binary", 1).size(), 1U);
  state.stamp_s = 1.0;
  hub_.SetState(state);
  EXPECT_TRUE(Take(viewer, "binary", 1).empty());
  state.mode = "fault";
  hub_.SetState(state);
  EXPECT_EQ(Take(viewer, "binary", 1).size(), 1U);
  std::size_t states = 0;
  for (int i = 0; i < 20; ++i) {
    Pulse(50ms);
    states += Take(viewer, "binary", 1).size();
  }
  EXPECT_EQ(states, 10U);
}

TEST_F(HubTest, FloodOfMessagesEndsTheConnection) {
  const std::uint64_t viewer = Join();
  int taken = 0;
  std::optional<Closing> closing;
  for (; !closing && taken < 1000; ++taken) {
    closing = hub_.Receive(viewer, true, "garbage", now_);
  }
  ASSERT_TRUE(closing.has_value());
  EXPECT_EQ(taken, 401);
  EXPECT_EQ(closing->code, 1008U);
  EXPECT_EQ(closing->reason, "more than 200 messages a second");
  EXPECT_LE(Take(viewer, "op", "status").size(), 20U) << "complaints are few";
}

TEST_F(HubTest, SlowViewerLosesPicturesAndIsTold) {
  const std::uint64_t viewer = Join();
  Subscribe(viewer, 1, 3);
  for (int i = 0; i < 10; ++i) {
    hub_.Distribute(2, i, "picture", now_);
  }
  Pulse(50ms);
  const auto all = TakeAll(viewer);
  EXPECT_EQ(all.size(), 3U);
  EXPECT_EQ(all.at(2)["message"],
            "this viewer reads too slowly: 8 pictures and 0 plot points were left out so far");
  EXPECT_EQ(all.at(2)["level"], 1);
  EXPECT_EQ(hub_.dropped_pictures(), 8U);
  EXPECT_TRUE(hub_.TakeHopeless().empty());
}

TEST_F(HubTest, ViewerWithoutRoomForEssentialsIsHopeless) {
  const std::uint64_t viewer = Join();
  Subscribe(viewer, 1, 2);
  const std::string payload(limits_.essential_bytes / 4, 'x');
  for (int i = 0; i < 3; ++i) {
    hub_.Distribute(1, i, payload, now_);
  }
  EXPECT_TRUE(hub_.TakeHopeless().empty());
  hub_.Distribute(1, 4, payload, now_);
  EXPECT_THAT(hub_.TakeHopeless(), testing::ElementsAre(viewer));
}

TEST_F(HubTest, TimeGoesToViewersThatKeepUp) {
  const std::uint64_t viewer = Join();
  Pulse(50ms);
  Pulse(50ms);
  const auto times = Take(viewer, "binary", 2);
  ASSERT_EQ(times.size(), 1U) << "the second one waits until the first is read";
  EXPECT_EQ(times[0]["stamp"], 5);
}

}  // namespace
}  // namespace fovea::live
