// SPDX-License-Identifier: Apache-2.0
// Finds by bisection the largest of some increasing sizes that is borne.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace fovea::robustness {

// The sizes that are tried for a margin, as multiples of a stated end: the powers of the square root of 2
// from 0.25 to 32.
const std::vector<double>& MarginMultiples();
inline constexpr std::size_t kStatedMultiple = 4;  // the index of 1

// It takes for granted that size 0 is borne, and that what is larger than a size that is not borne is not
// borne either.
class Bisection {
 public:
  // `sizes`: their number. `first`: the one to try first.
  Bisection(std::size_t sizes, std::size_t first) : sizes_(sizes), least_not_(sizes), first_(first) {}

  // The size to try next; none when all is known.
  [[nodiscard]] std::optional<std::size_t> Next() const;
  // The result for Next().
  void Note(bool is_borne);

  // The largest size that is borne; none if no size is.
  [[nodiscard]] std::optional<std::size_t> borne() const;
  // The least that is not; none if all are.
  [[nodiscard]] std::optional<std::size_t> not_borne() const;

 private:
  std::size_t sizes_;
  std::size_t number_borne_ = 0;  // the sizes below this index are
  std::size_t least_not_;
  std::size_t first_;
  bool is_first_ = true;
};

}  // namespace fovea::robustness
