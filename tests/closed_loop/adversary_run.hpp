// Robot time with an eye that means ill, in Bullet, judged by the simulator's truth: what may a stream of
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
  std::int64_t passed_ticks = 0;                // in which a limit was passed
  std::map<std::string, double> most;           // largest share used of each limit
  std::map<std::string, int> faults;            // latched, by name; none is the eye's to cause
  std::map<std::string, std::int64_t> intakes;  // what became of the measurements
  double lowest_mm = 1e9;                       // the lowest that camera and hand came above the table
  double fastest_target = 0.0;                  // as it was fed forward [m/s]
  std::string first;                            // when, and in which trick, something was passed first

  [[nodiscard]] bool Sound() const { return contact_ticks == 0 && passed_ticks == 0 && faults.empty(); }
};
std::string InWords(const AdversaryFigures& figures);

// `duration_s` of robot time from the start of the scenario `ball`. `on_progress` is told the share that is
// done, each second of robot time; may be empty.
AdversaryFigures RunAdversary(double duration_s, std::uint64_t seed,
                              const std::function<void(double share)>& on_progress);

}  // namespace fovea::test
