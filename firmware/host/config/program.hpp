// SPDX-License-Identifier: Apache-2.0
// Command-line handling of every program of the project: exit codes, and errors on one line.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/host/config/help_text.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/number_options.hpp"
#include "firmware/host/config/terminal.hpp"

namespace fovea::config {

inline constexpr int kDone = 0;
inline constexpr int kGoalMissed = 1;  // the run failed its own goal
inline constexpr int kBadInput = 2;    // wrong usage or input

// Joins lines: a library's message may have several.
inline std::string OnOneLine(std::string text) {
  text.erase(text.find_last_not_of(" \n\r\t") + 1);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

// An error as printed: lines that fit into `width`.
inline std::string ErrorText(const char* name, const std::string& text, std::size_t width) {
  return Fitted(std::string(name) + ": " + OnOneLine(text), kContinued, width);
}

// Prints an error of the program `name` on standard error: one line, which a terminal's width breaks. Does
// not wait for a reader who has stopped reading.
inline void PrintError(const char* name, const std::string& text) {
  constexpr int kPatienceMs = 500;
  pollfd room{STDERR_FILENO, POLLOUT, 0};
  if (poll(&room, 1, kPatienceMs) != 0) {
    std::fputs(ErrorText(name, text, TerminalWidth(STDERR_FILENO)).c_str(), stderr);
  }
}

// Prints `text` on standard output. A line that is too long continues at `column`.
inline void PrintFitted(const std::string& text, std::size_t column = kContinued) {
  std::fputs(Fitted(text, column, TerminalWidth(STDOUT_FILENO)).c_str(), stdout);
}

// The names of the subcommands and options of `app`.
inline std::vector<std::string> NamesAllowedBy(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command :
       app.get_subcommands([](const CLI::App* a) { return !a->get_name().empty(); })) {
    names.push_back(command->get_name());
  }
  for (const CLI::Option* option : app.get_options({})) {
    if (!option->get_group().empty()) {
      names.push_back(option->get_name());
    }
  }
  return names;
}

// Says what is wrong with a command line, and what is allowed there.
inline std::string Explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().back();
  }
  const std::vector<std::string> names = NamesAllowedBy(*command);
  const bool is_about_names = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                              dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  std::string what = OnOneLine(error.what());
  if (what.find("not expected") == std::string::npos) {
    for (const std::string& word : app.remaining(true)) {
      what += "; not expected: " + OnOneLine(word);
    }
  }
  if (!is_about_names) {
    return what;
  }
  for (const std::string& word : app.remaining(true)) {
    what += DidYouMean(word, names);
  }
  std::string allowed;
  for (const std::string& name : names) {
    allowed += (allowed.empty() ? "" : ", ") + name;
  }
  return what + "; allowed: " + allowed;
}

// Parses the command line with `app`, then runs `action`. Returns the program's exit code: the action's, or
// kBadInput after one line on standard error that begins with the program's `name`.
inline int RunProgram(const char* name, CLI::App& app, int argc, char** argv,
                      const std::function<int()>& action) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its largest size is a failed write, as on a full disk
  RefuseNonFinite(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      std::ostringstream help;
      const bool done = app.exit(error, help, help) == 0;
      TextStyle style = StyleOf(STDOUT_FILENO);
      style.width = std::min(style.width, kMostWidth);  // also in a pager
      std::fputs(FormatHelp(help.str(), style).c_str(), stdout);
      return done ? kDone : kBadInput;
    }
    PrintError(name, Explain(app, error));
    return kBadInput;
  }
  try {
    const int code = action();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("standard output cannot be written");
    }
    return code;
  } catch (const std::exception& error) {
    PrintError(name, error.what());
    return kBadInput;
  }
}

}  // namespace fovea::config
