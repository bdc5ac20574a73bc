// SPDX-License-Identifier: Apache-2.0
// Requests of other threads to a running loop: the last one before a tick takes effect, no Hold is lost, no
// other value is seen, and Stop ends the loop.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "tests/support/fake_drivers.hpp"

namespace fovea::task {
namespace {

// Counts the requests that it receives.
class CountingStep final : public ServoStep {
 public:
  void Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept override {
    outputs.record.command.num_joints = inputs.arm.num_joints;
    tracks += inputs.request == Request::kTrack ? 1 : 0;
    others += inputs.request == Request::kReset ? 1 : 0;
    last = inputs.request == Request::kNone ? last : inputs.request;
    laws += inputs.change_law ? 1 : 0;
    wrong_laws += inputs.change_law && inputs.law != config::MotionLawKind::kPd &&
                          inputs.law != config::MotionLawKind::kFloat
                      ? 1
                      : 0;
    law = inputs.change_law ? inputs.law : law;
    if (inputs.tuning.IsAsked()) {
      const auto key = static_cast<std::size_t>(inputs.tuning.key);
      older_values += inputs.tuning.value < values.at(key) ? 1 : 0;
      values.at(key) = inputs.tuning.value;
      ++tunings;
    }
    holds.fetch_add(inputs.request == Request::kHold ? 1 : 0, std::memory_order_relaxed);
    ticks.fetch_add(1, std::memory_order_release);
  }
  int tracks = 0;
  int others = 0;
  int laws = 0;
  int wrong_laws = 0;
  int tunings = 0;
  int older_values = 0;  // of a key, after a newer one
  std::array<double, config::kMostTunable> values{};
  Request last = Request::kNone;
  config::MotionLawKind law{};
  std::atomic<int> holds{0};
  std::atomic<int> ticks{0};
};

class DeafRecorder final : public hal::Recorder {
 public:
  void Record(const hal::TickRecord& /*record*/) noexcept override {}
};

class ServoLoopAsks : public testing::Test {
 protected:
  // Runs a piece of the loop, so that the fake drivers' records stay small. False if it ran no tick.
  bool RunAPiece(int ticks = 1000) {
    const std::uint64_t before = loop.counters().ticks;
    EXPECT_TRUE(loop.Run(clock.now_ns + ticks * hal::kTickPeriodNs).ok());
    arm.written.clear();
    clock.deadlines_ns.clear();
    return loop.counters().ticks != before;
  }
  void RunUntilStop() {
    while (RunAPiece()) {
    }
  }

