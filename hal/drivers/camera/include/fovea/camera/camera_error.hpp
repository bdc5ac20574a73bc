// What a camera driver throws when it cannot be opened or set up as asked: one line, with the device in it.
#pragma once

#include <stdexcept>

namespace fovea::camera {

class CameraError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fovea::camera
