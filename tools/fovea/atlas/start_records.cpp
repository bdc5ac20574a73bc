// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/start_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "firmware/host/config/input_error.hpp"
#include "tools/fovea/atlas/files.hpp"

namespace fovea::atlas {
namespace {

using config::InputError;
using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMegabyte = 1'000'000;
constexpr std::uintmax_t kMostMegabytes = 100;

// `value`: as the error quotes it.
std::string NotANumber(const fs::path& file, int line, const std::string& column, const std::string& value) {
  return fmt::format("{}: {} = {} is not allowed: a finite number", At(file, line), Shortened(column), value);
}

// The words between commas, without blanks around them.
std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) {
    const std::size_t begin = cell.find_first_not_of(" \t");
    const std::size_t end = cell.find_last_not_of(" \t");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

void CheckCsvHeading(const fs::path& file, int line, const std::vector<std::string>& columns) {
  std::set<std::string> known;
  for (const std::string& column : columns) {
    if (column.empty()) {
      throw InputError(
          fmt::format("{}: column {} of the heading has no name", At(file, line), known.size() + 1));
    }
    if (!known.insert(column).second) {
      throw InputError(fmt::format("{}: column {} occurs twice", At(file, line), Shortened(column)));
    }
  }
}

std::vector<StartRecord> ReadCsv(const fs::path& file, const std::string& text) {
  std::vector<StartRecord> records;
  std::vector<std::string> columns;
  std::stringstream stream(text);
  int number = 0;
  int heading = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::vector<std::string> cells = Cells(line);
    if (cells == std::vector<std::string>{""} || cells[0][0] == '#') {
      continue;
    }
    if (columns.empty()) {
      CheckCsvHeading(file, number, cells);
      columns = cells;
      heading = number;
      continue;
    }
    if (cells.size() != columns.size()) {
      throw InputError(
          fmt::format("{}: {} values for {} columns", At(file, number), cells.size(), columns.size()));
    }
    StartRecord record{number, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = NAN;
      const char* end = cells[i].data() + cells[i].size();
      const auto read = std::from_chars(cells[i].data(), end, value);
      if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) {
        throw InputError(NotANumber(file, number, columns[i], fmt::format("\"{}\"", Shortened(cells[i]))));
      }
      record.values[columns[i]] = value;
    }
    records.push_back(record);
  }
  if (records.empty() && heading > 0) {
    throw InputError(
        fmt::format("{}: contains no start: this heading needs a line of values", At(file, heading)));
  }
  return records;
}

// Takes what the JSON library reads, in the order of the text, and refuses all but objects of numbers in one
// array. So nothing is ever nested deeper, and each place in the text is known.
class JsonRecords final : public json::json_sax_t {
 public:
  // `stream` reads `text`, and must outlive the object.
  JsonRecords(const fs::path& file, const std::string& text, std::istream& stream)
      : file_(file), text_(text), stream_(stream) {}

  [[nodiscard]] const std::vector<StartRecord>& records() const { return records_; }

  bool null() override { RefuseValue("null"); }
  bool boolean(bool value) override { RefuseValue(value ? "true" : "false"); }
  bool number_integer(std::int64_t value) override { return Take(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) override { return Take(static_cast<double>(value)); }
  bool number_float(double value, const std::string& /*text*/) override { return Take(value); }
  bool string(std::string& value) override { RefuseValue(fmt::format("\"{}\"", Shortened(value))); }
  bool binary(json::binary_t& /*value*/) override { RefuseValue("binary"); }
  bool start_array(std::size_t /*size*/) override {
    if (in_array_) {
      RefuseValue("[...]");
    }
    in_array_ = true;
    return true;
  }
  bool end_array() override { return true; }
  bool start_object(std::size_t /*size*/) override {
    if (!in_array_ || in_object_) {
      RefuseValue("{...}");
    }
    in_object_ = true;
    records_.push_back({LineNow(), {}});
    return true;
  }
  bool end_object() override {
    in_object_ = false;
    return true;
  }
  bool key(std::string& name) override {
    key_ = name;
    key_line_ = LineNow();
    needs_value_ = true;
    if (records_.back().values.contains(name)) {
      throw InputError(fmt::format("{}: column {} occurs twice", At(file_, key_line_), Shortened(name)));
    }
    return true;
  }
  // `position`: number of bytes that were read, the last of which cannot be there.
  bool parse_error(std::size_t position, const std::string& /*last*/,
                   const json::exception& /*error*/) override {
    constexpr const char* kBlanks = "\n\t ";
    constexpr const char* kMarks = ",:[]{}\n\t ";
    const std::size_t at = std::min(position - std::min<std::size_t>(position, 1), text_.size());
    const std::size_t mark = text_.find_last_of(kMarks, at);  // none: npos, which is -1
    const std::size_t begin = mark == at || at == text_.size() ? at : mark + 1;
    const std::string word =
        text_.substr(begin, std::max<std::size_t>(text_.find_first_of(kMarks, begin) - begin, 1));
    const std::size_t before = begin == 0 ? std::string::npos : text_.find_last_not_of(kBlanks, begin - 1);
    if (needs_value_ && before != std::string::npos && text_[before] == ':' && !word.empty()) {
      RefuseValue(Shortened(word));
    }
    const std::size_t line_begin = begin == 0 ? 0 : text_.rfind('\n', begin - 1) + 1;
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(begin), '\n');
    Refuse(static_cast<int>(lines) + 1,
           fmt::format("character {}, {}", begin - line_begin + 1,
                       word.empty() ? "the end" : fmt::format("\"{}\"", Shortened(word))));
  }

