// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/findings/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::findings {
namespace {

double ShareOf(int part, int all) { return all > 0 ? static_cast<double>(part) / all : 0.0; }

}  // namespace

double Coverage::KnownShare() const { return ShareOf(known, runs); }

double Coverage::WithinShare() const { return ShareOf(within_two_sigma, known); }

Coverage CoverageOf(const std::vector<Finding>& findings) {
  Coverage coverage;
  coverage.runs = static_cast<int>(findings.size());
  std::vector<double> sigmas;
  double squares = 0.0;
  for (const Finding& finding : findings) {
    if (!finding.known) {
      continue;
    }
    const double error = std::fabs(finding.difference - finding.truth);
    sigmas.push_back(finding.sigma);
    squares += error * error;
    coverage.error_largest = std::max(coverage.error_largest, error);
    coverage.within_two_sigma += error <= 2.0 * finding.sigma ? 1 : 0;
  }
  coverage.known = static_cast<int>(sigmas.size());
  if (coverage.known > 0) {
    std::sort(sigmas.begin(), sigmas.end());
    coverage.sigma_median = sigmas[sigmas.size() / 2];
    coverage.sigma_largest = sigmas.back();
    coverage.error_rms = std::sqrt(squares / coverage.known);
  }
  return coverage;
}

bool Meets(const Coverage& coverage, const Goal& goal) {
  return coverage.KnownShare() >= goal.known_least && coverage.WithinShare() >= goal.within_least &&
         coverage.WithinShare() <= goal.within_most && coverage.sigma_largest <= goal.sigma_most;
}

}  // namespace fovea::findings
