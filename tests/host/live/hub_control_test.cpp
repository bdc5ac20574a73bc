// SPDX-License-Identifier: Apache-2.0
// What viewers change: control, services, parameters, the target.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware/host/live/hub.hpp"
#include "tests/host/live/hub_fixture.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::BinaryServiceCall;
using testing::HasSubstr;

class HubControlTest : public HubTest {};

TEST_F(HubControlTest, FirstCallerGetsControlAndOthersAreRefused) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  CallService(one, Service::kTrack);
  CallService(two, Service::kTrack);
  const auto refused = Take(two, "op", "serviceCallFailure");
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0]["message"], "viewer 1 has control of the run");
  EXPECT_EQ(refused[0]["callId"], 77);
  EXPECT_EQ(AnswerCalls().size(), 1U);
  const auto answered = Take(one, "binary", 3);
  ASSERT_EQ(answered.size(), 1U);
  EXPECT_EQ(answered[0]["call"], 77);
  EXPECT_EQ(answered[0]["payload"], "{}");
  CallService(two, Service::kTakeControl);
  EXPECT_EQ(json::parse(std::string(Take(two, "binary", 3)[0]["payload"])),
            (json{{"granted", false}, {"controller", "viewer 1"}}));
}

TEST_F(HubControlTest, AnybodyMayStopTheArm) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  CallService(two, Service::kHold);
  CallService(one, Service::kTrack);  // the stop took no control
  CallService(two, Service::kHold);
  const auto requests = AnswerCalls();
  ASSERT_EQ(requests.size(), 3U);
  EXPECT_TRUE(std::holds_alternative<Hold>(requests[2]));
}

TEST_F(HubControlTest, ControlEndsWithTheConnectionOrBySilenceOrWhenGiven) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  const auto ended = [this] {
    const auto requests = AnswerCalls();
    return !requests.empty() && std::holds_alternative<ControlEnded>(requests.back());
  };
  CallService(one, Service::kTakeControl);
  Pulse(10'000ms);
  EXPECT_FALSE(ended());
  Pulse(50ms);
  EXPECT_TRUE(ended());
  EXPECT_THAT(std::string(Take(one, "op", "status").at(0)["message"]), HasSubstr("control ended"));
  CallService(two, Service::kTakeControl);
  Pulse(6s);
  Text(two, {{"op", "getParameters"}, {"parameterNames", json::array()}});
  Pulse(6s);
  EXPECT_FALSE(ended()) << "any message keeps control";
  CallService(two, Service::kGiveControl);
  EXPECT_TRUE(ended());
  CallService(one, Service::kTrack);
  hub_.Leave(one);
  EXPECT_TRUE(ended());
  CallService(two, Service::kTrack);
  EXPECT_EQ(AnswerCalls().size(), 1U);
}

TEST_F(HubControlTest, ServicesAreChecked) {
  const std::uint64_t viewer = Join();
  CallService(viewer, Service::kPause, R"({"paused":true})");  // not of this catalogue
  hub_.Receive(viewer, false, BinaryServiceCall(0, 1, "{}"), now_);
  hub_.Receive(viewer, false, BinaryServiceCall(2, 1, "{}", "protobuf"), now_);
  CallService(viewer, Service::kTrack, R"({"x":1})");
  const auto refused = Take(viewer, "op", "serviceCallFailure");
  ASSERT_EQ(refused.size(), 4U);
  EXPECT_EQ(refused[0]["message"], "this run offers no such service");
  EXPECT_EQ(refused[1]["message"], "this run offers no such service");
  EXPECT_EQ(refused[2]["message"], "only requests in JSON are taken");
  EXPECT_EQ(refused[3]["message"], "the field x is unknown");
  EXPECT_TRUE(AnswerCalls().empty());
  CallService(viewer, Service::kSave);
  AnswerCalls({"", R"({"name":"a.toml","toml":"x"})"});
  EXPECT_EQ(Take(viewer, "binary", 3)[0]["payload"], R"({"name":"a.toml","toml":"x"})");
  CallService(viewer, Service::kTrack);
  AnswerCalls({"the target was not seen yet", ""});
  EXPECT_EQ(Take(viewer, "op", "serviceCallFailure")[0]["message"], "the target was not seen yet");
}

TEST_F(HubControlTest, BusyRunRefusesMoreCalls) {
  const std::uint64_t viewer = Join();
  for (int i = 0; i < 9; ++i) {
    CallService(viewer, Service::kTrack);
  }
  const auto refused = Take(viewer, "op", "serviceCallFailure");
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0]["message"], "the run is busy: too many requests wait");
  EXPECT_EQ(AnswerCalls().size(), 8U);
}

