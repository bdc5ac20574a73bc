// SPDX-License-Identifier: Apache-2.0
// The driver's interface to the kernel: one video device, opened by its path. A test can replace the kernel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace fovea::v4l2 {

class Device {
 public:
  virtual ~Device() = default;

  // Each returns 0 or more on success, else -errno.
  virtual int Open(const std::string& path) = 0;
  virtual int Control(unsigned long request, void* argument) = 0;  // an ioctl
  virtual int Map(std::size_t size, std::int64_t offset, void*& memory) = 0;
  virtual void Unmap(void* memory, std::size_t size) = 0;
  // 1: a buffer or an error is waiting; 0: timeout.
  virtual int Wait(std::int64_t timeout_ns) = 0;
  virtual void Close() = 0;
};

// The kernel itself.
std::unique_ptr<Device> MakeSystemDevice();

}  // namespace fovea::v4l2
