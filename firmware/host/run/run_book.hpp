// SPDX-License-Identifier: Apache-2.0
// The files of every run, simulated or on hardware: log.mcap, camera.mp4, report.html and summary.json.
//
// They are written during the run and put in place at its end. Data of only one kind of run, such as the
// truth of a simulated one, goes into the same log and folder.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/film/eye_film.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/run_messages.hpp"
#include "firmware/host/report/report.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "firmware/vision/detection.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"

namespace fovea::run {

// The facts of a run.
struct RunFacts {
  std::string name;  // of its scenario or configuration
  std::string robot;
  std::vector<std::string> joint_names;
  config::ServoConfig servo;
  bool has_camera = true;
  vision::Intrinsics intrinsics;  // if there is a camera
  double target_radius = 0.0;     // of the sphere that encloses the target [m]; 0: no target
  bool target_moves = false;
  double duration_s = 0.0;                          // 0: unknown
  std::map<std::string, std::string> keys;          // the value of every key, by its name
  std::map<std::string, std::string> default_keys;  // the default of every key, by its name
  std::string command;                              // the command line that started it; "" if there is none
  std::vector<log::LinkFrame> frames;               // of the arm
  foxglove::SceneUpdate scene;                      // for a log's viewer
};

// What the message /setup contains. `start_ns`: when the run begins, by the loop's clock.
log::RunSetup SetupOf(const RunFacts& facts, std::int64_t start_ns);

struct RunBookOptions {
  std::vector<std::string> more_files;   // files of such a run beside the book's own files
  bool may_drop = true;                  // when the disk is slower than the run; false: the run waits
  std::size_t ring = 2048;               // ticks that may wait for the disk
  std::size_t most_images = 8;           // pictures that may wait to be encoded
  bool film = true;                      // camera.mp4
  double picture_rate_hz = HUGE_VAL;     // the log keeps at most this rate of pictures; 0: none
  bool replayable = true;                // the recorded inputs are the servo's, so a replay is possible
  std::optional<std::int64_t> begin_ns;  // start, by the loop's clock; none: at the first record
  log::LogTap tap;                       // gets every message of the log, on the log's thread
};

class RunBook {
 public:
  static constexpr const char* kSummary = "summary.json";

  // Locks the folder `out`. InputError when nothing can be written there; std::runtime_error when the page of
  // the report is missing.
  RunBook(const std::filesystem::path& out, RunFacts facts, RunBookOptions options);

  // All files that a run may leave in its folder, for the next run to remove: the book's own, and `more`.
  static std::vector<std::string> AllFiles(const std::vector<std::string>& more);

  // From the thread that empties the recorder.
  void AddRecord(const flight::FlightRecord& record);
  void AddKeyframe(const flight::Keyframe& keyframe);
  // From the vision thread. Skips frames that were exposed before the log began. `more`: further annotations
  // of the log's picture.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                const foxglove::ImageAnnotations& more = {});
  // For data of only this kind of run.
  [[nodiscard]] log::RunLog& log() { return log_; }
  // Where the log is written during the run.
  [[nodiscard]] const std::filesystem::path& log_path() const { return log_path_; }
  // A path for writing the file `name`, one of more_files, during the run.
  [[nodiscard]] std::filesystem::path BeginFile(const std::string& name) { return folder_.Begin(name); }

  // Call when the threads are done: completes the film, and returns what was kept and what was dropped. A
  // film that fails is left out; that is its only effect.
  BookFigures EndFilm();

  // Puts all files in place, with the files of `more` before the summary. Throws any error. Then the folder
  // contains only the log, complete or up to where writing it failed.
  using MoreFiles = std::function<std::vector<config::OutputFile>()>;
  void Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
             const MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: keeps only the incomplete log.
  void KeepLog() const;

 private:
  void Begin(std::int64_t start_ns);
  void KeepPicture(const hal::Frame& frame, const vision::Detection& detection,
                   const foxglove::ImageAnnotations& more);
  [[nodiscard]] bool IsPictureDue(std::int64_t stamp_ns);
  void WriteAll(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
                const MoreFiles& more);

  const RunFacts facts_;
  const RunBookOptions options_;
  const std::vector<std::string> all_files_;  // that such a run may leave, for the next run to remove
  const report::ReportPage page_;
  config::OutputFolder folder_;
  const std::filesystem::path log_path_;
  foxglove::ImageAnnotations goal_;  // drawn on every picture
  log::RunLog log_;
  std::atomic<bool> begun_{false};
  std::int64_t start_ns_ = 0;         // of the loop's clock; set before begun_
  std::int64_t last_ns_ = 0;          // of the last record
  bool has_ticks_ = false;            // there was a record
  std::int64_t next_picture_ns_ = 0;  // of the vision thread
  std::uint64_t pictures_ = 0;
  bool has_film_ = false;              // the film is complete
  std::optional<film::EyeFilm> film_;  // drawn and encoded by its own thread
};

}  // namespace fovea::run
