// SPDX-License-Identifier: Apache-2.0
// A program's own command line as text for a log. Pasted into a shell, it repeats the run.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace fovea::config {

// `word` as a POSIX shell reads it back, in quotes where it needs them.
inline std::string QuotedForShell(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./:=@_";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) {
    return std::string(word);
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? std::string(R"('\'')") : std::string(1, c);
  }
  return quoted + "'";
}

// The program's name without its folder, and all its arguments.
inline std::string CommandLine(int argc, const char* const* argv) {
  std::string text = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : std::string();
  for (int i = 1; i < argc; ++i) {
    text.append(" ").append(QuotedForShell(argv[i]));
  }
  return text;
}

}  // namespace fovea::config
