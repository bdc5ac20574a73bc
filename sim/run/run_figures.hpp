// What the parts of a run counted, written into its summary.
#pragma once

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/vision/detect/vision_task.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "sim/run/files.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

void FillTicks(const task::LoopCounters& counters, const linux_rt::TickMeter& meter, Summary& summary);
// Ends the films, which may tell why one is not there.
void FillFiles(RunFiles& files, Summary& summary);
// Where no picture could be looked at, the run has not converged, whatever the truth says.
void FillFrameFailures(const vision::FrameFailures& failures, Summary& summary);
// Where the run's answer is known, the run has converged only if it agrees with it.
void FillTheory(const TheoryResult& theory, Summary& summary);
void FillInterrupted(double at_s, double duration_s, Summary& summary);
void FillBuild(Summary& summary);

}  // namespace fovea::sim
