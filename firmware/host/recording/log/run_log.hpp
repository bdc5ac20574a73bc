// SPDX-License-Identifier: Apache-2.0
// A run's log.mcap: filled by the threads of a run, written by its own thread.
//
// Data of each tick goes through bounded rings without locks, other data through a bounded queue. From the
// ticks the log derives the messages for viewers: modes and faults as text, and the poses of all frames.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <vector>

#include "firmware/core/model/arm_model.hpp"
#include "firmware/host/recording/log/log_tap.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"

namespace google::protobuf {
class Message;
}

namespace fovea::log {

class LogFile;
class TickWriter;

// A frame of the arm: fixed to the link that joint `joint` moves, or to B when `joint` is -1.
struct LinkFrame {
  std::string name;
  int joint = -1;
  model::Pose X_LnF;  // in the frame L_joint of the model, or in B
};

inline constexpr int kJpegQuality = 80;  // of pictures, unless told otherwise

struct RunLogConfig {
  std::filesystem::path path;
  std::string library;  // name of the writing program
  model::ArmModel arm;
  std::vector<LinkFrame> frames;  // of /tf, including the camera's
  // When the disk is slower than the run: drop ticks, samples and pictures and count them (true), or wait
  // (false).
  bool may_drop = false;
  std::size_t ring = 2048;      // ticks, and samples, that may wait: two seconds of them
  std::size_t most_images = 8;  // pictures that may wait to be encoded
  int jpeg_quality = kJpegQuality;
  LogTap tap;  // gets every message on the log's thread, also when the file fails
};

// Data that only a simulator knows; see Truth in firmware/host/recording/log/proto/fovea/run.proto.
struct TruthSample {
  std::int64_t stamp_ns = 0;
  std::array<double, 3> p_BO{};
  std::array<double, 3> p_BC{};
  double error_px = 0.0;
  double error_mm = 0.0;
  std::array<double, 4> q_BO{1.0, 0.0, 0.0, 0.0};  // w, x, y, z
};

class RunLog {
 public:
  // Creates the file. std::runtime_error when it cannot.
  explicit RunLog(const RunLogConfig& config);
  // Ends the thread. An unfinished file stays readable up to the last written chunk.
  ~RunLog();
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

  // From one thread. Real-time when the log may drop.
  void AddTick(const hal::TickRecord& record, const ReplayData& data = {});
  // From one thread. Real-time when the log may drop.
  void AddTruth(const TruthSample& sample);
  // From any thread that is not real-time. For few and small messages: one is dropped only if the log may
  // drop and a thousand already wait because the disk hangs.
  void Add(const char* topic, std::int64_t time_ns, const google::protobuf::Message& message);
  // Copies the pixels; the log's thread encodes them as JPEG.
  void AddImage(const hal::Frame& frame);
  void AddMetadata(const std::string& name, const std::map<std::string, std::string>& entries);
  void AddAttachment(const std::string& name, const std::string& media_type, const std::string& content);
  // Adds the file's current content as an attachment. std::runtime_error when it cannot be read.
  void AddFile(const std::string& name, const std::string& media_type, const std::filesystem::path& path);

  // Writes the remaining entries and completes the file. Throws any error since the start.
  void Finish();
  // True when the file could not be written; its earlier content stays readable.
  [[nodiscard]] bool failed() const;
  // Ticks, samples and pictures dropped for lack of room, and all entries after a failure (without the open
  // chunk at that time, of the last second at most); and the pictures alone.
  [[nodiscard]] std::uint64_t dropped() const;
  [[nodiscard]] std::uint64_t dropped_images() const;

 private:
  using Job = std::function<void(LogFile&)>;
  struct LoggedTick {
    hal::TickRecord record;
    ReplayData data;
  };

  bool Push(Job job);  // false: lost
  void WriteImage(const cv::Mat& picture, std::int64_t stamp_ns, LogFile& file);
  void WriteAll();
  bool WaitForMore();
  void Lose();
  // Writes all waiting entries. Returns their number.
  std::size_t WriteRound();
  void Close();
  template <typename T>
  void WaitForRoom(const linux_rt::BoundedRing<T>& ring) const;

  const RunLogConfig config_;
  std::unique_ptr<LogFile> file_;
  std::unique_ptr<TickWriter> tick_writer_;
  linux_rt::BoundedRing<LoggedTick> ticks_;
  linux_rt::BoundedRing<TruthSample> truths_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::size_t images_waiting_ = 0;  // to be encoded
  std::vector<cv::Mat> spare_;      // pictures whose memory is reused
  bool closed_ = false;
  std::uint64_t dropped_images_ = 0;
  std::uint64_t lost_ = 0;      // messages dropped for lack of room, and all entries after the failure
  std::exception_ptr failure_;  // of the writing thread; after it the log discards all entries
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace fovea::log
