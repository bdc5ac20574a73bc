// SPDX-License-Identifier: Apache-2.0
// Counts the ticks in which the arm touched something, by the simulator's truth.
#pragma once

#include "sim/verdict/summary.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class ContactCount {
 public:
  void Add(const Contacts& contacts) {
    any_ += contacts.Any() ? 1U : 0U;
    by_what_.bench += contacts.bench > 0 ? 1U : 0U;
    by_what_.target += contacts.target ? 1U : 0U;
    by_what_.self += contacts.self ? 1U : 0U;
  }
  [[nodiscard]] std::uint64_t any() const { return any_; }
  [[nodiscard]] const ContactTicks& by_what() const { return by_what_; }

 private:
  std::uint64_t any_ = 0;
  ContactTicks by_what_;
};

}  // namespace fovea::sim
