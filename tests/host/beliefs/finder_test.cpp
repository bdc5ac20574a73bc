// SPDX-License-Identifier: Apache-2.0
// The thread beside the tick tells the same as a watch in the thread that has the records, and at fixed
// ticks.
#include "firmware/host/beliefs/finder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <thread>

#include "tests/host/beliefs/synthetic_run.hpp"

namespace fovea::beliefs {
namespace {

constexpr double kLoad = 0.3;  // that the servo does not know [kg]

struct Request {
  std::uint64_t tick = 0;
  config::Tuning tuning;
};

// The records of a run with a wrong load, in ticks.
void MakeRun(const std::function<void(const hal::TickRecord&)>& take) {
  test::SyntheticTruth truth;
  truth.load = {kLoad, model::Vec3(0.05, 0.0, 0.02), model::Mat3::Zero()};
  std::uint64_t tick = 0;
  test::MakeRun(test::PandaConfig(), test::LookAround(), {model::Mat3::Identity(), test::BallPlace()}, truth,
                {}, 4.0, 1, [&](const hal::TickRecord& record) {
                  hal::TickRecord numbered = record;
                  numbered.tick = tick++;
                  take(numbered);
                });
}

Configured ABelief() {
  Configured configured;
  configured.load = model::Load{0.0, model::Vec3(0.05, 0.0, 0.02), model::Mat3::Zero()};
  return configured;
}

std::vector<Request> RequestsOf(const FinderConfig& config, std::optional<Findings>& last) {
  Finder finder(test::PandaConfig(), ABelief(), config);
  std::vector<Request> requests;
  MakeRun([&](const hal::TickRecord& record) {
    finder.Add(record);
    for (const config::Tuning& tuning : finder.TakeRequests()) {
      requests.push_back({record.tick, tuning});
    }
  });
  last = finder.Finish();
  return requests;
}

TEST(FinderTest, AsksAtFixedTicksInLockstep) {
  std::optional<Findings> last;
  const std::vector<Request> first = RequestsOf({{false, true}, false, true}, last);
  const std::vector<Request> second = RequestsOf({{false, true}, false, true}, last);
  ASSERT_FALSE(first.empty());
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].tick % Finder::kEveryTicks, Finder::kDueTicks);
    EXPECT_EQ(first[i].tick, second[i].tick);
    EXPECT_EQ(first[i].tuning.key, config::kLoadOffsetKey);
    EXPECT_EQ(first[i].tuning.value, second[i].tuning.value) << "to the last bit";
  }
  fmt::print("{:.4f} kg at tick {}\n", first.back().tuning.value, first.back().tick);
  EXPECT_NEAR(first.back().tuning.value, kLoad, 0.03);
}

TEST(FinderTest, AsksForNothingIfItDoesNotLearn) {
  std::optional<Findings> last;
  EXPECT_TRUE(RequestsOf({{false, false}, true, true}, last).empty());
  ASSERT_TRUE(last);
  EXPECT_TRUE(last->learnt.empty());
}

TEST(FinderTest, TellsTheSameAsAWatch) {
  std::optional<Findings> last;
  static_cast<void>(RequestsOf({}, last));
  RunWatch watch(test::PandaConfig(), ABelief());
  MakeRun([&](const hal::TickRecord& record) { watch.Add(record); });
  const Findings expected = watch.Finish();
  ASSERT_TRUE(last);
  ASSERT_EQ(last->beliefs.size(), expected.beliefs.size());
  ASSERT_FALSE(expected.beliefs.empty());
  for (std::size_t i = 0; i < expected.beliefs.size(); ++i) {
    EXPECT_EQ(last->beliefs[i].name, expected.beliefs[i].name);
    EXPECT_EQ(last->beliefs[i].difference, expected.beliefs[i].difference) << expected.beliefs[i].name;
  }
}

// At real pace the caller never waits; a page sees findings while the run goes on.
TEST(FinderTest, ShowsFindingsWhileTheRunGoesOn) {
  Finder finder(test::PandaConfig(), ABelief(), {{}, true, false});
  EXPECT_EQ(finder.now(), nullptr);
  MakeRun([&](const hal::TickRecord& record) {
    finder.Add(record);
    static_cast<void>(finder.TakeRequests());
  });
  while (finder.now() == nullptr) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    static_cast<void>(finder.TakeRequests());
  }
  EXPECT_FALSE(finder.now()->beliefs.empty());
}

}  // namespace
}  // namespace fovea::beliefs
