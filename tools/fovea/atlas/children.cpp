// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/children.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <thread>

namespace fovea::atlas {
namespace {

constexpr int kCannotStart = 127;  // the exit code that shells use

// In the child: only calls that are allowed between fork and exec.
[[noreturn]] void BecomeProgram(char* const* argv, const char* out, const char* err, pid_t parent) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int in_file = open("/dev/null", O_RDONLY);
  const int out_file = open(out, kFlags, 0600);
  const int err_file = open(err, kFlags, 0600);
  if (getppid() == parent && in_file >= 0 && out_file >= 0 && err_file >= 0) {  // else our parent has ended
    dup2(in_file, STDIN_FILENO);
    dup2(out_file, STDOUT_FILENO);
    dup2(err_file, STDERR_FILENO);
    execv(argv[0], argv);
  }
  _exit(kCannotStart);
}

}  // namespace

Children::~Children() {
  for (const Child& child : children_) {
    kill(child.pid, SIGKILL);
    waitpid(child.pid, nullptr, 0);
  }
}

void Children::Start(int tag, const std::vector<std::string>& arguments, const std::filesystem::path& out,
                     const std::filesystem::path& err, std::chrono::seconds limit) {
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    BecomeProgram(argv.data(), out.c_str(), err.c_str(), parent);
  }
  if (pid < 0) {
    throw std::runtime_error(arguments[0] + ": cannot start a process");
  }
  children_.push_back({pid, tag, std::chrono::steady_clock::now() + limit});
}

Children::Ended Children::WaitForOne() {
  for (;;) {
    for (auto child = children_.begin(); child != children_.end(); ++child) {
      int status = 0;
      if (std::chrono::steady_clock::now() > child->deadline) {
        kill(child->pid, SIGKILL);
      }
      if (waitpid(child->pid, &status, WNOHANG) == child->pid) {
        const Ended ended{child->tag, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
        children_.erase(child);
        return ended;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace fovea::atlas
