// SPDX-License-Identifier: Apache-2.0
#include "sim/app/runs_command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/host/config/command_line.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "sim/app/run_command.hpp"
#include "sim/render/renderer_pool.hpp"

namespace fovea::sim {
namespace {

using nlohmann::json;

struct Request {
  std::vector<std::string> run;
  std::string out;
  std::string err;
};

// A copy of a descriptor that programs started from here do not inherit.
int PrivateCopy(int descriptor) {
  const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (copy < 0) {
    throw std::runtime_error("standard input or output is closed");
  }
  return copy;
}

// Standard output or standard error goes to a file while this exists.
class Redirected {
 public:
  Redirected(std::FILE* stream, const std::string& path)
      : stream_(stream), before_(PrivateCopy(fileno(stream))) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) {
      close(before_);
      throw config::InputError(path + ": cannot be written");
    }
    std::fflush(stream_);
    dup2(file, fileno(stream_));
    close(file);
  }
  ~Redirected() {
    std::fflush(stream_);
    std::clearerr(stream_);  // an error of this run's file is not the next one's
    dup2(before_, fileno(stream_));
    close(before_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  std::FILE* const stream_;
  const int before_;
};

// The lines of a descriptor, which it closes.
class Lines {
 public:
  explicit Lines(int descriptor) : descriptor_(descriptor) {}
  ~Lines() { close(descriptor_); }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  // Waits for the next line, without its end. False: there is none.
  bool Next(std::string& line) {
    std::size_t end = read_.find('\n');
    while (end == std::string::npos && Read()) {
      end = read_.find('\n');
    }
    line = read_.substr(0, end);
    read_.erase(0, end == std::string::npos ? end : end + 1);
    return end != std::string::npos || !line.empty();
  }

 private:
  bool Read() {
    std::array<char, 4096> bytes{};
    ssize_t count = -1;
    do {
      count = read(descriptor_, bytes.data(), bytes.size());
    } while (count < 0 && errno == EINTR);
    read_.append(bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
    return count > 0;
  }

  const int descriptor_;
  std::string read_;
};

Request ReadRequest(const std::string& line, int number) {
  Request request;
  try {
    const json given = json::parse(line);
    given.at("run").get_to(request.run);
    given.at("out").get_to(request.out);
    given.at("err").get_to(request.err);
  } catch (const json::exception&) {
    throw config::InputError(fmt::format(
        "standard input, line {}: expected {{\"run\": [\"ball\", ...], \"out\": FILE, \"err\": FILE}}",
        number));
  }
  return request;
}

int RunOne(const Request& request, RendererPool& pool) {
  const Redirected out(stdout, request.out);
  const Redirected err(stderr, request.err);
  std::vector<std::string> words{"fovea-sim", "run"};
  words.insert(words.end(), request.run.begin(), request.run.end());
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  const auto argc = static_cast<int>(argv.size());
  CLI::App app;
  RunArguments arguments;
  arguments.command = config::CommandLine(argc, argv.data());
  AddRun(*app.add_subcommand("run"), arguments);
  return config::RunProgram("fovea-sim", app, argc, argv.data(), [&] {
    if (arguments.live) {
      throw config::InputError("--live is not allowed here: it shows a single run");
    }
    return RunCommand(arguments, &pool);
  });
}

}  // namespace

int RunsCommand() {
  // Programs that a run starts neither read the requests nor write replies.
  Lines requests(PrivateCopy(STDIN_FILENO));
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(nothing, STDIN_FILENO);
  close(nothing);
  RendererPool pool;
  int number = 0;
  for (std::string line; requests.Next(line);) {
    const int exit_code = RunOne(ReadRequest(line, ++number), pool);
    fmt::print("{}\n", exit_code);
    std::fflush(stdout);
  }
  return config::kDone;
}

}  // namespace fovea::sim
