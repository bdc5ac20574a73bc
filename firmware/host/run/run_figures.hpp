// SPDX-License-Identifier: Apache-2.0
// The counters of every run, simulated or on hardware, and their fields in summary.json.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace fovea::linux_rt {
class TickMeter;
}
namespace fovea::task {
struct LoopCounters;
}

namespace fovea::run {

// What the log and the film took, and what they dropped.
struct BookFigures {
  std::uint64_t ticks_dropped = 0;
  std::uint64_t pictures = 0;
  std::uint64_t pictures_dropped = 0;
  std::uint64_t film_frames_dropped = 0;
  std::vector<std::string> film_errors;  // why an expected film is missing
};

struct RunFigures {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;         // ticks that began a whole period or more late
  std::uint64_t missed_ticks = 0;     // periods that passed without a tick
  std::uint64_t records_dropped = 0;  // ticks whose record was dropped
  std::uint64_t log_entries_dropped = 0;
  std::uint64_t log_pictures = 0;
  std::uint64_t log_pictures_dropped = 0;
  std::uint64_t film_frames_dropped = 0;                  // of all films
  std::vector<std::string> film_errors;                   // why an expected film is missing
  std::optional<std::uint64_t> heap_allocations_in_tick;  // none when the counter is not active
  std::uint64_t page_faults_in_loop = 0;
  std::int64_t tick_ns_p50 = 0;
  std::int64_t tick_ns_p99 = 0;
  std::int64_t tick_ns_p999 = 0;
  std::int64_t tick_ns_max = 0;
  std::vector<std::string> realtime_missing;  // missing real-time privileges
  std::string log_hash;                       // over all records except dropped ones
  std::string files_error;                    // why the files could not be written; not in summary.json
};

void FillTicks(const task::LoopCounters& counters, const linux_rt::TickMeter& meter, RunFigures& figures);
void FillBook(const BookFigures& book, RunFigures& figures);

// Adds the first field of every summary.json: the version of its fields.
void BeginSummary(nlohmann::ordered_json& json);
// Adds the fields of RunFigures under their names, and those of AddBuild.
void AddFigures(const RunFigures& figures, nlohmann::ordered_json& json);
// Adds the last fields: the build information of the program.
void AddBuild(nlohmann::ordered_json& json);

}  // namespace fovea::run
