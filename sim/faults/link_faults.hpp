// SPDX-License-Identifier: Apache-2.0
// Faults of a network or serial line: loses, delays, reorders and duplicates datagrams. Repeatable by seed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace fovea::sim {

struct LinkFaults {
  double loss = 0.0;       // share of lost datagrams
  double duplicate = 0.0;  // share of duplicated datagrams
  double reorder = 0.0;    // share of datagrams delayed so that the next one overtakes them
  double delay_ms = 0.0;
  double jitter_ms = 0.0;  // largest additional delay, uniformly distributed
};

class FaultDice {
 public:
  FaultDice(const LinkFaults& faults, std::uint64_t seed) : faults_(faults), random_(seed) {}

  void SetLoss(double share) { faults_.loss = share; }
  void SetFaults(const LinkFaults& faults) { faults_ = faults; }
  [[nodiscard]] bool Loses() { return Happens(faults_.loss); }
  [[nodiscard]] bool Repeats() { return Happens(faults_.duplicate); }
  [[nodiscard]] std::int64_t DelayNs() {
    constexpr double kNsPerMs = 1e6;
    constexpr double kHeldBackMs = 1.5;
    double ms = faults_.delay_ms;
    if (faults_.jitter_ms > 0.0) {
      ms += faults_.jitter_ms * even_(random_);
    }
    if (Happens(faults_.reorder)) {
      ms += kHeldBackMs;
    }
    return static_cast<std::int64_t>(ms * kNsPerMs);
  }

 private:
  [[nodiscard]] bool Happens(double share) { return share > 0.0 && even_(random_) < share; }

  LinkFaults faults_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> even_{0.0, 1.0};
};

// One direction of the link.
template <typename Datagram>
class FaultyLink {
 public:
  FaultyLink(const LinkFaults& faults, std::uint64_t seed) : dice_(faults, seed) {
    on_the_way_.reserve(kManyOnTheWay);
  }

  void Put(const Datagram& datagram, std::int64_t now_ns) {
    if (dice_.Loses()) {
      return;
    }
    for (int copies = dice_.Repeats() ? 2 : 1; copies > 0; --copies) {
      on_the_way_.push_back({now_ns + dice_.DelayNs(), datagram});
    }
  }

  // Takes the earliest of the datagrams that are due by `now_ns`.
  [[nodiscard]] std::optional<Datagram> Take(std::int64_t now_ns) {
    auto earliest = on_the_way_.end();
    for (auto at = on_the_way_.begin(); at != on_the_way_.end(); ++at) {
      if (at->due_ns <= now_ns && (earliest == on_the_way_.end() || at->due_ns < earliest->due_ns)) {
        earliest = at;
      }
    }
    if (earliest == on_the_way_.end()) {
      return std::nullopt;
    }
    Datagram datagram = std::move(earliest->datagram);
    on_the_way_.erase(earliest);
    return datagram;
  }

  void SetLoss(double share) { dice_.SetLoss(share); }
  void SetFaults(const LinkFaults& faults) { dice_.SetFaults(faults); }
  void Clear() { on_the_way_.clear(); }

 private:
  static constexpr std::size_t kManyOnTheWay = 64;
  struct OnTheWay {
    std::int64_t due_ns;
    Datagram datagram;
  };
  FaultDice dice_;
  std::vector<OnTheWay> on_the_way_;
};

}  // namespace fovea::sim
