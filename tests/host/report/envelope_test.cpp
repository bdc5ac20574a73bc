// SPDX-License-Identifier: Apache-2.0
// Thinning keeps every peak that a plot must show.
#include "firmware/host/report/envelope.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace fovea::report {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

TEST(EnvelopeTest, KeepsRowsUnchangedWhileTheyFit) {
  Envelope envelope(2, 100);
  for (int i = 0; i < 100; ++i) {
    envelope.Add(i, {static_cast<float>(i), static_cast<float>(-i)});
  }
  const Envelope::Rows rows = envelope.rows();
  ASSERT_EQ(rows.t_s.size(), 100U);
  EXPECT_FLOAT_EQ(rows.columns[0][42], 42.0F);
  EXPECT_FLOAT_EQ(rows.columns[1][42], -42.0F);
}

// Every peak of every column stays, at the time of its bucket; memory stays bounded.
TEST(EnvelopeTest, KeepsEveryPeak) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const std::size_t count : {101U, 1000U, 12'345U, 100'000U}) {
    constexpr std::size_t kBuckets = 100;
    Envelope envelope(1, kBuckets);
    std::vector<float> all;
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(normal(random) + (i == count / 3 ? 1e3F : 0.0F) - (i == count / 2 ? 1e3F : 0.0F));
      envelope.Add(static_cast<double>(i), {all.back()});
    }
    const Envelope::Rows rows = envelope.rows();
    EXPECT_LE(rows.t_s.size(), 2 * kBuckets + 2);
    EXPECT_GE(rows.t_s.size(), kBuckets / 2);
    EXPECT_EQ(*std::max_element(rows.columns[0].begin(), rows.columns[0].end()),
              *std::max_element(all.begin(), all.end()));
    EXPECT_EQ(*std::min_element(rows.columns[0].begin(), rows.columns[0].end()),
              *std::min_element(all.begin(), all.end()));
    EXPECT_TRUE(std::is_sorted(rows.t_s.begin(), rows.t_s.end()));
    EXPECT_FLOAT_EQ(rows.t_s.back(), static_cast<float>(count - 1));
    // Between the two rows of a bucket no value lies outside their range.
    for (std::size_t i = 0; i + 1 < rows.t_s.size(); i += 2) {
      const auto [low, high] = std::minmax(rows.columns[0][i], rows.columns[0][i + 1]);
      for (auto k = static_cast<std::size_t>(rows.t_s[i]); k <= static_cast<std::size_t>(rows.t_s[i + 1]);
           ++k) {
        ASSERT_LE(low, all[k]);
        ASSERT_GE(high, all[k]);
      }
    }
  }
}

TEST(EnvelopeTest, SkipsMissingValues) {
  Envelope envelope(1, 2);
  for (int i = 0; i < 64; ++i) {
    envelope.Add(i, {i % 2 == 0 ? kNone : static_cast<float>(i)});
  }
  const Envelope::Rows rows = envelope.rows();
  for (const float value : rows.columns[0]) {
    EXPECT_FALSE(std::isnan(value));
  }
  Envelope none(1, 2);
  for (int i = 0; i < 64; ++i) {
    none.Add(i, {kNone});
  }
  const Envelope::Rows no_rows = none.rows();
  for (const float value : no_rows.columns[0]) {
    EXPECT_TRUE(std::isnan(value));
  }
}

}  // namespace
}  // namespace fovea::report
