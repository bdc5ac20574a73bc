// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/load.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <stdexcept>

#include "fovea/linux_rt/realtime.hpp"
#include "tools/bench/common/shell.hpp"

namespace fovea::bench {
namespace {

constexpr std::size_t kCopyBytes = 64U << 20U;

void Spin(const std::atomic<bool>& stop) {
  volatile double x = 1.0;
  while (!stop.load(std::memory_order_relaxed)) {
    for (int i = 0; i < 1000; ++i) {
      x = x * 1.000001 + 1e-9;
    }
  }
}

void Copy(const std::atomic<bool>& stop) {
  std::vector<unsigned char> a(kCopyBytes, 1);
  std::vector<unsigned char> b(kCopyBytes, 2);
  while (!stop.load(std::memory_order_relaxed)) {
    std::memcpy(a.data(), b.data(), a.size());
    ++a[0];
    std::memcpy(b.data(), a.data(), a.size());
  }
}

// Sends datagrams to itself in a loop.
void Send(const std::atomic<bool>& stop) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (socket_fd < 0 || bind(socket_fd, generic, size) != 0 || getsockname(socket_fd, generic, &size) != 0) {
    close(socket_fd);
    return;
  }
  std::array<char, 1377> datagram{};
  while (!stop.load(std::memory_order_relaxed)) {
    for (int i = 0; i < 20; ++i) {
      static_cast<void>(sendto(socket_fd, datagram.data(), datagram.size(), 0, generic, size));
    }
    while (recv(socket_fd, datagram.data(), datagram.size(), 0) > 0) {
    }
  }
  close(socket_fd);
}

}  // namespace

Load::Load(const std::string& kind) {
  const unsigned cores = std::max(std::thread::hardware_concurrency(), 1U);
  const auto start = [this](unsigned count, void (*work)(const std::atomic<bool>&)) {
    for (unsigned i = 0; i < count; ++i) {
      threads_.emplace_back([this, work] {
        linux_rt::MakeThreadYielding("fovea-load");
        work(stop_);
      });
    }
  };
  if (kind == "cpu") {
    start(cores, Spin);
  } else if (kind == "memory") {
    start(2, Copy);
  } else if (kind == "network") {
    start(2, Send);
  } else if (kind == "render") {
    StartRender();
  } else if (kind == "viewers") {
    viewers_ = std::make_unique<Viewers>();
  }
}

void Load::StartRender() {
  const std::string path = SimulatorBeside("--load render").string();
  std::array<const char*, 8> words{
      path.c_str(), "run", "ball-moving", "--no-report", "--set", "run.duration_s=100000", nullptr, nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const int error = posix_spawn(&render_pid_, path.c_str(), &actions, nullptr,
                                const_cast<char* const*>(words.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    render_pid_ = 0;
    throw std::runtime_error("--load render: " + path + " cannot be started");
  }
}

void Load::Check() const {
  if (viewers_ && viewers_->have_left()) {
    throw std::runtime_error("--load viewers: a viewer was disconnected");
  }
}

Load::~Load() {
  stop_ = true;
  if (render_pid_ != 0) {
    kill(render_pid_, SIGTERM);
    waitpid(render_pid_, nullptr, 0);
  }
}

}  // namespace fovea::bench
