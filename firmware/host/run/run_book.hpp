// What every run leaves behind, simulated or on hardware: log.mcap, camera.mp4, report.html and summary.json.
//
// They are written while the run goes on, and put in place when it is over. What only one kind of run leaves,
// as the truth of a simulated one, goes into the same log and folder.
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
#include "firmware/host/report/report.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "firmware/vision/detect/detection.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "foxglove/image.pb.h"
#include "foxglove/scene.pb.h"

namespace fovea::run {

// What a run is about.
struct RunFacts {
  std::string name;  // of its scenario or configuration
  std::string robot;
  std::vector<std::string> joint_names;
  config::ServoConfig servo;
  bool has_camera = true;
  vision::Intrinsics intrinsics;  // where there is a camera
  double target_radius = 0.0;     // of the ball that holds the target [m]; 0: there is none
  bool target_moves = false;
  double duration_s = 0.0;                          // 0: when nobody knows
  std::map<std::string, std::string> keys;          // every key of the run, and its value
  std::map<std::string, std::string> default_keys;  // and its default
  std::string command;                              // the command line that began it; "" when there was none
  std::vector<log::LinkFrame> frames;               // of the arm
  foxglove::SceneUpdate scene;                      // as a log's viewer draws it
};

struct RunBookOptions {
  std::vector<std::string> more_files;   // what such a run leaves in its folder beside the book's own files
  bool may_drop = true;                  // when the disk is slower than the run; else it waits
  std::size_t ring = 2048;               // ticks that may wait for the disk
  std::size_t most_images = 8;           // pictures that may wait to be encoded
  bool film = true;                      // camera.mp4
  double picture_rate_hz = HUGE_VAL;     // at most so many pictures are kept in the log; 0: none
  bool replayable = true;                // the servo's inputs are those that are recorded
  std::optional<std::int64_t> begin_ns;  // of the loop's clock; with the first record when not given
};

class RunBook {
 public:
  static constexpr const char* kSummary = "summary.json";

  // Holds the folder `out`. InputError when nothing can be written there; std::runtime_error when the
  // report's page is not there.
  RunBook(const std::filesystem::path& out, RunFacts facts, RunBookOptions options);

  // All that a run may leave in its folder, for the next to take away: the book's own files, and `more`.
  static std::vector<std::string> AllFiles(const std::vector<std::string>& more);

  // From the thread that empties the recorder.
  void AddRecord(const flight::FlightRecord& record);
  void AddKeyframe(const flight::Keyframe& keyframe);
  // From the vision thread. What is exposed before the log begins is left out. `more`: what else is drawn on
  // the log's picture.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                const foxglove::ImageAnnotations& more = {});
  // For what only this kind of run knows.
  [[nodiscard]] log::RunLog& log() { return log_; }
  // A path to write the file `name`, one of more_files, to while the run goes on.
  [[nodiscard]] std::filesystem::path BeginFile(const std::string& name) { return folder_.Begin(name); }

  // When the threads are done: completes the film, and says what was kept and what was not. A film that fails
  // is left out, and that is all.
  BookFigures EndFilm();

  // Puts everything in place, with `more` of the run's files before the summary. Throws what went wrong with
  // any of it; then the folder is as it was, but for a log that could not be written on: it stands there
  // alone.
  using MoreFiles = std::function<std::vector<config::OutputFile>()>;
  void Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
             const MoreFiles& more = {});
  // From any thread, when the process ends before Write is done: the log stands there alone, as far as it
  // goes.
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
  const std::vector<std::string> all_files_;  // that such a run may leave, for the next to take away
  const report::ReportPage page_;
  config::OutputFolder folder_;
  const std::filesystem::path log_path_;
  foxglove::ImageAnnotations goal_;  // drawn on every picture
  log::RunLog log_;
  std::atomic<bool> begun_{false};
  std::int64_t start_ns_ = 0;         // of the loop's clock; set before begun_
  std::int64_t last_ns_ = 0;          // of the last record
  bool has_ticks_ = false;            // there was one
  std::int64_t next_picture_ns_ = 0;  // of the vision thread
  std::uint64_t pictures_ = 0;
  bool has_film_ = false;              // and it is complete
  std::optional<film::EyeFilm> film_;  // drawn and encoded by a thread of its own
};

}  // namespace fovea::run
