// SPDX-License-Identifier: Apache-2.0
// Runs the arm in Bullet with an adversarial camera, judged by the simulator's truth: what can a stream of
// measurements make the arm do?
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace fovea::test {

struct AdversaryFigures {
  double hours = 0.0;  // of robot time
  std::int64_t tracking_ticks = 0;
  std::int64_t contact_ticks = 0;
  std::int64_t passed_ticks = 0;                // beyond a limit
  std::map<std::string, double> most;           // largest share used of each limit
  std::map<std::string, int> faults;            // latched, by name; measurements must cause none
  std::map<std::string, std::int64_t> intakes;  // measurements by what became of them
  double lowest_mm = 1e9;                       // smallest clearance of hand, camera and links to the table
  double fastest_target = 0.0;                  // largest speed fed forward [m/s]
  std::string first;                            // the first violation, contact or fault: its time and trick

  [[nodiscard]] bool Sound() const { return contact_ticks == 0 && passed_ticks == 0 && faults.empty(); }
};
std::string InWords(const AdversaryFigures& figures);

// Runs `duration_s` of robot time from the start of the scenario `ball`. Calls `on_progress` with the share
// done after each second of robot time; it may be empty.
AdversaryFigures RunAdversary(double duration_s, std::uint64_t seed,
                              const std::function<void(double share)>& on_progress);

}  // namespace fovea::test
