// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/run/run_figures.hpp"

#include <nlohmann/json.hpp>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/build_info.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::run {
namespace {

// It rises when a field is renamed or removed, or changes its meaning. A new field needs no new version.
constexpr int kSummaryFormat = 1;

}  // namespace

void FillTicks(const task::LoopCounters& counters, const linux_rt::TickMeter& meter, RunFigures& figures) {
  figures.ticks = counters.ticks;
  figures.overruns = counters.overruns;
  figures.missed_ticks = counters.missed_ticks;
  if (linux_rt::HeapCounterActive()) {
    figures.heap_allocations_in_tick = meter.heap_calls();
  }
  figures.page_faults_in_loop = meter.page_faults();
  figures.tick_ns_p50 = meter.durations().Percentile(0.5);
  figures.tick_ns_p99 = meter.durations().Percentile(0.99);
  figures.tick_ns_p999 = meter.durations().Percentile(0.999);
  figures.tick_ns_max = meter.durations().max_ns();
}

void FillBook(const BookFigures& book, RunFigures& figures) {
  figures.log_entries_dropped = book.ticks_dropped;
  figures.log_pictures = book.pictures;
  figures.log_pictures_dropped = book.pictures_dropped;
  figures.film_frames_dropped = book.film_frames_dropped;
  figures.film_errors = book.film_errors;
}

void BeginSummary(nlohmann::ordered_json& json) { json["format"] = kSummaryFormat; }

void AddFigures(const RunFigures& figures, nlohmann::ordered_json& json) {
  json["ticks"] = figures.ticks;
  json["overruns"] = figures.overruns;
  json["missed_ticks"] = figures.missed_ticks;
  json["records_dropped"] = figures.records_dropped;
  json["log_entries_dropped"] = figures.log_entries_dropped;
  json["log_pictures"] = figures.log_pictures;
  json["log_pictures_dropped"] = figures.log_pictures_dropped;
  json["film_frames_dropped"] = figures.film_frames_dropped;
  json["film_errors"] = figures.film_errors;
  json["heap_allocations_in_tick"] = figures.heap_allocations_in_tick
                                         ? nlohmann::ordered_json(*figures.heap_allocations_in_tick)
                                         : nlohmann::ordered_json(nullptr);
  json["page_faults_in_loop"] = figures.page_faults_in_loop;
  json["tick_ns"] = {{"p50", figures.tick_ns_p50},
                     {"p99", figures.tick_ns_p99},
                     {"p999", figures.tick_ns_p999},
                     {"max", figures.tick_ns_max}};
  json["realtime_missing"] = figures.realtime_missing;
  json["log_hash"] = figures.log_hash;
  AddBuild(json);
}

void AddBuild(nlohmann::ordered_json& json) {
  json["servo"] = kServoLibraryHash;
  json["git"] = kGitRevision;
  json["version"] = kVersion;
}

}  // namespace fovea::run
