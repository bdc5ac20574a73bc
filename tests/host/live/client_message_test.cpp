// SPDX-License-Identifier: Apache-2.0
// Messages of clients: what is read, and what is refused with which words.
#include "firmware/host/live/client_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/host/live/refusal.hpp"

namespace fovea::live {
namespace {

using testing::ElementsAre;
using testing::Field;

// The refusal's text; "" when the message is read.
std::string WhyNot(std::string_view bytes, bool is_text = true) {
  try {
    is_text ? ParseText(bytes) : ParseBinary(bytes);
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

template <typename Message>
Message Read(std::string_view text) {
  return std::get<Message>(ParseText(text));
}

TEST(ClientMessage, SubscriptionsAreRead) {
  const auto message = Read<Subscribe>(
      R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":3},{"id":4294967295,"channelId":1}]})");
  EXPECT_THAT(
      message.subscriptions,
      ElementsAre(testing::AllOf(Field(&Subscription::id, 7U), Field(&Subscription::channel, 3U)),
                  testing::AllOf(Field(&Subscription::id, 4294967295U), Field(&Subscription::channel, 1U))));
  EXPECT_THAT(Read<Unsubscribe>(R"({"op":"unsubscribe","subscriptionIds":[7]})").subscriptions,
              ElementsAre(7U));
}

TEST(ClientMessage, OwnChannelsAreRead) {
  const auto message = Read<Advertise>(
      R"({"op":"advertise","channels":[{"id":2,"topic":"/target/pose","encoding":"json","schemaName":"x"}]})");
  ASSERT_EQ(message.channels.size(), 1U);
  EXPECT_EQ(message.channels[0].id, 2U);
  EXPECT_EQ(message.channels[0].topic, "/target/pose");
  EXPECT_EQ(message.channels[0].encoding, "json");
  EXPECT_THAT(Read<Unadvertise>(R"({"op":"unadvertise","channelIds":[2]})").channels, ElementsAre(2U));
}

TEST(ClientMessage, ParametersAreRead) {
  const auto get = Read<GetParameters>(R"({"op":"getParameters","parameterNames":["a.b"],"id":"q"})");
  EXPECT_THAT(get.names, ElementsAre("a.b"));
  EXPECT_EQ(get.id, "q");
  const auto set = Read<SetParameters>(
      R"({"op":"setParameters","parameters":[{"name":"a.b","value":2.5},{"name":"c"},{"name":"d","value":"x"}]})");
  ASSERT_EQ(set.parameters.size(), 3U);
  EXPECT_EQ(set.parameters[0].value, 2.5);
  EXPECT_EQ(set.parameters[1].value, std::nullopt);
  EXPECT_EQ(set.parameters[2].value, std::nullopt);
  EXPECT_EQ(set.id, "");
  EXPECT_TRUE(Read<SubscribeParameters>(R"({"op":"subscribeParameterUpdates","parameterNames":[]})").on);
  EXPECT_FALSE(Read<SubscribeParameters>(R"({"op":"unsubscribeParameterUpdates","parameterNames":[]})").on);
}

TEST(ClientMessage, BinaryMessagesAreRead) {
  const std::string data("\x01\x02\x01\x00\x00{}", 7);
  const auto message = std::get<ClientData>(ParseBinary(data));
  EXPECT_EQ(message.channel, 0x102U);
  EXPECT_EQ(message.payload, "{}");
  const std::string service("\x02\x05\0\0\0\x09\0\0\0\x04\0\0\0json{\"a\":1}", 24);
  const auto call = std::get<ServiceCall>(ParseBinary(service));
  EXPECT_EQ(call.service, 5U);
  EXPECT_EQ(call.call, 9U);
  EXPECT_EQ(call.encoding, "json");
  EXPECT_EQ(call.payload, "{\"a\":1}");
}

TEST(ClientMessage, OtherOperationsKeepTheirName) {
  EXPECT_EQ(Read<UnknownOperation>(R"({"op":"fetchAsset"})").name, "fetchAsset");
  EXPECT_EQ(std::get<UnknownOperation>(ParseBinary("\xff")).name, "number 255");
}

TEST(ClientMessage, MalformedMessagesAreRefusedInOneLine) {
  EXPECT_EQ(WhyNot("{"), "the message is no valid JSON");
  EXPECT_EQ(WhyNot("\xff\xfe"), "the message is no valid JSON");
  EXPECT_EQ(WhyNot("{\"op\":\"\xff\"}"), "the message is no valid JSON");
  EXPECT_EQ(WhyNot("[]"), "the message is no JSON object");
  EXPECT_EQ(WhyNot("{}"), "the field op is missing");
  EXPECT_EQ(WhyNot(R"({"op":3})"), "the field op must be a short text");
  EXPECT_EQ(WhyNot(R"({"op":"subscribe"})"), "the field subscriptions is missing");
  EXPECT_EQ(WhyNot(R"({"op":"subscribe","subscriptions":[3]})"), "the field id is missing");
  EXPECT_EQ(WhyNot(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
            "an id must be a whole number below 2^32");
  EXPECT_EQ(WhyNot(R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})"),
            "an id must be a whole number below 2^32");
  EXPECT_EQ(WhyNot(R"({"op":"getParameters","parameterNames":[1]})"),
            "a parameter's name must be a short text");
  EXPECT_EQ(WhyNot("", false), "the binary message is too short");
  EXPECT_EQ(WhyNot(std::string_view("\x01\x02\x00", 3), false), "the binary message is too short");
  // The encoding claims to be longer than the message.
  EXPECT_EQ(WhyNot(std::string_view("\x02\0\0\0\0\0\0\0\0\xff\xff\xff\xffjson", 17), false),
            "the binary message is too short");
}

TEST(ClientMessage, SizesAreBounded) {
  EXPECT_EQ(WhyNot(std::string(60'000, '[')), "the JSON is nested too deeply");
  EXPECT_EQ(WhyNot(R"({"op":")" + std::string(kMostNameBytes + 1, 'a') + R"("})"),
            "the field op must be a short text");
  std::string ids = "1";
  for (std::size_t i = 0; i < kMostEntries; ++i) {
    ids += ",1";
  }
  EXPECT_EQ(WhyNot(R"({"op":"unsubscribe","subscriptionIds":[)" + ids + "]}"),
            "the field subscriptionIds must be a list of at most 256 entries");
}

TEST(Refusal, QuotesOnlyPlainText) {
  EXPECT_EQ(Quoted("a\nb\x1b[31m\xc3\xbc"), "a?b?[31m??");
  EXPECT_EQ(Quoted(std::string(100, 'x')), std::string(64, 'x'));
}

}  // namespace
}  // namespace fovea::live
