// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/workers.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

namespace fovea::atlas {
namespace {

constexpr int kCannotStart = 127;  // the exit code that shells use
constexpr int kPollMs = 200;

struct Pipe {
  int read = -1;
  int write = -1;
};

Pipe MakePipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot make a pipe to the simulator");
  }
  return {ends[0], ends[1]};
}

// In the child: only calls that are allowed between fork and exec.
[[noreturn]] void BecomeWorker(const char* program, int requests, int replies, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() == parent) {  // else our parent has ended
    dup2(requests, STDIN_FILENO);
    dup2(replies, STDOUT_FILENO);
    execl(program, program, "runs", static_cast<char*>(nullptr));
  }
  _exit(kCannotStart);
}

bool WriteAll(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      return false;
    }
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

Workers::~Workers() {
  for (const Worker& worker : workers_) {
    kill(worker.pid, SIGKILL);
    waitpid(worker.pid, nullptr, 0);
    close(worker.requests);
    close(worker.replies);
  }
}

std::size_t Workers::running() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(workers_, [](const Worker& worker) { return worker.run.has_value(); }));
}

Workers::Worker& Workers::Idle() {
  const auto idle = std::ranges::find_if(workers_, [](const Worker& worker) { return !worker.run; });
  if (idle != workers_.end()) {
    return *idle;
  }
  const Pipe requests = MakePipe();
  const Pipe replies = MakePipe();
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    BecomeWorker(simulator_.c_str(), requests.read, replies.write, parent);
  }
  close(requests.read);
  close(replies.write);
  if (pid < 0) {
    close(requests.write);
    close(replies.read);
    throw std::runtime_error(simulator_.string() + ": cannot start a process");
  }
  return workers_.emplace_back(Worker{pid, requests.write, replies.read, "", std::nullopt});
}

void Workers::Start(int tag, const std::vector<std::string>& words, const std::filesystem::path& out,
                    const std::filesystem::path& err, std::chrono::seconds limit) {
  signal(SIGPIPE, SIG_IGN);  // a worker that has died shows in WaitForOne
  const nlohmann::json request{{"run", words}, {"out", out.string()}, {"err", err.string()}};
  Worker& worker = Idle();
  worker.run = Run{tag, std::chrono::steady_clock::now() + limit};
  static_cast<void>(WriteAll(worker.requests, request.dump() + '\n'));
}

// The run that `worker` has done, if it has said so.
std::optional<Workers::Ended> Workers::Read(Worker& worker) {
  std::array<char, 64> bytes{};
  const ssize_t count = read(worker.replies, bytes.data(), bytes.size());
  if (count > 0) {
    worker.reply.append(bytes.data(), static_cast<std::size_t>(count));
  }
  if (!worker.run || worker.reply.find('\n') == std::string::npos) {
    return std::nullopt;
  }
  Ended ended{worker.run->tag, -1};
  std::from_chars(worker.reply.data(), worker.reply.data() + worker.reply.size(), ended.exit_code);
  worker.reply.clear();
  worker.run.reset();
  return ended;
}

// Of a worker that has died, or does not answer in time.
Workers::Ended Workers::Bury(std::size_t index) {
  const Worker worker = std::move(workers_[index]);
  workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(index));
  kill(worker.pid, SIGKILL);
  int status = 0;
  waitpid(worker.pid, &status, 0);
  close(worker.requests);
  close(worker.replies);
  return {worker.run ? worker.run->tag : 0, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

Workers::Ended Workers::WaitForOne() {
  for (;;) {
    std::vector<pollfd> waiting;
    for (const Worker& worker : workers_) {
      waiting.push_back({worker.run ? worker.replies : -1, POLLIN, 0});
    }
    poll(waiting.data(), waiting.size(), kPollMs);
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if ((waiting[i].revents & POLLIN) != 0) {
        if (const std::optional<Ended> ended = Read(workers_[i])) {
          return *ended;
        }
      } else if (waiting[i].revents != 0) {
        return Bury(i);
      }
      if (workers_[i].run && std::chrono::steady_clock::now() > workers_[i].run->deadline) {
        return Bury(i);
      }
    }
  }
}

}  // namespace fovea::atlas
