// SPDX-License-Identifier: Apache-2.0
// The bounds of everything that waits: for a viewer, for the server's thread, for the run; and of rates.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/host/live/call_queue.hpp"
#include "firmware/host/live/inbox.hpp"
#include "firmware/host/live/outbox.hpp"
#include "firmware/host/live/rate_limit.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

Limits Small() {
  Limits limits;
  limits.pictures = 2;
  limits.plot_bytes = 30;
  limits.essential_bytes = 30;
  limits.calls = 3;
  return limits;
}

Outgoing Of(Weight weight, std::string head) { return {false, std::move(head), nullptr, weight}; }

std::vector<std::string> TakeAll(Outbox& outbox) {
  std::vector<std::string> heads;
  while (const auto message = outbox.Take()) {
    heads.push_back(message->head);
  }
  return heads;
}

TEST(Outbox, KeepsTheOrderAcrossWeights) {
  const Limits limits = Small();
  Outbox outbox(limits);
  EXPECT_TRUE(outbox.Add(Of(Weight::kPlot, "a")));
  EXPECT_TRUE(outbox.Add(Of(Weight::kPicture, "b")));
  EXPECT_TRUE(outbox.Add(Of(Weight::kEssential, "c")));
  EXPECT_TRUE(outbox.Add(Of(Weight::kPlot, "d")));
  EXPECT_EQ(outbox.bytes(), 4U);
  EXPECT_THAT(TakeAll(outbox), ElementsAre("a", "b", "c", "d"));
  EXPECT_TRUE(outbox.empty());
  EXPECT_EQ(outbox.bytes(), 0U);
}

TEST(Outbox, DropsOldPicturesThenOldPlotsAndNothingElse) {
  const Limits limits = Small();
  Outbox outbox(limits);
  const std::string ten(9, '.');
  for (int i = 0; i < 5; ++i) {
    const std::string number = std::to_string(i);
    EXPECT_TRUE(outbox.Add(Of(Weight::kPicture, "p" + number)));
    EXPECT_TRUE(outbox.Add(Of(Weight::kPlot, number + ten)));
  }
  EXPECT_EQ(outbox.dropped_pictures(), 3U);
  EXPECT_EQ(outbox.dropped_plots(), 2U);
  EXPECT_TRUE(outbox.Add(Of(Weight::kEssential, std::string(30, 'e'))));
  EXPECT_FALSE(outbox.Add(Of(Weight::kEssential, "f")));
  EXPECT_THAT(TakeAll(outbox),
              ElementsAre("2" + ten, "p3", "3" + ten, "p4", "4" + ten, std::string(30, 'e')));
}

TEST(Outbox, CountsSharedPayloads) {
  const Limits limits = Small();
  Outbox outbox(limits);
  Outgoing message = Of(Weight::kEssential, "head");
  message.payload = std::make_shared<const std::string>(27, 'x');
  EXPECT_FALSE(outbox.Add(message));
  EXPECT_TRUE(outbox.empty());
}

TEST(Inbox, DropsPicturesFirst) {
  constexpr std::size_t kEach = 100;
  Inbox inbox(4 * (kEach + sizeof(Published)));
  const Channel picture{"p", "", "", Weight::kPicture};
  const Channel plot{"t", "", "", Weight::kPlot};
  const Channel essential{"e", "", "", Weight::kEssential};
  const Channel latched{"l", "", "", Weight::kEssential, true};
  const auto add = [&](const Channel& channel) { inbox.Add({0, 0, std::string(kEach, 'x')}, channel); };
  for (int i = 0; i < 3; ++i) {
    add(picture);
  }
  EXPECT_EQ(inbox.dropped(), 1U);
  add(plot);
  add(plot);
  EXPECT_EQ(inbox.dropped(), 2U);
  add(essential);
  add(essential);
  EXPECT_EQ(inbox.dropped(), 3U);
  add(latched);
  EXPECT_EQ(inbox.dropped(), 3U);
  EXPECT_EQ(inbox.TakeMessages().size(), 5U);
  add(picture);
  EXPECT_EQ(inbox.TakeMessages().size(), 1U);
}

TEST(Inbox, KeepsOnlyTheNewestState) {
  Inbox inbox(1000);
  State state;
  state.mode = "hold";
  inbox.SetState(state);
  state.mode = "track";
  inbox.SetState(state);
  EXPECT_EQ(inbox.TakeState()->mode, "track");
  EXPECT_FALSE(inbox.TakeState().has_value());
}

PendingCall From(std::uint64_t viewer, Request request) {
  return {{ReturnAddress::Kind::kNobody, viewer}, {"viewer", std::move(request)}};
}

TEST(CallQueue, RefusesMoreThanItsBound) {
  CallQueue queue(3);
  EXPECT_FALSE(queue.WaitForOne(1ms));
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(queue.Add(From(1, Track{})));
  }
  EXPECT_FALSE(queue.Add(From(1, Track{})));
  EXPECT_TRUE(queue.WaitForOne(1ms));
  EXPECT_EQ(queue.TakeAll().size(), 3U);
  EXPECT_TRUE(queue.Add(From(1, Track{})));
}

TEST(CallQueue, StopAlwaysHasRoomOnceForEachViewer) {
  CallQueue queue(1);
  EXPECT_TRUE(queue.Add(From(1, Track{})));
  EXPECT_TRUE(queue.Add(From(1, Hold{})));
  EXPECT_TRUE(queue.Add(From(1, ControlEnded{})));
  EXPECT_TRUE(queue.Add(From(2, Hold{})));
  EXPECT_FALSE(queue.Add(From(2, Hold{})));
  EXPECT_FALSE(queue.Add(From(2, Track{})));
}

TEST(CallQueue, NewPoseOfTheTargetReplacesTheLast) {
  CallQueue queue(100);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(queue.Add(From(1, HoldTarget{{static_cast<double>(i), 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}})));
  }
  EXPECT_TRUE(queue.Add(From(1, ReleaseTarget{})));
  EXPECT_TRUE(queue.Add(From(1, HoldTarget{})));
  const auto calls = queue.TakeAll();
  ASSERT_EQ(calls.size(), 3U);
  EXPECT_EQ(std::get<HoldTarget>(calls[0].call.request).p_BO[0], 4.0);
}

TEST(RateLimit, AllowsABurstThenTheRate) {
  const Clock::time_point start = Clock::now();
  RateLimit limit(10.0, 3.0);
  EXPECT_TRUE(limit.Take(start) && limit.Take(start) && limit.Take(start));
  EXPECT_FALSE(limit.Take(start));
  EXPECT_FALSE(limit.Take(start + 90ms));
  EXPECT_TRUE(limit.Take(start + 110ms));
  EXPECT_FALSE(limit.Take(start + 110ms));
  const Clock::time_point later = start + 1h;
  EXPECT_TRUE(limit.Take(later) && limit.Take(later) && limit.Take(later));
  EXPECT_FALSE(limit.Take(later));
}

}  // namespace
}  // namespace fovea::live
