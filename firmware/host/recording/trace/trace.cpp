// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/trace/trace.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fovea/hal/types.hpp"

namespace fovea::trace {
namespace {

using nlohmann::json;

constexpr int kProcess = 1;

// Chrome counts in microseconds; three decimals keep the nanoseconds.
double Us(std::int64_t ns) { return static_cast<double>(ns) / 1000.0; }

json Naming(const char* what, int thread, const std::string& name) {
  return {{"ph", "M"}, {"name", what}, {"pid", kProcess}, {"tid", thread}, {"args", {{"name", name}}}};
}

json ToJson(const Span& span, int thread, std::int64_t start_ns) {
  json entry{{"name", span.name}, {"pid", kProcess}, {"tid", thread}, {"ts", Us(span.begin_ns - start_ns)}};
  if (span.end_ns > span.begin_ns) {
    entry["ph"] = "X";
    entry["dur"] = Us(span.end_ns - span.begin_ns);
  } else {
    entry["ph"] = "i";
    entry["s"] = "t";
  }
  if (span.number >= 0) {
    entry["args"] = {{"number", span.number}};
  }
  return entry;
}

// A point of an arrow, bound to the beginning of `span`.
json ArrowOf(const Span& span, int thread, std::int64_t start_ns) {
  const char* const phase = span.flow == Flow::kBegin ? "s" : span.flow == Flow::kStep ? "t" : "f";
  json entry{{"name", "picture"},
             {"cat", "picture"},
             {"ph", phase},
             {"id", span.number},
             {"pid", kProcess},
             {"tid", thread},
             {"ts", Us(span.begin_ns - start_ns)}};
  if (span.flow == Flow::kEnd) {
    entry["bp"] = "e";
  }
  return entry;
}

}  // namespace

std::int64_t NowNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * hal::kNsPerSecond + now.tv_nsec;
}

std::vector<Span> Track::Spans() const {
  std::vector<Span> spans(spans_.begin(), spans_.begin() + static_cast<std::ptrdiff_t>(count_));
  std::stable_sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return a.begin_ns != b.begin_ns ? a.begin_ns < b.begin_ns : a.end_ns > b.end_ns;
  });
  return spans;
}

Track& Trace::AddTrack(const std::string& name, std::size_t capacity) {
  return *tracks_.emplace_back(std::make_unique<Track>(name, capacity));
}

void Trace::Write(const std::filesystem::path& file) const {
  std::ofstream stream(file);
  std::int64_t start_ns = std::numeric_limits<std::int64_t>::max();
  std::uint64_t dropped = 0;
  std::vector<std::vector<Span>> spans;
  for (const auto& track : tracks_) {
    dropped += track->dropped();
    spans.push_back(track->Spans());
    if (!spans.back().empty()) {
      start_ns = std::min(start_ns, spans.back().front().begin_ns);
    }
  }
  // Writes span by span, so that a long run's file need not fit into memory.
  stream << "{\"displayTimeUnit\":\"ns\",\"otherData\":" << json{{"program", program_}, {"dropped", dropped}}
         << ",\n\"traceEvents\":[\n"
         << Naming("process_name", 0, program_);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const int thread = static_cast<int>(i) + 1;
    stream << ",\n" << Naming("thread_name", thread, tracks_[i]->name());
    for (const Span& span : spans[i]) {
      stream << ",\n" << ToJson(span, thread, start_ns);
      if (span.flow != Flow::kNone) {
        stream << ",\n" << ArrowOf(span, thread, start_ns);
      }
    }
  }
  stream << "\n]}\n";
  if (!stream.flush()) {
    throw std::runtime_error(file.string() + ": the trace cannot be written");
  }
}

}  // namespace fovea::trace
