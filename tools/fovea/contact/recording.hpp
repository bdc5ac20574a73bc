// SPDX-License-Identifier: Apache-2.0
// The external torque that a log records, as the detector of pushes judges it: with the detector's own code,
// so that one run shows what every threshold would do.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "firmware/core/config/safety_config.hpp"

namespace fovea::contact {

// What is compared with a threshold on the joints' torque.
enum class Detector : std::uint8_t {
  kTotal,   // the external torque
  kSudden,  // the part of it that changes quickly
  kBoth,    // the servo's own: the larger of the first, and the second times a weight
};
inline constexpr std::array kDetectors{Detector::kTotal, Detector::kSudden, Detector::kBoth};
const char* Name(Detector detector);

// A tick in which the servo checks for contact.
struct WatchedTick {
  double t_s = 0.0;
  std::array<double, kDetectors.size()> share{};  // of the joint with the largest, of its largest torque
  bool moves = false;                             // a joint is faster than 0.01 rad/s
  std::vector<double> q;                          // [rad, m]
};

struct Recording {
  std::vector<WatchedTick> ticks;
  std::string fault;  // that ended the watch; "" if none
  double fault_s = 0.0;
};

// Of kBoth: how much lower the limit of a sudden torque is than that of the total one.
double SuddenWeight(const config::SafetyConfig& safety);

// Reads a log, or the log of a run's folder. The watch ends with the first fault. std::runtime_error, naming
// the file: it cannot be read.
Recording ReadRecording(const std::filesystem::path& log_or_folder, double sudden_weight);

}  // namespace fovea::contact
