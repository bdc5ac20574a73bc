// SPDX-License-Identifier: Apache-2.0
// Adjusts a run's verdict for failed pictures, the analytic answer and an early end.
#pragma once

#include "firmware/vision/detect/vision_task.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// If vision failed on all pictures, the run has not converged, whatever the truth is.
void FillFrameFailures(const vision::FrameFailures& failures, Summary& summary);
// A run with an analytic answer has converged only if it agrees with that answer.
void FillTheory(const TheoryResult& theory, Summary& summary);
void FillInterrupted(double at_s, std::optional<double> duration_s, Summary& summary);

}  // namespace fovea::sim
