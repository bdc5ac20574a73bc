// SPDX-License-Identifier: Apache-2.0
// A run of the servo in any program: the simulator at either pace, or the hardware target.
//
// RunShell has the common parts: mailbox, flight recorder, tick meter, loop, the records' hash, the folder
// and the summary's core. All programs share this wiring, so their log, summary.json and report are the same.
// A program adds its own data with an observer of records, as fields of its summary or as files: the
// simulator its truth and verdict, the hardware target its operator.
//
//   vision   -> features() -> loop -> flight recorder -> ring -> TakeRecords -> hash, observers, log
//            -> AddFrame() -> log and film                       Fill, Write -> summary.json, report.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/record_hash.hpp"
#include "firmware/host/recording/trace/tick_trace.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "firmware/host/run/run_folder.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::run {

class RunShell {
 public:
  using RecordObserver = std::function<void(const flight::FlightRecord& record)>;

  // `step`: what the loop steps. `task`: the servo behind `step`; null if it runs on another processor.
  // Borrows both. `records`: ticks that may wait for TakeRecords. Throws like RunFolder.
  RunShell(task::ServoStep& step, task::ServoTask* task, std::size_t records, RunFolderConfig folder);
  RunShell(const RunShell&) = delete;
  RunShell& operator=(const RunShell&) = delete;

  // Call the next two before the threads run.
  // TakeRecords calls `observer` for each record, in order; several observers in the order of their addition.
  void OnRecord(RecordObserver observer) { observers_.push_back(std::move(observer)); }
  // Traces the ticks and their stages on `track`, which is borrowed.
  void UseTrack(trace::Track& track);

  // From the servo's thread.
  void MakeThreadRealtime(const linux_rt::RealtimeOptions& options);
  // The recorder that takes the loop's records.
  [[nodiscard]] hal::Recorder& recorder();
  // Returns the loop, ready to run. Borrows all until EndLoop. `first`: gets each record in the tick instead
  // of recorder(), and must pass it on to recorder().
  task::ServoLoop& BeginLoop(hal::Arm& arm, hal::Clock& clock, hal::Recorder* first = nullptr);
  // Call before BeginLoop: the planner's end of the loop's line, which is borrowed.
  void UsePlanner(trajectory::PlanBox& planner) { planner_ = &planner; }
  // Null before BeginLoop, and after EndLoop.
  [[nodiscard]] task::ServoLoop* loop() { return loop_ ? &*loop_ : nullptr; }
  // Call when no thread uses the loop any more; not needed if arm and clock outlive the shell. Keeps the
  // loop's counters.
  void EndLoop();

  // Measurements for the loop: from the vision thread, or from an object that delays them.
  [[nodiscard]] hal::FeatureMailbox& features() { return features_; }
  // From the vision thread. `more`: further annotations of the log's picture.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                const foxglove::ImageAnnotations& more = {});

  // From one thread, like mode and now_s: passes all new records to hash, observers and log.
  void TakeRecords();
  [[nodiscard]] hal::Mode mode() const { return mode_; }  // of the last record taken
  [[nodiscard]] double now_s() const { return now_s_; }   // its time, by the loop's clock; 0 before the first

  // Durations of the ticks since the last call, from one thread; nothing if no tick came.
  [[nodiscard]] std::optional<linux_rt::RecentDurations::Summary> NewTickDurations() {
    return meter_.recent().TakeNew();
  }

  // Null if there is no log.
  [[nodiscard]] RunBook* book() { return folder_.book(); }

  // The missing real-time privileges of the servo's thread. Call when that thread is done.
  [[nodiscard]] const std::vector<std::string>& realtime_missing() const { return realtime_missing_; }

  // Call when the threads are done and all records are taken, once each and in this order. Fill completes the
  // film and sets all fields of RunFigures. Write is that of RunFolder.
  void Fill(RunFigures& figures);
  void Write(const std::string& summary_json, const RunBook::MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: keeps only the incomplete log.
  void KeepLog() const { folder_.KeepLog(); }

 private:
  task::ServoTask* task_;
  RunFolder folder_;
  hal::FeatureMailbox features_;
  trajectory::PlanBox* planner_ = nullptr;
  flight::FlightRecorder recorder_;
  linux_rt::TickMeter meter_;
  std::optional<trace::TickTrace> ticks_;  // around meter and recorder
  std::optional<task::ServoLoop> loop_;
  std::optional<task::LoopCounters> counters_;  // of an ended loop
  std::vector<std::string> realtime_missing_;
  // Used only by the thread that takes the records
  log::RecordHash hash_;
  std::vector<RecordObserver> observers_;
  hal::Mode mode_ = hal::Mode::kBoot;
  double now_s_ = 0.0;
};

}  // namespace fovea::run
