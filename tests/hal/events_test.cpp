// SPDX-License-Identifier: Apache-2.0
// Reasons have a name for logs and words for a person.
#include "fovea/hal/events.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <set>
#include <string>

namespace fovea::hal {
namespace {

// The words of every enumerator: none is empty, a name, or the words of another; a value outside the
// enumeration has words, too.
template <typename Enumerator>
void ExpectOwnWords(int count) {
  const auto outside = static_cast<Enumerator>(count);
  std::set<std::string> words{Words(outside)};
  EXPECT_STREQ(Name(outside), "unknown") << count << " is an enumerator: count it";
  EXPECT_STRNE(Words(outside), "");
  for (int i = 0; i < count; ++i) {
    const auto which = static_cast<Enumerator>(i);
    std::cout << Name(which) << ": " << Words(which) << "\n";
    EXPECT_STRNE(Words(which), "") << Name(which);
    EXPECT_STRNE(Words(which), Name(which));
    EXPECT_EQ(std::string(Words(which)).find('_'), std::string::npos) << Words(which);
    EXPECT_TRUE(words.insert(Words(which)).second) << Name(which) << " shares its words";
  }
}

TEST(EventsTest, EveryHoldReasonHasItsOwnWords) { ExpectOwnWords<HoldReason>(kNumHoldReasons); }

TEST(EventsTest, EveryFaultHasItsOwnWords) { ExpectOwnWords<Fault>(kNumFaults); }

TEST(EventsTest, EveryIntakeHasItsOwnWords) { ExpectOwnWords<Intake>(kNumIntakes); }

TEST(EventsTest, EveryPlanEventHasItsOwnWords) { ExpectOwnWords<PlanEvent>(kNumPlanEvents); }

TEST(EventsTest, EveryWayAndPlanEventHasItsOwnName) {
  std::set<std::string> names{Name(static_cast<Way>(kNumWays))};
  for (int i = 0; i < kNumWays; ++i) {
    EXPECT_TRUE(names.insert(Name(static_cast<Way>(i))).second) << i;
  }
  EXPECT_STREQ(Name(Way::kLaw), "law");
  EXPECT_STREQ(Name(Way::kAwaitPlan), "await_plan");
  EXPECT_STREQ(Name(Way::kPlan), "plan");
  names = {Name(static_cast<PlanEvent>(kNumPlanEvents))};
  for (int i = 0; i < kNumPlanEvents; ++i) {
    EXPECT_TRUE(names.insert(Name(static_cast<PlanEvent>(i))).second) << i;
  }
  EXPECT_STREQ(Name(PlanEvent::kAsked), "asked");
  EXPECT_STREQ(Name(PlanEvent::kTargetMoved), "target_moved");
  EXPECT_STREQ(Name(PlanEvent::kDone), "done");
}

TEST(EventsTest, WordsReadAsPartOfASentence) {
  EXPECT_STREQ(Words(HoldReason::kTargetLost), "the target was lost");
  EXPECT_STREQ(Words(Fault::kNonFiniteSensor), "a sensor value was not finite");
  EXPECT_STREQ(Words(Intake::kTooOld), "too old");
}

}  // namespace
}  // namespace fovea::hal
