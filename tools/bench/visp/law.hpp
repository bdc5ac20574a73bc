// SPDX-License-Identifier: Apache-2.0
// ViSP's visual law behind plain arrays, because its headers need C++17.
#pragma once

#include <array>
#include <memory>

namespace fovea::bench {

// x, y of the normalised image, and the depth Z [m].
using VispPoints = std::array<std::array<double, 3>, 4>;
using VispTwist = std::array<double, 6>;  // of the camera, [v; w]

class VispLaw {
 public:
  VispLaw(const VispPoints& goal, double lambda);
  ~VispLaw();
  VispLaw(const VispLaw&) = delete;
  VispLaw& operator=(const VispLaw&) = delete;

  // vpServo::computeControlLaw.
  VispTwist Control(const VispPoints& points);
  // -lambda L^+ e, with ViSP's interaction matrix, error and pseudo-inverse.
  VispTwist Steps(const VispPoints& points, double smallest_ratio);

 private:
  struct Task;
  const double lambda_;
  std::unique_ptr<Task> task_;
};

}  // namespace fovea::bench
