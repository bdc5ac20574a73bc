// SPDX-License-Identifier: Apache-2.0
// What a live page shows and offers: channels, parameters, faults and services of one run. Fixed from the
// server's start to its end.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fovea::live {

// Decides what a viewer loses that reads too slowly: pictures first, then plots, nothing else.
enum class Weight {
  kEssential,
  kPlot,
  kPicture,
};

struct Channel {
  std::string topic;
  std::string schema_name;  // e.g. "fovea.log.Tick"
  std::string schema;       // as the protocol sends it: a FileDescriptorSet in base64, or JSON text
  Weight weight = Weight::kEssential;
  bool latched = false;  // a new subscriber gets the last message at once
  // Most messages per second of wall time; 0: all. The newest of those between is sent once none is newer.
  double most_hz = 0.0;
  std::string encoding = "protobuf";
  std::string schema_encoding = "protobuf";
};

// A number that may change in motion.
struct Parameter {
  std::string name;  // the key, e.g. "servo.lambda"
  std::string unit;  // "" when it has none
  std::string meaning;
  double min = 0.0;
  double max = 0.0;
  double value = 0.0;
  double default_value = 0.0;
};

// A number that sizes a fault.
struct FaultSetting {
  std::string name;
  std::string words;
  std::string unit;
  double min = 0.0;
  double max = 0.0;
  double value = 0.0;  // at the start
  bool whole = false;  // only whole numbers; 0 and 1 of a flag
};

// A fault that a viewer may inject.
struct FaultKind {
  std::string name;
  std::string words;
  std::vector<FaultSetting> settings;
};

// In the order of ServiceNames(). /control/take and /control/give exist wherever anything else may be called.
enum class Service {
  kHold,
  kTrack,
  kRecover,
  kPause,
  kStep,
  kSpeed,
  kReset,
  kSave,
  kEnd,
  kStartFault,
  kStopFault,
  kPull,
  kRelease,
  kThrow,
  kTakeControl,
  kGiveControl,
};
inline constexpr std::size_t kNumServices = 16;

// E.g. "/servo/hold"; static storage.
const char* Name(Service service);

struct Catalogue {
  std::string name;               // of the run, as viewers show it
  std::vector<Channel> channels;  // Server::Publish takes the index
  std::vector<Parameter> parameters;
  bool tune = false;  // viewers may set parameters
  std::vector<FaultKind> faults;
  std::vector<Service> services;  // that the program allows
  bool anyone_may_end = false;    // /run/end is a stop: it needs no control
  bool target = false;            // viewers may move the target: /target/pose and /target/release
};

}  // namespace fovea::live
