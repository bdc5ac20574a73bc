// SPDX-License-Identifier: Apache-2.0
// Calls on their way from the server's thread to the run's thread, and their answers on the way back:
// bounded.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "firmware/host/live/calls.hpp"

namespace fovea::live {

// Where the answer of a call goes.
struct ReturnAddress {
  enum class Kind { kNobody, kService, kParameter };
  Kind kind = Kind::kNobody;
  std::uint64_t viewer = 0;
  std::uint32_t service = 0;  // of kService: the protocol's ids of service and call
  std::uint32_t call = 0;
  std::uint64_t group = 0;  // of kParameter: all of one message
};

struct PendingCall {
  ReturnAddress from;
  Call call;
};

struct AnsweredCall {
  ReturnAddress from;
  Request request;
  Answer answer;
};

class CallQueue {
 public:
  explicit CallQueue(std::size_t most) : most_(most) {}

  // False when too many wait. A pose of the dragged target takes the place of one that waits as the last. The
  // end of a control and a stop always have room: each viewer has at most one of each waiting.
  [[nodiscard]] bool Add(PendingCall pending);
  std::deque<PendingCall> TakeAll();
  [[nodiscard]] bool WaitForOne(std::chrono::milliseconds at_most);

  void AddAnswer(AnsweredCall answered);
  std::vector<AnsweredCall> TakeAnswers();

 private:
  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable added_;
  std::deque<PendingCall> calls_;
  std::vector<AnsweredCall> answers_;
};

}  // namespace fovea::live