TEST_F(HubControlTest, ParametersChangeWithinTheirRange) {
  const std::uint64_t one = Join();
  const std::uint64_t two = Join();
  Text(two, {{"op", "subscribeParameterUpdates"}, {"parameterNames", {"servo.lambda"}}});
  Text(one,
       {{"op", "setParameters"}, {"parameters", {{{"name", "servo.lambda"}, {"value", 3}}}}, {"id", "s"}});
  EXPECT_TRUE(TakeAll(one).empty()) << "the run has not answered";
  ASSERT_EQ(AnswerCalls().size(), 1U);
  const json value = {{{"name", "servo.lambda"}, {"value", 3.0}, {"type", "float64"}}};
  const auto answered = Take(one, "op", "parameterValues");
  ASSERT_EQ(answered.size(), 1U);
  EXPECT_EQ(answered[0]["parameters"], value);
  EXPECT_EQ(answered[0]["id"], "s");
  EXPECT_EQ(Take(two, "op", "parameterValues").at(0)["parameters"], value);
  Subscribe(two, 1, 6);
  Pulse(50ms);
  const json all = json::parse(std::string(Take(two, "binary", 1).back()["payload"]));
  EXPECT_EQ(all[0], (json{{"name", "servo.lambda"},
                          {"unit", "1/s"},
                          {"meaning", "decay"},
                          {"min", 0.1},
                          {"max", 10.0},
                          {"value", 3.0},
                          {"default", 2.0}}));
}

TEST_F(HubControlTest, WrongParametersAreRefusedWithKeyValueAndRange) {
  const std::uint64_t viewer = Join();
  const auto why = [&](const json& parameter) {
    Text(viewer, {{"op", "setParameters"}, {"parameters", json::array({parameter})}});
    const auto all = TakeAll(viewer);
    EXPECT_EQ(all.size(), 2U);
    EXPECT_EQ(all.front()["level"], 2);
    EXPECT_EQ(all.back()["op"], "parameterValues");
    for (const json& value : all.back()["parameters"]) {
      EXPECT_EQ(value["value"], 2.0);
    }
    return std::string(all.front()["message"]);
  };
  EXPECT_EQ(why({{"name", "servo.lambda"}, {"value", 11}}),
            "servo.lambda must be a number from 0.1 to 10 1/s, got 11");
  EXPECT_EQ(why({{"name", "servo.lambda"}, {"value", "NaN"}}),
            "servo.lambda must be a number from 0.1 to 10 1/s, got no number");
  EXPECT_EQ(why({{"name", "servo.mu"}, {"value", 1}}),
            "there is no parameter servo.mu that may change in motion");
  EXPECT_TRUE(AnswerCalls().empty());
  // The run itself refuses one.
  Text(viewer, {{"op", "setParameters"}, {"parameters", {{{"name", "servo.lambda"}, {"value", 3}}}}});
  AnswerCalls({"servo.lambda cannot change now", ""});
  const auto all = TakeAll(viewer);
  EXPECT_EQ(all.at(0)["message"], "servo.lambda cannot change now");
  EXPECT_EQ(all.at(1)["parameters"][0]["value"], 2.0);
}

TEST_F(HubControlTest, TargetIsMovedByMessages) {
  const std::uint64_t viewer = Join();
  Text(viewer, {{"op", "advertise"},
                {"channels",
                 {{{"id", 1}, {"topic", "/target/pose"}, {"encoding", "json"}},
                  {{"id", 2}, {"topic", "/cmd_vel"}, {"encoding", "json"}},
                  {{"id", 3}, {"topic", "/target/release"}, {"encoding", "ros1"}}}}});
  const auto said = Take(viewer, "op", "status");
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0]["message"], "/cmd_vel: this run takes no messages on it");
  EXPECT_EQ(said[1]["message"], "/target/release: only messages in JSON are taken");
  const std::string pose = R"({"p_BO":[0.5,0,0.1],"q_BO":[1,0,0,0]})";
  EXPECT_FALSE(hub_.Receive(viewer, false, std::string("\x01\x01\0\0\0", 5) + pose, now_).has_value());
  EXPECT_FALSE(hub_.Receive(viewer, false, std::string("\x01\x02\0\0\0", 5) + pose, now_).has_value());
  EXPECT_EQ(Take(viewer, "op", "status").at(0)["message"], "there is no channel 2 of this viewer");
  const auto requests = AnswerCalls();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(std::get<HoldTarget>(requests[0]).p_BO[0], 0.5);
}

TEST(HubOfReadOnlyRun, OffersNoControl) {
  const Limits limits;
  CallQueue calls(8);
  Catalogue catalogue;
  catalogue.parameters = {{"servo.lambda", "1/s", "decay", 0.1, 10.0, 2.0, 2.0}};
  Hub hub(limits, catalogue, calls);
  const std::uint64_t viewer = hub.Join();
  const Clock::time_point now = Clock::now();
  hub.Receive(viewer, true, R"({"op":"setParameters","parameters":[{"name":"servo.lambda","value":3}]})",
              now);
  std::string all;
  while (const auto message = hub.Next(viewer)) {
    all += message->head;
  }
  EXPECT_THAT(all, HasSubstr("servo.lambda: this run's parameters can only be read"));
  EXPECT_THAT(all, testing::Not(HasSubstr("advertiseServices")));
  EXPECT_TRUE(calls.TakeAll().empty());
}

}  // namespace
}  // namespace fovea::live
