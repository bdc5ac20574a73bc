// SPDX-License-Identifier: Apache-2.0
// A Hold is taken before all that is put after it, and nothing after it is lost but what a later request
// replaces.
#include "firmware/core/task/request_box.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace fovea::task {
namespace {

using enum Request;

struct Case {
  const char* name;
  std::vector<Request> put;
  std::vector<Request> taken;
};

TEST(RequestBoxTest, EachOrderOfRequestsIsTakenAsTold) {
  const std::array cases{
      Case{"nothing", {}, {kNone}},
      Case{"the last request wins", {kTrack, kReset, kTrack}, {kTrack, kNone}},
      Case{"a later Hold drops a Track", {kTrack, kHold}, {kHold, kNone}},
      Case{"a Track does not overtake a Hold", {kHold, kTrack}, {kHold, kTrack, kNone}},
      Case{"a Reset does not overtake a Hold", {kHold, kReset}, {kHold, kReset, kNone}},
      Case{"a Hold does not drop a Reset", {kReset, kHold}, {kHold, kReset, kNone}},
      Case{"of two after a Hold, the last", {kHold, kReset, kTrack}, {kHold, kTrack, kNone}},
      Case{"two Holds are one", {kHold, kTrack, kHold}, {kHold, kNone}},
      Case{"none drops a Track", {kTrack, kNone}, {kNone}},
      Case{"none drops no Hold", {kHold, kTrack, kNone}, {kHold, kNone}},
  };
  for (const Case& c : cases) {
    RequestBox box;
    for (const Request request : c.put) {
      box.Put(request);
    }
    for (const Request request : c.taken) {
      EXPECT_EQ(box.Take(), request) << c.name;
    }
  }
}

TEST(RequestBoxTest, WhatWaitsBehindAHoldGivesWayToWhatIsNewer) {
  RequestBox box;
  box.Put(kHold);
  box.Put(kTrack);
  EXPECT_EQ(box.Take(), kHold);
  box.Put(kHold);
  EXPECT_EQ(box.Take(), kHold) << "a Hold drops the Track that waited behind the first Hold";
  EXPECT_EQ(box.Take(), kNone);
  box.Put(kHold);
  box.Put(kReset);
  EXPECT_EQ(box.Take(), kHold);
  box.Put(kHold);
  EXPECT_EQ(box.Take(), kHold);
  EXPECT_EQ(box.Take(), kReset) << "but no reset";
}

TEST(RequestBoxTest, RequestIfNoneWaitsGivesWay) {
  RequestBox box;
  box.PutIfEmpty(kTrack);
  EXPECT_EQ(box.Take(), kTrack);
  box.Put(kHold);
  box.PutIfEmpty(kTrack);
  EXPECT_EQ(box.Take(), kHold);
  EXPECT_EQ(box.Take(), kNone);
}

TEST(RequestBoxTest, ClearForgetsAll) {
  RequestBox box;
  box.Put(kHold);
  box.Put(kTrack);
  EXPECT_EQ(box.Take(), kHold);
  box.Put(kReset);
  box.Clear();
  EXPECT_EQ(box.Take(), kNone);
}

// Random requests and ticks: the next tick after a Hold gets it, and the last request is the last that is
// taken.
TEST(RequestBoxTest, RandomRequestsKeepTheirOrder) {
  std::mt19937 engine(7);
  RequestBox box;
  Request last_put = kNone;
  Request last_taken = kNone;
  bool hold_waits = false;
  int holds = 0;
  const auto take = [&] {
    const Request taken = box.Take();
    EXPECT_EQ(taken == kHold, hold_waits);
    holds += taken == kHold ? 1 : 0;
    hold_waits = false;
    last_taken = taken != kNone ? taken : last_taken;
  };
  for (int i = 0; i < 20000; ++i) {
    if (engine() % 3 == 0) {
      take();
    } else {
      constexpr std::array kAll{kTrack, kHold, kReset};
      last_put = kAll[engine() % kAll.size()];
      box.Put(last_put);
      hold_waits = hold_waits || last_put == kHold;
    }
    if (engine() % 50 == 0) {
      take();
      take();
      // A reset stays behind a Hold.
      EXPECT_TRUE(last_taken == last_put || (last_put == kHold && last_taken == kReset));
      EXPECT_EQ(box.Take(), kNone);
    }
  }
  EXPECT_GT(holds, 1000);
}

}  // namespace
}  // namespace fovea::task
