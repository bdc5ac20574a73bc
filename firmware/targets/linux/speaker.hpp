// Lines for a person, said by a thread of its own: a terminal that stands still delays nobody.
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
  // Waits for what is still to be said, but not for long.
  ~Speaker();
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;

  // From any thread that need not be real-time. Never waits; a line that finds no place is dropped and
  // counted.
  void Say(const std::string& line);
  // Waits until all is said, at most for `most`.
  void Wait(std::chrono::milliseconds most);
  // Lines that were dropped, or wait.
  [[nodiscard]] std::uint64_t unsaid() const;

 private:
  struct Shared;
  static void SpeakAll(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this when the terminal never goes on
};

}  // namespace fovea::hw
