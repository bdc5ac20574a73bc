// What decides over a run beside the truth: its pictures, its theory, an early end.
#pragma once

#include "firmware/vision/detect/vision_task.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// Where no picture could be looked at, the run has not converged, whatever the truth says.
void FillFrameFailures(const vision::FrameFailures& failures, Summary& summary);
// Where the run's answer is known, the run has converged only if it agrees with it.
void FillTheory(const TheoryResult& theory, Summary& summary);
void FillInterrupted(double at_s, double duration_s, Summary& summary);

}  // namespace fovea::sim
