// SPDX-License-Identifier: Apache-2.0
// Who listens at a TCP port, as far as /proc tells this user, and which port is free.
#pragma once

#include <cstdint>
#include <string>

namespace fovea::live {

// E.g. "fovea-sim (process 1234)"; "" when it cannot be told.
std::string PortOwner(std::uint16_t port);

// The message for a person who asked for a port that is in use: who has it, and the next free one.
// `address`: a literal one of this computer.
std::string PortIsTaken(const std::string& address, std::uint16_t port);

}  // namespace fovea::live
