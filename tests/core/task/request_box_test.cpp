// SPDX-License-Identifier: Apache-2.0
// No Hold and no reset is lost, and nothing moves that was asked for before one of them.
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
      Case{"two of a kind are one", {kTrack, kTrack}, {kTrack, kNone}},
      Case{"a later Hold drops a Track", {kTrack, kHold}, {kHold, kNone}},
      Case{"a later Reset drops a Track", {kTrack, kReset}, {kReset, kNone}},
      Case{"a Track does not overtake a Hold", {kHold, kTrack}, {kHold, kTrack, kNone}},
      Case{"a Track does not overtake a Reset", {kReset, kTrack}, {kReset, kTrack, kNone}},
      Case{"a Hold does not drop a Reset", {kReset, kHold}, {kHold, kReset, kNone}},
      Case{"three wait", {kHold, kReset, kTrack}, {kHold, kReset, kTrack, kNone}},
      Case{"a Hold between two Tracks", {kTrack, kHold, kTrack}, {kHold, kTrack, kNone}},
      Case{"none drops a Track", {kTrack, kNone}, {kNone}},
      Case{"none drops neither Hold nor Reset", {kHold, kReset, kTrack, kNone}, {kHold, kReset, kNone}},
      Case{"a Track after none", {kTrack, kNone, kTrack}, {kTrack, kNone}},
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

// Also one that an earlier Take has kept for the next tick.
TEST(RequestBoxTest, ATrackThatWaitsIsDroppedByAllButAnotherTrack) {
  for (const Request later : {kHold, kReset, kNone}) {
    RequestBox box;
    box.Put(kHold);
    box.Put(kTrack);
    EXPECT_EQ(box.Take(), kHold);
    box.Put(later);
    EXPECT_EQ(box.Take(), later);
    EXPECT_EQ(box.Take(), kNone);
  }
}

TEST(RequestBoxTest, AResetThatWaitsIsKept) {
  for (const Request later : {kHold, kTrack}) {
    RequestBox box;
    box.Put(kHold);
    box.Put(kReset);
    EXPECT_EQ(box.Take(), kHold);
    box.Put(later);
    EXPECT_EQ(box.Take(), later == kHold ? kHold : kReset);
    EXPECT_EQ(box.Take(), later == kHold ? kReset : kTrack);
  }
}

TEST(RequestBoxTest, RequestIfNoneWaitsGivesWay) {
  RequestBox box;
  box.PutIfEmpty(kTrack);
  EXPECT_EQ(box.Take(), kTrack);
  box.Put(kNone);
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

// Random requests and ticks: the next tick after a Hold gets it, each reset is taken, and the arm tracks at
// the end only if that was asked for last.
TEST(RequestBoxTest, RandomRequestsKeepTheirOrder) {
  std::mt19937 engine(7);
  RequestBox box;
  Request last_put = kNone;
  Request last_taken = kNone;
  bool hold_waits = false;
  bool reset_waits = false;
  int holds = 0;
  int resets = 0;
  const auto take = [&] {
    const Request taken = box.Take();
    EXPECT_EQ(taken == kHold, hold_waits);
    EXPECT_EQ(taken == kReset, reset_waits && !hold_waits);
    holds += taken == kHold ? 1 : 0;
    resets += taken == kReset ? 1 : 0;
    reset_waits = reset_waits && taken != kReset;
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
      reset_waits = reset_waits || last_put == kReset;
    }
    if (engine() % 50 == 0) {
      take();
      take();
      take();
      EXPECT_EQ(last_taken == kTrack, last_put == kTrack);
      EXPECT_EQ(box.Take(), kNone);
    }
  }
  EXPECT_GT(holds, 1000);
  EXPECT_GT(resets, 1000);
}

}  // namespace
}  // namespace fovea::task
