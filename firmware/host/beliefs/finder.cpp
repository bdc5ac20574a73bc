// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/finder.hpp"

#include <utility>

namespace fovea::beliefs {

Finder::Finder(const config::ServoConfig& config, const Configured& configured, const FinderConfig& finder)
    : waits_(finder.waits && finder.learns.Any()),
      estimates_(finder.learns.Any() || finder.is_shown),
      learner_(config, finder.learns),
      watch_(config, configured),
      thread_([this](const std::stop_token& stop) { Work(stop); }) {}

Finder::~Finder() = default;

void Finder::Add(const hal::TickRecord& record) {
  learner_.Note(record);
  job_.records.push_back(record);
  newest_tick_ = record.tick;
  if (record.tick < next_tick_) {
    return;
  }
  next_tick_ = record.tick - record.tick % kEveryTicks + kEveryTicks;
  const bool is_free = !begun_tick_.has_value();
  if (estimates_ && is_free) {
    begun_tick_ = record.tick;
  }
  Hand(estimates_ && is_free);
}

std::vector<config::Tuning> Finder::TakeRequests() {
  if (!begun_tick_ || (waits_ && newest_tick_ < *begun_tick_ + kDueTicks)) {
    return {};
  }
  std::optional<Findings> findings = TakeResult(waits_);
  if (!findings) {
    return {};
  }
  begun_tick_.reset();
  now_ = std::move(findings);
  std::vector<config::Tuning> requests = learner_.Decide(*now_);
  now_->learnt = learner_.corrections();
  return requests;
}

void Finder::Act() {
  const std::lock_guard lock(loop_mutex_);
  if (loop_ == nullptr) {
    return;
  }
  for (const config::Tuning& request : TakeRequests()) {
    static_cast<void>(loop_->Ask(request));
  }
}

void Finder::UseLoop(task::ServoLoop* loop) {
  const std::lock_guard lock(loop_mutex_);
  loop_ = loop;
}

Findings Finder::Finish() {
  if (begun_tick_) {
    static_cast<void>(TakeResult(true));
    begun_tick_.reset();
  }
  Hand(true);
  Findings findings = TakeResult(true).value();
  findings.learnt = learner_.corrections();
  return findings;
}

// Gives the thread the records that it does not have yet.
void Finder::Hand(bool estimate) {
  Job job = std::exchange(job_, {});
  job.estimate = estimate;
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

std::optional<Findings> Finder::TakeResult(bool wait) {
  std::unique_lock lock(mutex_);
  if (wait) {
    changed_.wait(lock, [this] { return result_.has_value(); });
  }
  return std::exchange(result_, std::nullopt);
}

void Finder::Work(const std::stop_token& stop) {
  while (true) {
    std::vector<Job> jobs;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return !jobs_.empty(); })) {
        return;
      }
      jobs = std::exchange(jobs_, {});
    }
    for (const Job& job : jobs) {
      for (const hal::TickRecord& record : job.records) {
        watch_.Add(record);
      }
      if (job.estimate) {
        Findings findings = watch_.Finish();
        const std::lock_guard lock(mutex_);
        result_ = std::move(findings);
        changed_.notify_all();
      }
    }
  }
}

}  // namespace fovea::beliefs
