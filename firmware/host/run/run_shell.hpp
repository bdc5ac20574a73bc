// A run of the servo, whoever runs it: the simulator at either pace, or the hardware target.
//
// It has what all of them have: mailbox, flight recorder, tick meter, loop, the records' hash, the folder and
// the summary's core. Log, summary.json and report are the same because no program wires them by itself. What
// a program knows alone it adds as an observer of records, as fields of its summary or as files: the
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

  // `step`: what the loop steps; `task`: the same, where its state can be looked at; null: it is on another
  // processor. Both are borrowed. `records`: ticks that may wait for TakeRecords. Throws as RunFolder.
  RunShell(task::ServoStep& step, task::ServoTask* task, std::size_t records, RunFolderConfig folder);
  RunShell(const RunShell&) = delete;
  RunShell& operator=(const RunShell&) = delete;

  // Before the threads run.
  // Called by TakeRecords for each record, in order; of several observers the first that was added first.
  void OnRecord(RecordObserver observer) { observers_.push_back(std::move(observer)); }
  // The ticks and their stages go to `track`, which is borrowed.
  void UseTrack(trace::Track& track);

  // From the servo's thread.
  void MakeThreadRealtime(const linux_rt::RealtimeOptions& options);
  // Where the loop's records go.
  [[nodiscard]] hal::Recorder& recorder();
  // The loop, ready to run. All are borrowed until EndLoop. `first`: gets each record in the tick, in place
  // of recorder(), and hands it on to that.
  task::ServoLoop& BeginLoop(hal::Arm& arm, hal::Clock& clock, hal::Recorder* first = nullptr);
  // Null before BeginLoop, and after EndLoop.
  [[nodiscard]] task::ServoLoop* loop() { return loop_ ? &*loop_ : nullptr; }
  // When nobody asks anything of the loop any more; not needed where arm and clock outlive the shell. Its
  // counters are kept.
  void EndLoop();

  // Measurements for the loop: from the vision thread, or from who hands them over late.
  [[nodiscard]] hal::FeatureMailbox& features() { return features_; }
  // From the vision thread. `more`: what else is drawn on the log's picture.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                const foxglove::ImageAnnotations& more = {});

  // From one thread, as mode and now_s: whatever the loop recorded since goes to hash, observers and log.
  void TakeRecords();
  [[nodiscard]] hal::Mode mode() const { return mode_; }  // of the last record taken
  [[nodiscard]] double now_s() const { return now_s_; }   // and its time, by the loop's clock; 0 before

  // Null where there is no log.
  [[nodiscard]] RunBook* book() { return folder_.book(); }

  // When the servo's thread is done: what the machine did not grant it.
  [[nodiscard]] const std::vector<std::string>& realtime_missing() const { return realtime_missing_; }

  // When the threads are done and all records are taken, once each and in this order. Fill completes the film
  // and says everything that RunFigures has. Write as RunFolder's.
  void Fill(RunFigures& figures);
  void Write(const std::string& summary_json, const RunBook::MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: the log is kept as far as it goes.
  void KeepLog() const { folder_.KeepLog(); }

 private:
  task::ServoTask* task_;
  RunFolder folder_;
  hal::FeatureMailbox features_;
  flight::FlightRecorder recorder_;
  linux_rt::TickMeter meter_;
  std::optional<trace::TickTrace> ticks_;  // around meter and recorder
  std::optional<task::ServoLoop> loop_;
  std::optional<task::LoopCounters> counters_;  // of a loop that was ended
  std::vector<std::string> realtime_missing_;
  // of the thread that takes the records
  log::RecordHash hash_;
  std::vector<RecordObserver> observers_;
  hal::Mode mode_ = hal::Mode::kBoot;
  double now_s_ = 0.0;
};

}  // namespace fovea::run
