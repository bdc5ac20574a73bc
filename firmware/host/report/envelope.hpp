// SPDX-License-Identifier: Apache-2.0
// Time series thinned for a plot: as many rows as a screen can show, with every peak kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace fovea::report {

inline constexpr float kGap = std::numeric_limits<float>::quiet_NaN();  // of a curve, where it has no value

// Rows come in order of time. They are gathered in buckets of equally many rows; a bucket keeps each column's
// least and greatest value. When there are too many buckets, neighbours are joined: memory stays bounded.
class Envelope {
 public:
  Envelope(std::size_t columns, std::size_t most_buckets) : columns_(columns), most_buckets_(most_buckets) {}

  // `values` [columns]; NaN stands for no value.
  void Add(double t_s, const std::vector<float>& values) {
    if (rows_in_last_ == 0) {
      Bucket bucket;
      bucket.t_first_s = t_s;
      bucket.least = bucket.greatest = bucket.first = values;
      buckets_.push_back(bucket);
    }
    Bucket& bucket = buckets_.back();
    bucket.t_last_s = t_s;
    for (std::size_t i = 0; i < columns_; ++i) {
      Widen(bucket, i, values[i], values[i]);
    }
    bucket.last = values;
    rows_in_last_ = (rows_in_last_ + 1) % rows_per_bucket_;
    if (buckets_.size() > most_buckets_ && rows_in_last_ == 0) {
      Join();
    }
  }

  // Times, and the values of each column. A bucket of one row gives one row. Other buckets give two rows: the
  // least and the greatest value, in the order of the column's trend.
  struct Rows {
    std::vector<float> t_s;
    std::vector<std::vector<float>> columns;
  };
  [[nodiscard]] Rows rows() const {
    Rows rows;
    rows.columns.resize(columns_);
    for (const Bucket& bucket : buckets_) {
      const bool single = bucket.t_first_s == bucket.t_last_s;
      rows.t_s.push_back(static_cast<float>(bucket.t_first_s));
      if (!single) {
        rows.t_s.push_back(static_cast<float>(bucket.t_last_s));
      }
      for (std::size_t i = 0; i < columns_; ++i) {
        const bool falls = bucket.first[i] > bucket.last[i];
        rows.columns[i].push_back(falls ? bucket.greatest[i] : bucket.least[i]);
        if (!single) {
          rows.columns[i].push_back(falls ? bucket.least[i] : bucket.greatest[i]);
        }
      }
    }
    return rows;
  }

 private:
  struct Bucket {
    double t_first_s = 0.0;
    double t_last_s = 0.0;
    std::vector<float> least, greatest, first, last;
  };

  static void Widen(Bucket& bucket, std::size_t i, float least, float greatest) {
    bucket.least[i] = std::fmin(bucket.least[i], least);  // fmin and fmax ignore NaN
    bucket.greatest[i] = std::fmax(bucket.greatest[i], greatest);
  }

  void Join() {
    for (std::size_t k = 0; 2 * k < buckets_.size(); ++k) {
      Bucket joined = buckets_[2 * k];
      if (2 * k + 1 < buckets_.size()) {
        const Bucket& next = buckets_[2 * k + 1];
        for (std::size_t i = 0; i < columns_; ++i) {
          Widen(joined, i, next.least[i], next.greatest[i]);
        }
        joined.t_last_s = next.t_last_s;
        joined.last = next.last;
      } else {
        rows_in_last_ = rows_per_bucket_;  // half full
      }
      buckets_[k] = joined;
    }
    buckets_.resize((buckets_.size() + 1) / 2);
    rows_per_bucket_ *= 2;
  }

  std::size_t columns_;
  std::size_t most_buckets_;
  std::size_t rows_per_bucket_ = 1;
  std::size_t rows_in_last_ = 0;  // of an unfinished bucket
  std::vector<Bucket> buckets_;
};

}  // namespace fovea::report
