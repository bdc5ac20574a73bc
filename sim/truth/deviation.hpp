// SPDX-License-Identifier: Apache-2.0
// How a true value differs from the one that the servo believes: by a fixed amount, or at random.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fovea::sim {

// Each list is empty (no such difference), has one entry for all entries of the value, or one for each. They
// apply in this order. Random numbers are independent for each entry; a normal one is within three standard
// deviations, so that every value that can be drawn can be checked before a run.
struct Deviation {
  std::vector<double> value;        // the true value, then there is nothing else; empty: the believed one
  std::vector<double> scale;        // factor
  std::vector<double> scale_sigma;  // standard deviation of a factor about 1
  std::vector<double> scale_range;  // {low, high} of a uniformly distributed factor
  std::vector<double> offset;       // added
  std::vector<double> sigma;        // standard deviation of an added number about 0
  std::vector<double> range;        // {low, high} of a uniformly distributed added number

  [[nodiscard]] bool IsAny() const;
};

struct Span {
  double low = 0.0;
  double high = 0.0;
};

// InputError, which names `key`: a list has neither one entry nor `size`, a range ends below its begin, or a
// value stands beside another form.
void CheckForms(const Deviation& deviation, const std::string& key, std::size_t size);
// The span of each entry's true value over all draws. CheckForms must allow it.
std::vector<Span> SpansOf(const Deviation& deviation, const std::vector<double>& believed);
// The true value. Equal seeds give equal values. CheckForms must allow it.
std::vector<double> Draw(const Deviation& deviation, const std::vector<double>& believed, std::uint64_t seed);

}  // namespace fovea::sim
