// What a run with a fault came to: what noticed it and when, what the servo did, how much of each limit was
// used, and how it ended.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea::matrix {

enum class End {
  kRecovered,  // the goal is kept again, for half a second at least
  kSafeStop,   // in Fault, brakes closed, at rest
  kHeld,       // in Hold, at rest
  kUndefined,  // none of these
};
const char* Name(End end);

struct Outcome {
  std::string noticed_by;                // "": by nothing, nor was there need to
  std::optional<int> ticks;              // from the fault's beginning to then
  std::string reaction;                  // of the modes, or of limits; "": none
  std::map<std::string, double> limits;  // largest share used of each
  std::vector<std::string> exceeded;     // of the arm's own limits
  std::uint64_t contact_ticks = 0;
  End end = End::kUndefined;
  std::string end_detail;  // mode and reason at the end
  std::optional<double>
      recovered_after_s;  // from the fault's end until the goal is kept; 0: it was throughout

  [[nodiscard]] bool Failed() const { return end == End::kUndefined || !exceeded.empty(); }
};

// The arm's own limits among those of a summary. They are taken from the simulator's truth and the command in
// force, never from what was measured.
const std::vector<std::string>& PhysicalLimits();

// Judges `run`, a summary with the fault `key` in `injected`, beside `without`, that of the same run with
// `nothing` from the same time on. std::runtime_error when one of them is no such summary.
Outcome Judge(const std::string& key, const nlohmann::json& run, const nlohmann::json& without);

}  // namespace fovea::matrix
