// SPDX-License-Identifier: Apache-2.0
// The sockets of /proc/net/tcp, then the process that has that socket open.
#include "firmware/host/live/port_owner.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>
#include <vector>

namespace fovea::live {
namespace {

namespace fs = std::filesystem;

// The inodes of sockets that listen at the port.
void AddListeners(const char* table, std::uint16_t port, std::set<std::string>& inodes) {
  std::ifstream lines(table);
  const std::string ends = fmt::format(":{:04X}", port);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string number, local, remote, state, skipped, inode;
    words >> number >> local >> remote >> state;
    for (int i = 0; i < 5; ++i) {
      words >> skipped;
    }
    if (words >> inode && state == "0A" && local.ends_with(ends)) {
      inodes.insert("socket:[" + inode + "]");
    }
  }
}

bool HasOpen(const fs::path& process, const std::set<std::string>& sockets) {
  std::error_code error;
  for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code unreadable;
    if (sockets.contains(fs::read_symlink(file->path(), unreadable).string())) {
      return true;
    }
  }
  return false;
}

constexpr int kPortsTried = 50;

bool IsFree(const std::string& address, std::uint16_t port) {
  sockaddr_in version_4{};
  sockaddr_in6 version_6{};
  version_4.sin_family = AF_INET;
  version_4.sin_port = version_6.sin6_port = htons(port);
  version_6.sin6_family = AF_INET6;
  const bool is_4 = inet_pton(AF_INET, address.c_str(), &version_4.sin_addr) == 1;
  const bool is_6 = !is_4 && inet_pton(AF_INET6, address.c_str(), &version_6.sin6_addr) == 1;
  const int handle = is_4 || is_6 ? ::socket(is_4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0) : -1;
  if (handle < 0) {
    return false;
  }
  const auto* const place =
      is_4 ? reinterpret_cast<const sockaddr*>(&version_4) : reinterpret_cast<const sockaddr*>(&version_6);
  const auto size = static_cast<socklen_t>(is_4 ? sizeof version_4 : sizeof version_6);
  const bool is_free = ::bind(handle, place, size) == 0;
  close(handle);
  return is_free;
}

}  // namespace

std::string PortOwner(std::uint16_t port) {
  std::set<std::string> sockets;
  AddListeners("/proc/net/tcp", port, sockets);
  AddListeners("/proc/net/tcp6", port, sockets);
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end && !sockets.empty();
       process.increment(error)) {
    const std::string number = process->path().filename();
    if (number.find_first_not_of("0123456789") == std::string::npos && HasOpen(process->path(), sockets)) {
      std::string name;
      std::getline(std::ifstream(process->path() / "comm"), name);
      return fmt::format("{} (process {})", name.empty() ? "a program" : name, number);
    }
  }
  return "";
}

std::string PortIsTaken(const std::string& address, std::uint16_t port) {
  const std::string owner = PortOwner(port);
  std::string text =
      fmt::format("port {} of {} is in use{}", port, address, owner.empty() ? "" : " by " + owner);
  for (int next = port + 1; next <= std::min(port + kPortsTried, 65535); ++next) {
    if (IsFree(address, static_cast<std::uint16_t>(next))) {
      return text + fmt::format("; port {0} is free: --port {0}", next);
    }
  }
  return text;
}

}  // namespace fovea::live
