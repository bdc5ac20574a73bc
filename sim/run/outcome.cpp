// SPDX-License-Identifier: Apache-2.0
#include "sim/run/outcome.hpp"

#include <fmt/format.h>

namespace fovea::sim {

void FillFrameFailures(const vision::FrameFailures& failures, Summary& summary) {
  summary.frames_failed = failures.frames;
  summary.frame_failure = failures.first;
  if (summary.frames > 0 && failures.frames == summary.frames) {
    summary.converged = false;
    summary.verdict =
        fmt::format("not converged: vision failed on all {} pictures ({})", summary.frames, failures.first);
  }
}

void FillTheory(const TheoryResult& theory, Summary& summary) {
  summary.theory = theory;
  summary.converged = summary.converged && theory.agrees;
  summary.verdict = summary.converged || !theory.agrees ? theory.verdict : summary.verdict;
}

void FillInterrupted(double at_s, std::optional<double> duration_s, Summary& summary) {
  summary.interrupted = true;
  summary.converged = false;
  summary.verdict = duration_s ? fmt::format("interrupted after {:.3f} s of {:g} s", at_s, *duration_s)
                               : fmt::format("ended by its operator after {:.3f} s", at_s);
}

}  // namespace fovea::sim
