// SPDX-License-Identifier: Apache-2.0
// Thrown when a camera cannot be opened or set up as configured: one line that names the device.
#pragma once

#include <stdexcept>

namespace fovea::camera {

class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fovea::camera
