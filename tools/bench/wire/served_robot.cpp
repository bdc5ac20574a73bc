// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/wire/served_robot.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <stdexcept>
#include <string>
#include <vector>

namespace fovea::bench {
namespace {

constexpr int kStartMs = 20'000;  // for the first line

// The first line from `pipe`, or its part before a pause of kStartMs.
std::string FirstLine(int pipe) {
  std::string line;
  pollfd ready{pipe, POLLIN, 0};
  while (poll(&ready, 1, kStartMs) == 1) {
    char c = 0;
    if (read(pipe, &c, 1) != 1 || c == '\n') {
      break;
    }
    line += c;
  }
  return line;
}

// The port in a line such as "... at 127.0.0.1:39937, real pace"; 0 if there is none.
std::uint16_t PortIn(const std::string& line) {
  const std::string before = "127.0.0.1:";
  const std::size_t at = line.find(before);
  std::uint16_t port = 0;
  if (at != std::string::npos) {
    const char* const begin = line.data() + at + before.size();
    std::from_chars(begin, line.data() + line.size(), port);
  }
  return port;
}

// In the child: only calls that are allowed between fork and exec.
[[noreturn]] void BecomeProgram(char* const* argv, int say, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // no robot is left behind
  const int in_file = open("/dev/null", O_RDONLY);
  if (getppid() == parent && in_file >= 0) {  // another parent: ours has ended already
    dup2(in_file, STDIN_FILENO);
    dup2(say, STDERR_FILENO);
    execv(argv[0], argv);
  }
  _exit(127);
}

}  // namespace

ServedRobot::ServedRobot(const std::filesystem::path& program, const std::string& pace) {
  std::array<int, 2> out{};
  if (pipe2(out.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot create a pipe for " + program.string());
  }
  std::vector<std::string> words{
      program.string(), "serve", "ball",      "--pace", pace, "--camera-serial", "",
      "--fci-port",     "0",     "--late-ms", "3"};
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    BecomeProgram(argv.data(), out[1], parent);
  }
  close(out[1]);
  const std::string line = process_ > 0 ? FirstLine(out[0]) : std::string();
  said_ = out[0];  // stays open, because the program may print more
  port_ = PortIn(line);
  if (port_ == 0) {
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(said_);
    throw std::runtime_error(program.string() + " serve: did not print where it listens: " + line);
  }
}

ServedRobot::~ServedRobot() {
  kill(process_, SIGKILL);  // it has nothing to save
  waitpid(process_, nullptr, 0);
  close(said_);
}

}  // namespace fovea::bench
