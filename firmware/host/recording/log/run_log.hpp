// A run's log.mcap: fed by the threads of a run, written by one of its own.
//
// What comes per tick goes through bounded rings without locks; all else through a bounded queue. From ticks
// the log makes by itself what viewers want: modes and faults in words, and the poses of all frames.
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

// A frame that moves with the arm: fixed to what joint `joint` moves, or to B when that is -1.
struct LinkFrame {
  std::string name;
  int joint = -1;
  model::Pose X_LnF;  // in the frame L_joint of the model, or in B
};

struct RunLogConfig {
  std::filesystem::path path;
  std::string library;  // who writes
  model::ArmModel arm;
  std::vector<LinkFrame> frames;  // of /tf, the camera's among them
  // When the disk is slower than the run: drop ticks, samples and pictures and count them (true), or wait
  // (false).
  bool may_drop = false;
  std::size_t ring = 2048;      // ticks, and samples, that may wait: two seconds
  std::size_t most_images = 8;  // pictures that may wait to be encoded
  int jpeg_quality = 80;
};

// What a simulator knows; see Truth in firmware/host/recording/log/proto/fovea/run.proto.
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
  // Ends the thread; a file that was not finished stays readable up to what was written.
  ~RunLog();
  RunLog(const RunLog&) = delete;
  RunLog& operator=(const RunLog&) = delete;

  // From one thread. Real-time when the log may drop.
  void AddTick(const hal::TickRecord& record, const ReplayData& data = {});
  // From one thread. Real-time when the log may drop.
  void AddTruth(const TruthSample& sample);
  // From any thread that need not be real-time. For messages that are few and small: none is dropped, unless
  // a thousand wait for a disk that hangs, and the log may drop.
  void Add(const char* topic, std::int64_t time_ns, const google::protobuf::Message& message);
  // Copies the pixels; encoded as JPEG by the log's thread.
  void AddImage(const hal::Frame& frame);
  void AddMetadata(const std::string& name, const std::map<std::string, std::string>& entries);
  void AddAttachment(const std::string& name, const std::string& media_type, const std::string& content);
  // What the file holds now, as an attachment. std::runtime_error when it cannot be read.
  void AddFile(const std::string& name, const std::string& media_type, const std::filesystem::path& path);

  // Writes what is left and completes the file. Throws what went wrong at any time.
  void Finish();
  // The file could not be written; what was before stays readable.
  [[nodiscard]] bool failed() const;
  // Ticks, samples and pictures that found no place, and all that came after a failure (not what had been
  // collected for the file then, of the last second at most); and the pictures alone.
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
  void CountLost();
  // Writes what is there; false when nothing was.
  bool WriteRound();
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
  std::vector<cv::Mat> spare_;      // pictures whose memory is used again
  bool closed_ = false;
  std::uint64_t dropped_images_ = 0;
  std::uint64_t lost_ = 0;      // messages without a place, and all after the failure
  std::exception_ptr failure_;  // of the writing thread; after it the log takes everything and keeps nothing
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace fovea::log
