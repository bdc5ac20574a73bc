// What a person types at `fovea-sim serve`, a word a line.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace fovea::sim {

struct ServeKey {
  enum class Kind {
    kStop,     // "s": the stop button, pressed or released
    kGuide,    // "g": the enabling button at the hand, pressed or released
    kPull,     // "f X Y Z": a pull at the hand from now on [N, in axes of the base]
    kHang,     // "h": the robot hangs, or goes on
    kUnknown,  // anything else
  };
  Kind kind = Kind::kUnknown;
  Eigen::Vector3d force_B = Eigen::Vector3d::Zero();  // of kPull
};

[[nodiscard]] ServeKey ParseServeKey(const std::string& line);

// Standard input, never waited for. What cannot be read, or has ended, is not looked at again.
class ServeKeys {
 public:
  // The next line that was typed.
  [[nodiscard]] std::optional<ServeKey> Next();

 private:
  [[nodiscard]] bool FillBuffer();

  std::string buffer_;
  bool closed_ = false;
};

}  // namespace fovea::sim
