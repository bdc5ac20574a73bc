// SPDX-License-Identifier: Apache-2.0
// Draws the true values of a run, and keeps a list of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/truth/truth_settings.hpp"

namespace fovea::sim {

// A value that is not as the servo believes.
struct TrueValue {
  Quantity quantity{};
  std::vector<double> believed;
  std::vector<double> actual;
};

class TruthDraw {
 public:
  // `settings` must outlive it. The draw of a quantity depends on the seed and on its own keys only.
  TruthDraw(const TruthSettings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {}

  // The true value of a quantity; `believed` itself if no key says otherwise. InputError: lists of a wrong
  // size, or a value that could be drawn is not allowed. `allowed`: for each entry, within the quantity's
  // own.
  std::vector<double> Get(Quantity quantity, const std::vector<double>& believed);
  std::vector<double> Get(Quantity quantity, const std::vector<double>& believed,
                          const std::vector<Span>& allowed);
  // InputError if a key of the quantity is given: it would have no effect because of `reason`.
  void Refuse(Quantity quantity, const std::string& reason) const;

  [[nodiscard]] const std::vector<TrueValue>& differing() const { return differing_; }

 private:
  const TruthSettings& settings_;
  const std::uint64_t seed_;
  std::vector<TrueValue> differing_;
};

}  // namespace fovea::sim
