// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/run/run_shell.hpp"

#include <utility>

namespace fovea::run {

// Only a log needs digests and keyframes.
RunShell::RunShell(task::ServoStep& step, task::ServoTask* task, std::size_t records, RunFolderConfig folder)
    : task_(task),
      folder_(std::move(folder)),
      recorder_(step, folder_.book() != nullptr ? task : nullptr, records) {}

void RunShell::UseTrack(trace::Track& track) {
  ticks_.emplace(track, meter_, recorder_);
  if (task_ != nullptr) {
    task_->UseProbe(&*ticks_);
  }
}

void RunShell::MakeThreadRealtime(const linux_rt::RealtimeOptions& options) {
  realtime_missing_ = linux_rt::MakeThreadRealtime(options);
}

hal::Recorder& RunShell::recorder() { return ticks_ ? static_cast<hal::Recorder&>(*ticks_) : recorder_; }

task::ServoLoop& RunShell::BeginLoop(hal::Arm& arm, hal::Clock& clock, hal::Recorder* first) {
  hal::TickProbe& probe = ticks_ ? static_cast<hal::TickProbe&>(*ticks_) : meter_;
  task::ServoLoop& loop =
      loop_.emplace(recorder_, arm, clock, features_, first != nullptr ? *first : recorder(), probe);
  if (planner_ != nullptr) {
    loop.UsePlanner(*planner_);
  }
  return loop;
}

void RunShell::EndLoop() {
  if (loop_) {
    counters_ = loop_->counters();
    loop_.reset();
  }
  if (ticks_ && task_ != nullptr) {
    task_->UseProbe(nullptr);
  }
}

void RunShell::AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                        const foxglove::ImageAnnotations& more) {
  if (RunBook* book = folder_.book()) {
    book->AddFrame(frame, detection, more);
  }
}

void RunShell::TakeRecords() {
  RunBook* book = folder_.book();
  const auto take = [&](const flight::FlightRecord& flown) {
    hash_.Add(flown.record);
    mode_ = flown.record.mode;
    now_s_ = static_cast<double>(flown.record.stamp_ns) * 1e-9;
    for (const RecordObserver& observer : observers_) {
      observer(flown);
    }
    if (book != nullptr) {
      book->AddRecord(flown);
    }
  };
  recorder_.Drain(take, [&](const flight::Keyframe& keyframe) {
    if (book != nullptr) {
      book->AddKeyframe(keyframe);
    }
  });
}

void RunShell::Fill(RunFigures& figures) {
  if (loop_) {
    counters_ = loop_->counters();
  }
  if (counters_) {
    FillTicks(*counters_, meter_, figures);
  }
  if (RunBook* book = folder_.book()) {
    FillBook(book->EndFilm(), figures);
  }
  figures.records_dropped = recorder_.dropped();
  figures.realtime_missing = realtime_missing_;
  figures.log_hash = hash_.Finish();
}

void RunShell::Write(const std::string& summary_json, const RunBook::MoreFiles& more) {
  folder_.Write(summary_json, meter_.durations(), more);
}

}  // namespace fovea::run
