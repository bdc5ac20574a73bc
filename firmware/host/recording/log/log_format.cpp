// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/log_format.hpp"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

namespace fovea::log {

std::map<std::string, std::string> FormatEntries(const std::string& writer) {
  return {{"version", fmt::format("{}", kLogFormat)}, {"writer", writer}};
}

std::string WhyUnreadable(const std::map<std::string, std::string>& format_entries) {
  const auto text = [&format_entries](const char* key) {
    const auto entry = format_entries.find(key);
    return entry == format_entries.end() ? std::string() : entry->second;
  };
  const std::string version = text("version");
  int number = 0;
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), number);
  if (error == std::errc() && end == version.data() + version.size() && number >= kOldestLogFormat &&
      number <= kLogFormat) {
    return "";
  }
  return fmt::format("a log of format \"{}\", written by \"{}\"; this program reads formats {} to {}",
                     version, text("writer"), kOldestLogFormat, kLogFormat);
}

}  // namespace fovea::log
