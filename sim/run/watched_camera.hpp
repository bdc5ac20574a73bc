// SPDX-License-Identifier: Apache-2.0
// Stands between a camera and its user: somebody else sees each frame, too.
#pragma once

#include <functional>
#include <utility>

#include "fovea/hal/camera.hpp"

namespace fovea::sim {

class WatchedCamera final : public hal::Camera {
 public:
  // Called with each frame, by the user's thread, before the user gets it. Must not throw.
  using Watcher = std::function<void(const hal::Frame& frame)>;

  // Borrows `camera`. `watcher` may be empty.
  WatchedCamera(hal::Camera& camera, Watcher watcher) : camera_(camera), watcher_(std::move(watcher)) {}

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override {
    const hal::Status status = camera_.Acquire(frame, timeout_ns);
    if (status.ok() && watcher_) {
      watcher_(frame);
    }
    return status;
  }

  hal::Camera& camera_;
  const Watcher watcher_;
};

}  // namespace fovea::sim