 private:
  // The line that the library has come to. Lines are counted once, from where it was before.
  int LineNow() {
    const auto at = text_.begin() + stream_.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in);
    line_ += static_cast<int>(std::count(counted_, at, '\n'));
    counted_ = at;
    return line_;
  }
  bool Take(double value) {
    if (!in_object_) {
      RefuseValue(fmt::format("{}", value));
    }
    needs_value_ = false;
    records_.back().values[key_] = value;
    return true;
  }
  [[noreturn]] void RefuseValue(const std::string& value) {
    if (in_object_) {
      throw InputError(NotANumber(file_, key_line_, key_, value));
    }
    Refuse(LineNow(), value);
  }
  [[noreturn]] void Refuse(int line, const std::string& what) const {
    throw InputError(fmt::format("{}: {}: not a JSON array of objects, such as [{{\"q1\": 0.1, ...}}, ...]",
                                 At(file_, line), what));
  }

  const fs::path& file_;
  const std::string& text_;
  std::istream& stream_;
  std::string::const_iterator counted_ = text_.begin();
  int line_ = 1;
  bool in_array_ = false;
  bool in_object_ = false;
  std::string key_;
  int key_line_ = 0;
  bool needs_value_ = false;  // of `key_`
  std::vector<StartRecord> records_;
};

std::vector<StartRecord> ReadJson(const fs::path& file, const std::string& text) {
  std::istringstream stream(text);
  JsonRecords records(file, text, stream);
  json::sax_parse(stream, &records);  // which throws
  return records.records();
}

// Line feeds alone, whatever ends the lines.
void UnifyLineEnds(std::string& text) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_pair = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (!is_pair) {
      text[length++] = text[i] == '\r' ? '\n' : text[i];
    }
  }
  text.resize(length);
}

}  // namespace

std::string At(const fs::path& file, int line) { return fmt::format("{}:{}", file.string(), line); }

std::string Shortened(const std::string& text) {
  constexpr std::size_t kMost = 60;  // bytes
  if (text.size() <= kMost + 3) {
    return text;
  }
  std::size_t length = kMost;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U) {
    --length;  // not within a character
  }
  return text.substr(0, length) + "...";
}

std::string StartsText(const fs::path& file) {
  std::error_code error;
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("--starts {}: {}", file.string(), why));
  };
  // Before it is opened: a pipe might never say anything, a device might never end.
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    refuse("is not a regular file: a CSV or JSON file is allowed");
  }
  const std::uintmax_t size = fs::file_size(file, error);
  if (error || !std::ifstream(file)) {
    refuse("cannot be read");
  }
  if (size > kMostMegabytes * kMegabyte) {
    refuse(fmt::format("{} MB are not allowed: at most {} MB", size / kMegabyte, kMostMegabytes));
  }
  std::string text = Content(file);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    refuse("is UTF-16: UTF-8 is allowed");
  }
  if (text.starts_with("\xEF\xBB\xBF")) {
    text.erase(0, 3);
  }
  UnifyLineEnds(text);
  return text;
}

std::vector<StartRecord> ReadStartRecords(const fs::path& file, const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  const bool is_json = first != std::string::npos && (text[first] == '[' || text[first] == '{');
  std::vector<StartRecord> records = is_json ? ReadJson(file, text) : ReadCsv(file, text);
  if (records.empty()) {
    throw InputError(fmt::format("{}: contains no start", file.string()));
  }
  return records;
}

}  // namespace fovea::atlas
