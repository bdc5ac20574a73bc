// SPDX-License-Identifier: Apache-2.0
// Records what each thread of a program does and when, as a timeline in Chrome's trace format:
// chrome://tracing and ui.perfetto.dev open it.
//
// Each thread writes into its own track, whose memory is allocated beforehand: no thread waits, and none uses
// the heap. Spans that do not fit are dropped and counted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace fovea::trace {

// CLOCK_MONOTONIC [ns]. Real-time: yes.
[[nodiscard]] std::int64_t NowNs() noexcept;

// The path of one picture through the threads; arrows join the spans with the same picture's number.
enum class Flow : std::uint8_t { kNone, kBegin, kStep, kEnd };

struct Span {
  const char* name = "";  // a literal
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;   // begin_ns: an instant
  std::int64_t number = -1;  // of the tick or picture; -1: none
  Flow flow = Flow::kNone;
};

// The spans of one thread. Two spans are nested or do not overlap.
class Track {
 public:
  Track(std::string name, std::size_t capacity) : name_(std::move(name)) { spans_.resize(capacity); }

  // From its own thread. Real-time: yes.
  void Add(const Span& span) noexcept {
    if (count_ < spans_.size()) {
      spans_[count_++] = span;
    } else {
      ++dropped_;
    }
  }

  // Call these only when the track's thread is done.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  // In the order of their beginnings; of spans that begin together, the longest first.
  [[nodiscard]] std::vector<Span> Spans() const;

 private:
  std::string name_;
  std::vector<Span> spans_;  // [capacity], written once so that its pages are mapped
  std::size_t count_ = 0;
  std::uint64_t dropped_ = 0;
};

class Trace {
 public:
  explicit Trace(std::string program) : program_(std::move(program)) {}

  // Adds a thread's track with room for `capacity` spans. Call it before the thread runs. The track lives as
  // long as the trace.
  Track& AddTrack(const std::string& name, std::size_t capacity);

  // Call when all threads are done. std::runtime_error when the file cannot be written.
  void Write(const std::filesystem::path& file) const;

  [[nodiscard]] const std::vector<std::unique_ptr<Track>>& tracks() const { return tracks_; }

 private:
  std::string program_;
  std::vector<std::unique_ptr<Track>> tracks_;
};

}  // namespace fovea::trace
