// SPDX-License-Identifier: Apache-2.0
// The rule that selects one of several hypotheses, and the views that it compares them with.
#include "firmware/core/estimate/hypothesis_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fovea::estimate {
namespace {

// A place along a line.
struct Place {
  static constexpr double kFirstStep = 1.0;
  double x = 0.0;
};
double WayBetween(const Place& a, const Place& b) { return std::fabs(a.x - b.x); }

struct Guess {
  static constexpr ChoiceRule kRule{
      .switch_margin = 5.0, .still_most = 2.0, .still_credit = 3.0, .views_to_tell = 4, .give_up = 20.0};
  double value = 0.0;
  double still_misfit = 0.0;
  double motion_misfit = 0.0;
  double MisfitOfMotion() const { return motion_misfit; }
  bool IsSame(const Guess& other) const { return std::fabs(value - other.value) < 0.1; }
};

using Set = HypothesisSet<Guess, 4, Place, 8>;
constexpr double kEntries = 10.0;  // a still target's misfit is up to 20

Set Of(const std::vector<Guess>& guesses, int num_views = 8) {
  Set set;
  for (const Guess& guess : guesses) {
    set.all[static_cast<std::size_t>(set.count++)] = guess;
  }
  for (int i = 0; i < num_views; ++i) {
    set.views.Keep({static_cast<double>(i)});
  }
  return set;
}

TEST(HypothesisSetTest, BetterFitByTheMarginIsSelected) {
  Set set = Of({{1.0, 14.0}, {2.0, 9.5}, {3.0, 12.0}});
  EXPECT_FALSE(set.Choose(kEntries));
  EXPECT_EQ(set.best().value, 1.0);
  EXPECT_EQ(set.stillness, Stillness::kStill);
  set.all[1].still_misfit = 8.9;
  EXPECT_TRUE(set.Choose(kEntries));
  EXPECT_EQ(set.best().value, 2.0);
  EXPECT_EQ(set.count, 3);
  EXPECT_FALSE(set.Choose(kEntries)) << "it stays selected";
}

TEST(HypothesisSetTest, TooFewViewsLeaveStillnessUnknown) {
  Set set = Of({{1.0, 1.0}}, 3);
  EXPECT_FALSE(set.Choose(kEntries));
  EXPECT_EQ(set.stillness, Stillness::kUnknown);
  set.views.Keep({3.0});
  EXPECT_FALSE(set.Choose(kEntries));
  EXPECT_EQ(set.stillness, Stillness::kStill);
}

TEST(HypothesisSetTest, BadStillFitSelectsByMotion) {
  Set set = Of({{1.0, 24.0, 1.0}, {2.0, 21.0, 30.0}});
  EXPECT_FALSE(set.Choose(kEntries));
  EXPECT_EQ(set.stillness, Stillness::kMoving);
  EXPECT_EQ(set.best().value, 1.0);
  EXPECT_EQ(set.count, 1) << "the second one does not fit the motion";
  set = Of({{1.0, 22.9, 30.0}, {2.0, 24.0, 1.0}});
  EXPECT_FALSE(set.Choose(kEntries)) << "the selected one has credit";
  EXPECT_EQ(set.stillness, Stillness::kStill);
  set = Of({{1.0, NAN, NAN}});
  EXPECT_FALSE(set.Choose(kEntries));
  EXPECT_EQ(set.stillness, Stillness::kMoving) << "NaN fits nothing";
  EXPECT_EQ(set.count, 1);
}

TEST(HypothesisSetTest, HopelessAndDuplicateHypothesesAreDropped) {
  Set set = Of({{1.0, 40.0}, {2.0, 1.0}, {2.05, 2.0}, {3.0, 20.5}});
  set.believed = 2;
  EXPECT_FALSE(set.Choose(kEntries));
  ASSERT_EQ(set.count, 2);
  EXPECT_EQ(set.best().value, 2.05) << "the selected one stays: it is worse, but by less than the margin";
  EXPECT_EQ(set.believed, 0);
  EXPECT_EQ(set.all[1].value, 3.0);
}

// However far the camera moves, the views cover its whole way evenly, and the first one stays.
TEST(ViewsAlongTheWayTest, StepDoublesWhenTheViewsAreFull) {
  ViewsAlongTheWay<Place, 8> views;
  for (int i = 0; i < 1000; ++i) {
    views.Keep({0.5 * i});
    ASSERT_GE(views.count, 1);
    ASSERT_LE(views.count, 8);
    EXPECT_EQ(views.kept().front().x, 0.0);
    EXPECT_GE(views.kept().back().x + views.step, 0.5 * i);
    for (std::size_t k = 1; k < views.kept().size(); ++k) {
      EXPECT_EQ(views.kept()[k].x - views.kept()[k - 1].x, views.step) << i;
    }
  }
  EXPECT_EQ(views.step, 64.0);
  views.Keep({NAN});
  EXPECT_EQ(views.count, 8) << "a view at NaN is not kept";
  views.Forget();
  EXPECT_EQ(views.count, 0);
  views.Keep({7.0});
  views.Keep({8.0});
  EXPECT_EQ(views.count, 2) << "the step is reset";
}

}  // namespace
}  // namespace fovea::estimate
