// When each thread of a program did what, for a timeline that people look at: Chrome's trace format, which
// chrome://tracing and ui.perfetto.dev open.
//
// Each thread writes into a track of its own, whose room is taken beforehand: nobody waits for anybody, and
// nothing is asked of the heap. What finds no room is dropped and counted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace fovea::trace {

// CLOCK_MONOTONIC [ns]. Real-time: yes.
[[nodiscard]] std::int64_t NowNs() noexcept;

// The way of one picture through the threads; arrows join the spans that name the same picture.
enum class Flow : std::uint8_t { kNone, kBegin, kStep, kEnd };

struct Span {
  const char* name = "";  // a literal
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;   // begin_ns: an instant
  std::int64_t number = -1;  // of the tick or picture; -1: none
  Flow flow = Flow::kNone;
};

// Of one thread, whose spans lie within or beside each other.
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

  // When its thread is done.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  // In order of their beginnings; of those that begin together the longest first.
  [[nodiscard]] std::vector<Span> Spans() const;

 private:
  std::string name_;
  std::vector<Span> spans_;  // [capacity], touched
  std::size_t count_ = 0;
  std::uint64_t dropped_ = 0;
};

class Trace {
 public:
  explicit Trace(std::string program) : program_(std::move(program)) {}

  // A thread's track, with room for `capacity` spans. It lives as long as the trace. Before the thread runs.
  Track& AddTrack(const std::string& name, std::size_t capacity);

  // When all threads are done. std::runtime_error when the file cannot be written.
  void Write(const std::filesystem::path& file) const;

  [[nodiscard]] const std::vector<std::unique_ptr<Track>>& tracks() const { return tracks_; }

 private:
  std::string program_;
  std::vector<std::unique_ptr<Track>> tracks_;
};

}  // namespace fovea::trace
