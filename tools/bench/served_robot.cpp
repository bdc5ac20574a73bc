#include "served_robot.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
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

// What comes through `pipe` up to the first line's end, or all that came in time.
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

// Of "... at 127.0.0.1:39937, real pace"; 0 where there is none.
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

}  // namespace

ServedRobot::ServedRobot(const std::filesystem::path& program) {
  std::array<int, 2> out{};
  if (pipe2(out.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe for " + program.string());
  }
  std::vector<std::string> words{
      program.string(), "serve", "ball",      "--pace", "real", "--camera-serial", "",
      "--fci-port",     "0",     "--late-ms", "3"};
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDERR_FILENO);
  const int error = posix_spawn(&process_, argv.front(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  const std::string line = error == 0 ? FirstLine(out[0]) : std::string();
  said_ = out[0];  // open for as long as it may say more
  port_ = PortIn(line);
  if (port_ == 0) {
    if (error == 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
    close(said_);
    throw std::runtime_error(program.string() + " serve: does not say where it listens: " + line);
  }
}

ServedRobot::~ServedRobot() {
  kill(process_, SIGKILL);  // it has nothing to save
  waitpid(process_, nullptr, 0);
  close(said_);
}

}  // namespace fovea::bench
