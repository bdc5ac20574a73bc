#include "sim/run/run_figures.hpp"

#include <fmt/format.h>

#include "firmware/host/build_info.hpp"
#include "fovea/linux_rt/heap_counter.hpp"

namespace fovea::sim {

void FillTicks(const task::LoopCounters& counters, const linux_rt::TickMeter& meter, Summary& summary) {
  summary.ticks = counters.ticks;
  summary.overruns = counters.overruns;
  summary.missed_ticks = counters.missed_ticks;
  if (linux_rt::HeapCounterActive()) {
    summary.heap_allocations_in_tick = meter.heap_calls();
  }
  summary.page_faults_in_loop = meter.page_faults();
  summary.tick_ns_p50 = meter.durations().Percentile(0.5);
  summary.tick_ns_p99 = meter.durations().Percentile(0.99);
  summary.tick_ns_p999 = meter.durations().Percentile(0.999);
  summary.tick_ns_max = meter.durations().max_ns();
}

void FillFiles(RunFiles& files, Summary& summary) {
  summary.frames = files.frames();
  summary.frames_detected = files.frames_detected();
  summary.film_errors = files.EndFilms();
  summary.film_frames_dropped = files.film_frames_dropped();
  summary.log_entries_dropped = files.log_entries_dropped();
}

void FillFrameFailures(const vision::FrameFailures& failures, Summary& summary) {
  summary.frames_failed = failures.frames;
  summary.frame_failure = failures.first;
  if (summary.frames > 0 && failures.frames == summary.frames) {
    summary.converged = false;
    summary.verdict = fmt::format("not converged: none of {} pictures could be looked at ({})",
                                  summary.frames, failures.first);
  }
}

void FillTheory(const TheoryResult& theory, Summary& summary) {
  summary.theory = theory;
  summary.converged = summary.converged && theory.agrees;
  summary.verdict = summary.converged || !theory.agrees ? theory.verdict : summary.verdict;
}

void FillInterrupted(double at_s, double duration_s, Summary& summary) {
  summary.interrupted = true;
  summary.converged = false;
  summary.verdict = fmt::format("interrupted after {:.3f} s of {:g} s", at_s, duration_s);
}

void FillBuild(Summary& summary) {
  summary.servo = kServoLibraryHash;
  summary.git = kGitRevision;
  summary.version = kVersion;
}

}  // namespace fovea::sim
