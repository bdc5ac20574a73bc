// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "fovea/v4l2/device.hpp"

namespace fovea::v4l2 {
namespace {

class SystemDevice final : public Device {
 public:
  ~SystemDevice() override { Close(); }

  int Open(const std::string& path) override {
    descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return descriptor_ < 0 ? -errno : 0;
  }

  int Control(unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ioctl(descriptor_, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : result;
  }

  int Map(std::size_t size, std::int64_t offset, void*& memory) override {
    memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, offset);
    return memory == MAP_FAILED ? -errno : 0;
  }

  void Unmap(void* memory, std::size_t size) override { munmap(memory, size); }

  int Wait(std::int64_t timeout_ns) override {
    constexpr std::int64_t kNsPerMs = 1'000'000;
    pollfd wait{descriptor_, POLLIN, 0};
    const auto timeout_ms =
        static_cast<int>(std::clamp<std::int64_t>((timeout_ns + kNsPerMs - 1) / kNsPerMs, 0, 1'000'000));
    const int result = poll(&wait, 1, timeout_ms);
    return result < 0 && errno != EINTR ? -errno : std::max(result, 0);
  }

  void Close() override {
    if (descriptor_ >= 0) {
      close(descriptor_);
      descriptor_ = -1;
    }
  }

 private:
  int descriptor_ = -1;
};

}  // namespace

std::unique_ptr<Device> MakeSystemDevice() { return std::make_unique<SystemDevice>(); }

}  // namespace fovea::v4l2
