// Prints lines for the operator from its own thread: a stopped terminal delays no other thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace fovea::hw {

class Speaker {
 public:
  // Writes to the file descriptor `fd`, which stays open.
  explicit Speaker(int fd);
  // Waits for unwritten lines, but at most half a second.
  ~Speaker();
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;

  // From any thread that is not real-time. Never waits for the terminal; a line without room is dropped and
  // counted.
  void Say(const std::string& line);
  // Waits until all lines are written, at most for `most`.
  void Wait(std::chrono::milliseconds most);
  // Lines that were dropped or still wait.
  [[nodiscard]] std::uint64_t unsaid() const;

 private:
  struct Shared;
  static void SpeakAll(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this if the terminal stays stopped
};

}  // namespace fovea::hw
