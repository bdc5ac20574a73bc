// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/speaker.hpp"

#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

namespace fovea::linux_rt {
namespace {

constexpr std::size_t kMostWaiting = 256;  // texts
constexpr int kPollMs = 50;
constexpr std::chrono::milliseconds kPatience{500};

}  // namespace

struct Speaker::Shared {
  // Its own descriptor: the thread may outlive the speaker, and then the given number may belong to another
  // file.
  explicit Shared(int given) : fd(dup(given)) {}
  ~Shared() {
    if (fd >= 0) {
      close(fd);
    }
  }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  const int fd;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::string> texts;  // the first is being written
  std::uint64_t dropped = 0;
  bool closed = false;     // no more texts
  bool abandoned = false;  // waiting texts are dropped too

  bool IsAbandoned() {
    const std::lock_guard lock(mutex);
    return abandoned;
  }

  // False when the text could not be written.
  bool Write(std::string_view text) {
    while (fd >= 0 && !text.empty() && !IsAbandoned()) {
      pollfd room{fd, POLLOUT, 0};
      if (poll(&room, 1, kPollMs) <= 0) {
        continue;
      }
      // A pipe with room takes PIPE_BUF bytes without blocking.
      const ssize_t written = write(fd, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
      if (written >= 0) {
        text.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno != EINTR && errno != EAGAIN) {
        return false;
      }
    }
    return text.empty();
  }
};

Speaker::Speaker(int fd) : shared_(std::make_shared<Shared>(fd)) {
  // Signals are for other threads: the new thread inherits this mask.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  // Detached: a write to a stopped terminal may never return.
  std::thread([shared = shared_] { SpeakAll(shared); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Speaker::~Speaker() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->closed = true;
  }
  shared_->changed.notify_all();
  Wait(kPatience);
  const std::lock_guard lock(shared_->mutex);
  shared_->abandoned = true;
}

void Speaker::Put(std::string text) {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->texts.size() >= kMostWaiting) {
      ++shared_->dropped;
      return;
    }
    shared_->texts.push_back(std::move(text));
  }
  shared_->changed.notify_all();
}

void Speaker::Wait(std::chrono::milliseconds most) {
  std::unique_lock lock(shared_->mutex);
  shared_->changed.wait_for(lock, most, [this] { return shared_->texts.empty(); });
}

std::uint64_t Speaker::unsaid() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->dropped + shared_->texts.size();
}

void Speaker::SpeakAll(const std::shared_ptr<Shared>& shared) {
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->changed.wait(lock, [&] { return shared->closed || !shared->texts.empty(); });
    if (shared->texts.empty() || shared->abandoned) {
      return;
    }
    const std::string text = shared->texts.front();
    lock.unlock();
    const bool said = shared->Write(text);
    lock.lock();
    shared->texts.pop_front();
    shared->dropped += said ? 0U : 1U;
    shared->changed.notify_all();
  }
}

}  // namespace fovea::linux_rt
