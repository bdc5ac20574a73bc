// SPDX-License-Identifier: Apache-2.0
// The commands that a person types into `fovea-sim serve`, one per line.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace fovea::sim {

struct ServeKey {
  enum class Kind {
    kStop,     // "s": press or release the stop button
    kGuide,    // "g": press or release the enabling button at the hand
    kPull,     // "f X Y Z": pull the hand from now on [N, in axes of the base]
    kHang,     // "h": make the robot hang, or continue
    kUnknown,  // anything else
  };
  Kind kind = Kind::kUnknown;
  Eigen::Vector3d force_B = Eigen::Vector3d::Zero();  // for kPull
};

[[nodiscard]] ServeKey ParseServeKey(const std::string& line);

// Reads standard input without waiting. Stops reading after an error, the end of input or an endless line.
class ServeKeys {
 public:
  // The next typed line; none if there is no complete line.
  [[nodiscard]] std::optional<ServeKey> Next();

 private:
  [[nodiscard]] bool FillBuffer();

  std::string buffer_;
  bool closed_ = false;
};

}  // namespace fovea::sim
