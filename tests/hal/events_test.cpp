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

TEST(EventsTest, WordsReadAsPartOfASentence) {
  EXPECT_STREQ(Words(HoldReason::kTargetLost), "the target was lost");
  EXPECT_STREQ(Words(Fault::kNonFiniteSensor), "a sensor value was not finite");
  EXPECT_STREQ(Words(Intake::kTooOld), "too old");
}

}  // namespace
}  // namespace fovea::hal
