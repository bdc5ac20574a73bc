// SPDX-License-Identifier: Apache-2.0
// Lets one other thread act on the world between two of its steps. The world's thread never waits for it.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <semaphore>

namespace fovea::sim {

class BetweenSteps {
 public:
  using Job = std::function<void()>;

  // From the other thread: the world's thread runs `job` after its present step. Returns when that is done.
  // False: the world made no step for `at_most`, and the job will not be run. `job` must not throw; the
  // world's thread may be a real-time one.
  [[nodiscard]] bool Do(const Job& job, std::chrono::milliseconds at_most) {
    job_ = &job;
    stage_.store(Stage::kAsked, std::memory_order_release);
    if (done_.try_acquire_for(at_most)) {
      return true;
    }
    Stage asked = Stage::kAsked;
    if (stage_.compare_exchange_strong(asked, Stage::kNone, std::memory_order_acq_rel)) {
      return false;
    }
    done_.acquire();  // it runs just now
    return true;
  }

  // From the world's thread, after each step. Without a job: one look.
  void Pass() {
    Stage asked = Stage::kAsked;
    if (stage_.load(std::memory_order_relaxed) == Stage::kAsked &&
        stage_.compare_exchange_strong(asked, Stage::kRuns, std::memory_order_acq_rel)) {
      (*job_)();
      stage_.store(Stage::kNone, std::memory_order_release);
      done_.release();
    }
  }

 private:
  enum class Stage { kNone, kAsked, kRuns };

  std::atomic<Stage> stage_{Stage::kNone};
  const Job* job_ = nullptr;
  std::binary_semaphore done_{0};
};

}  // namespace fovea::sim