  CountingStep step;
  test::FakeArm arm{7};
  test::FakeClock clock;
  hal::FeatureMailbox mailbox;
  DeafRecorder recorder;
  test::NoProbe probe;
  ServoLoop loop{step, arm, clock, mailbox, recorder, probe};
};

// A Hold from one person is not lost when another asks to track before the next tick.
TEST_F(ServoLoopAsks, AHoldThatNoTickHasTakenStays) {
  loop.Ask(Request::kTrack);
  loop.Ask(Request::kHold);
  loop.Ask(Request::kReset);
  loop.Ask(Request::kTrack);
  for (const Request request : {Request::kHold, Request::kReset, Request::kTrack}) {
    RunAPiece(1);
    EXPECT_EQ(step.last, request);
  }
  RunAPiece(10);
  EXPECT_EQ(step.tracks, 1);
  EXPECT_EQ(step.others, 1);
  loop.Ask(Request::kHold);
  loop.AskIfNoneWaits(Request::kTrack);
  RunAPiece(10);
  EXPECT_EQ(step.tracks, 1) << "the Hold came first";
}

// Without permission to move, each tick holds; but a fault can be left.
TEST_F(ServoLoopAsks, AResetNeedsNoLeave) {
  loop.GiveLeave(0);
  loop.Ask(Request::kReset);
  loop.Ask(Request::kTrack);
  RunAPiece(1);
  EXPECT_EQ(step.last, Request::kReset);
  RunAPiece(3);
  EXPECT_EQ(step.tracks, 0);
  loop.Finish();
  loop.Ask(Request::kReset);
  RunAPiece(1);
  EXPECT_EQ(step.others, 1);
}

// One person holds while another asks to track all the time: each Hold arrives.
TEST_F(ServoLoopAsks, NoHoldIsLostToAnotherThread) {
  constexpr int kHolds = 200;
  std::atomic<bool> done{false};
  int lost = 0;
  std::thread tracker([&] {
    while (!done.load(std::memory_order_relaxed)) {
      loop.Ask(Request::kTrack);
    }
  });
  std::thread holder([&] {
    for (int i = 0; i < kHolds; ++i) {
      const int before = step.holds.load(std::memory_order_relaxed);
      loop.Ask(Request::kHold);
      // The tick that runs now and the next one.
      const int enough = step.ticks.load(std::memory_order_relaxed) + 2;
      while (step.ticks.load(std::memory_order_acquire) < enough) {
        std::this_thread::yield();
      }
      lost += step.holds.load(std::memory_order_relaxed) == before ? 1 : 0;
    }
    done = true;
    loop.Stop();
  });
  RunUntilStop();
  holder.join();
  tracker.join();
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(step.holds.load(), kHolds);
}

TEST_F(ServoLoopAsks, LastRequestOfAnotherThreadTakesEffect) {
  constexpr int kAsks = 1000;
  std::thread asker([&] {
    for (int i = 0; i < kAsks; ++i) {
      loop.Ask(Request::kTrack);
      loop.Ask(config::MotionLawKind::kPd);
      std::this_thread::yield();
    }
    loop.Ask(Request::kHold);
    loop.Ask(config::MotionLawKind::kFloat);
    // Both are pending; one of the next 1000 ticks takes them.
    const int enough = step.ticks.load(std::memory_order_relaxed) + 1000;
    while (step.ticks.load(std::memory_order_relaxed) < enough) {
      std::this_thread::yield();
    }
    loop.Stop();
  });
  RunUntilStop();
  asker.join();
  EXPECT_EQ(step.last, Request::kHold);
  EXPECT_EQ(step.law, config::MotionLawKind::kFloat);
  EXPECT_LE(step.tracks, kAsks);
  EXPECT_EQ(step.others, 0);
  EXPECT_GE(step.laws, 1);
  EXPECT_LE(step.laws, kAsks + 1);
  EXPECT_EQ(step.wrong_laws, 0);
  std::printf("%llu ticks took %d of %d requests\n", static_cast<unsigned long long>(loop.counters().ticks),
              step.tracks, kAsks);
}

// Two threads change eight keys each. No key's last value is lost, and no value comes after a newer one.
TEST_F(ServoLoopAsks, LastValueOfEachKeyArrives) {
  constexpr int kAsks = 2000;
  constexpr int kKeys = config::kMostTunable / 2;
  std::atomic<int> refused{0};
  std::vector<std::thread> askers;
  for (int first : {0, kKeys}) {
    askers.emplace_back([&, first] {
      for (int i = 1; i <= kAsks; ++i) {
        for (int key = first; key < first + kKeys; ++key) {
          refused += loop.Ask(config::Tuning{key, static_cast<double>(i)}) ? 0 : 1;
        }
        std::this_thread::yield();
      }
    });
  }
  std::thread stopper([&] {
    for (std::thread& asker : askers) {
      asker.join();
    }
    // Each key waits for at most one round of all keys.
    const int enough = step.ticks.load(std::memory_order_relaxed) + 100;
    while (step.ticks.load(std::memory_order_relaxed) < enough) {
      std::this_thread::yield();
    }
    loop.Stop();
  });
  RunUntilStop();
  stopper.join();
  for (const double value : step.values) {
    EXPECT_EQ(value, kAsks);
  }
  EXPECT_EQ(step.older_values, 0);
  EXPECT_EQ(refused.load(), 0);
  std::printf("%d of %d requests were taken\n", step.tunings, kAsks * config::kMostTunable);
}

// The leave to move ends and is given again while the loop runs: no request takes effect without it.
TEST_F(ServoLoopAsks, RequestOfAnotherThreadNeedsLeave) {
  constexpr int kLeases = 1000;
  loop.GiveLeave(0);
  std::thread asker([&] {
    for (int i = 0; i < kLeases; ++i) {
      loop.Ask(Request::kTrack);  // without leave
      std::this_thread::yield();
    }
    loop.GiveLeave(INT64_MAX - 1);
    loop.Ask(Request::kReset);
    const int enough = step.ticks.load(std::memory_order_relaxed) + 1000;
    while (step.ticks.load(std::memory_order_relaxed) < enough) {
      std::this_thread::yield();
    }
    loop.Finish();
    while (loop.finish_tick() == ServoLoop::kNever) {
      std::this_thread::yield();
    }
  });
  while (loop.finish_tick() == ServoLoop::kNever && RunAPiece()) {
  }
  asker.join();
  // The last kTrack may wait for the first tick that has leave again.
  EXPECT_LE(step.tracks, 1);
  EXPECT_EQ(step.others, 1) << "a request after GiveLeave takes effect";
  EXPECT_EQ(loop.lease_ends(), 1U);
}

}  // namespace
}  // namespace fovea::task
