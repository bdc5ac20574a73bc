// SPDX-License-Identifier: Apache-2.0
// Prints text for a person from its own thread: a stopped terminal delays no other thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace fovea::linux_rt {

class Speaker {
 public:
  // Writes to the file descriptor `fd`, which stays open.
  explicit Speaker(int fd);
  // Waits for unwritten text, but at most half a second.
  ~Speaker();
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;

  // From any thread that is not real-time. Never waits for the terminal; a text without room is dropped and
  // counted. Say ends the line.
  void Say(const std::string& line) { Put(line + "\n"); }
  void Put(std::string text);
  // Waits until all is written, at most for `most`.
  void Wait(std::chrono::milliseconds most);
  // Texts that were dropped or still wait.
  [[nodiscard]] std::uint64_t unsaid() const;

 private:
  struct Shared;
  static void SpeakAll(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;  // with the thread, which may outlive this if the terminal stays stopped
};

}  // namespace fovea::linux_rt
