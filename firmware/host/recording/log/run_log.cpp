// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/run_log.hpp"

#include <chrono>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "firmware/host/recording/log/log_file.hpp"
#include "firmware/host/recording/log/log_format.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/run_messages.hpp"
#include "firmware/host/recording/log/tick_writer.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/run.pb.h"
#include "foxglove/image.pb.h"

namespace fovea::log {
namespace {

constexpr std::size_t kMostJobs = 1024;                  // messages that may wait
constexpr auto kPoll = std::chrono::milliseconds(2);     // time between two reads of the rings
constexpr auto kFlush = std::chrono::milliseconds(500);  // least time between two flushes of the file

}  // namespace

RunLog::RunLog(const RunLogConfig& config)
    : config_(config),
      file_(std::make_unique<LogFile>(config.path, config.library, config.tap)),
      tick_writer_(std::make_unique<TickWriter>(config_)),
      ticks_(config.ring),
      truths_(config.ring),
      thread_([this] { WriteAll(); }) {}

RunLog::~RunLog() { Close(); }

// Waits only if nothing may be dropped.
template <typename T>
void RunLog::WaitForRoom(const linux_rt::BoundedRing<T>& ring) const {
  while (!config_.may_drop && !ring.HasRoom() && !failed_.load(std::memory_order_relaxed)) {
    std::this_thread::sleep_for(kPoll / 4);
  }
}

void RunLog::AddTick(const hal::TickRecord& record, const ReplayData& data) {
  WaitForRoom(ticks_);
  ticks_.Fill([&](LoggedTick& tick) {
    tick.record = record;
    tick.data = data;
  });
}

void RunLog::AddTruth(const TruthSample& sample) {
  WaitForRoom(truths_);
  truths_.Push(sample);
}

bool RunLog::Push(Job job) {
  {
    std::unique_lock lock(mutex_);
    const auto has_room = [this] { return jobs_.size() < kMostJobs || failure_ != nullptr; };
    if (!config_.may_drop) {
      changed_.wait(lock, has_room);
    }
    if (!has_room() || failure_ != nullptr) {
      ++lost_;  // the disk hangs, or writing failed (Finish reports that)
      return false;
    }
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
  return true;
}

void RunLog::Add(const char* topic, std::int64_t time_ns, const google::protobuf::Message& message) {
  Push([topic, time_ns, type = message.GetDescriptor(), bytes = message.SerializeAsString()](LogFile& file) {
    file.Write(topic, *type, time_ns, bytes);
  });
}

void RunLog::AddImage(const hal::Frame& frame) {
  const cv::Mat view = PictureOf(frame);
  cv::Mat picture;
  {
    std::unique_lock lock(mutex_);
    const auto has_room = [this] { return images_waiting_ < config_.most_images || failure_ != nullptr; };
    if (!config_.may_drop) {
      changed_.wait(lock, has_room);
    }
    if (!has_room() || failure_ != nullptr) {
      ++dropped_images_;
      return;
    }
    ++images_waiting_;
    if (!spare_.empty()) {
      picture = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  view.copyTo(picture);
  if (!Push([this, picture, stamp_ns = frame.stamp_ns](LogFile& file) {
        WriteImage(picture, stamp_ns, file);
      })) {
    const std::lock_guard lock(mutex_);
    spare_.push_back(picture);
    --images_waiting_;
  }
}

void RunLog::WriteImage(const cv::Mat& picture, std::int64_t stamp_ns, LogFile& file) {
  file.Write(kImageTopic, stamp_ns, ImageMessage(picture, stamp_ns, config_.jpeg_quality));
  {
    const std::lock_guard lock(mutex_);
    spare_.push_back(picture);
    --images_waiting_;
  }
  changed_.notify_all();
}

void RunLog::AddMetadata(const std::string& name, const std::map<std::string, std::string>& entries) {
  Push([name, entries](LogFile& file) { file.writer().WriteMetadata(name, entries); });
}

void RunLog::AddAttachment(const std::string& name, const std::string& media_type,
                           const std::string& content) {
  Push([name, media_type, content](LogFile& file) {
    file.writer().WriteAttachment(name, media_type, 0, content);
  });
}

void RunLog::AddFile(const std::string& name, const std::string& media_type,
                     const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw std::runtime_error(path.string() + ": cannot be read");
  }
  AddAttachment(name, media_type, {std::istreambuf_iterator<char>(stream), {}});
}

// Keeps the order of each thread: reads the rings' ends before it takes the messages, so that each message
// that was added before a tick is written before that tick.
std::size_t RunLog::WriteRound() {
  const std::uint64_t ticks_end = ticks_.End();
  const std::uint64_t truths_end = truths_.End();
  std::deque<Job> jobs;
  {
    const std::lock_guard lock(mutex_);
    jobs.swap(jobs_);
  }
  changed_.notify_all();
  const std::size_t added = jobs.size();
  try {
    for (; !jobs.empty(); jobs.pop_front()) {
      jobs.front()(*file_);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    lost_ += jobs.size();
    throw;
  }
  std::size_t written = added;
  written += ticks_.Drain(
      ticks_end, [this](const LoggedTick& tick) { tick_writer_->Write(tick.record, tick.data, *file_); });
  written += truths_.Drain(truths_end, [this](const TruthSample& sample) {
    file_->Write(kTruthTopic, sample.stamp_ns, TruthMessage(sample));
  });
  return written;
}

void RunLog::WriteAll() {
  linux_rt::MakeThreadYielding("fovea-log");
  try {
    file_->writer().WriteMetadata(kFormatRecord, FormatEntries(config_.library));
    auto flushed = std::chrono::steady_clock::now();
    bool dirty = false;
    while (!WaitForMore()) {
      dirty = WriteRound() > 0 || dirty;
      const auto now = std::chrono::steady_clock::now();
      if (dirty && now - flushed > kFlush) {
        file_->writer().Flush();
        flushed = now;
        dirty = false;
      }
    }
    WriteRound();
  } catch (...) {
    {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    failed_ = true;
    changed_.notify_all();
    file_->StopWriting();
    while (!WaitForMore()) {
      Lose();
    }
    Lose();
  }
}

// True once the log is closed: then everything that was added before is visible.
bool RunLog::WaitForMore() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPoll, [this] { return closed_ || !jobs_.empty(); });
  return closed_;
}

// After a failure: all waiting entries are lost for the file and counted; the tap still gets them.
void RunLog::Lose() {
  std::size_t lost = 0;
  for (int round = 0; round < 2; ++round) {  // a second one, when the first ends early
    try {
      lost += WriteRound();
    } catch (...) {  // e.g. an attachment, for which there is no file
    }
  }
  const std::lock_guard lock(mutex_);
  lost_ += lost;
}

void RunLog::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void RunLog::Finish() {
  Close();
  if (failure_) {
    std::rethrow_exception(failure_);
  }
  try {
    file_->writer().Finish();
  } catch (...) {
    failed_ = true;
    throw;
  }
}

std::uint64_t RunLog::dropped() const {
  const std::lock_guard lock(mutex_);
  return ticks_.dropped() + truths_.dropped() + dropped_images_ + lost_;
}

bool RunLog::failed() const { return failed_.load(std::memory_order_relaxed); }

std::uint64_t RunLog::dropped_images() const {
  const std::lock_guard lock(mutex_);
  return dropped_images_;
}

}  // namespace fovea::log
