// What `pkg-config fovea` says is enough to compile and link the servo with.
#include <cstdio>
#include <memory>

#include "fovea/servo_task.hpp"

int main() {
  const auto servo = std::make_unique<fovea::task::ServoTask>();
  // A configuration without an arm is refused: it is the library's own code that says so.
  const bool refused = !servo->Init(fovea::config::ServoConfig{}).ok();
  std::printf("%s\n", refused ? "refused" : "taken");
  return refused ? 0 : 1;
}
