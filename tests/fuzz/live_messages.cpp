// SPDX-License-Identifier: Apache-2.0
// What a client of the live page sends, as text and as binary messages: it is refused in one line, or the run
// gets a request whose numbers are finite and in their ranges.
#include <algorithm>
#include <cmath>

#include "firmware/host/live/hub.hpp"
#include "firmware/host/live/services.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

using fovea::fuzz::Require;
using namespace fovea::live;

namespace {

Catalogue Everything() {
  Catalogue catalogue;
  catalogue.channels = {{"/plot", "A", "", Weight::kPlot}, {"/once", "B", "", Weight::kEssential, true}};
  catalogue.parameters = {{"a.b", "m", "", -1.0, 1.0, 0.0, 0.0}};
  catalogue.tune = catalogue.target = true;
  catalogue.faults = {{"f", "", {{"g", "", "", 0.0, 2.0, 1.0}}}};
  for (std::size_t i = 0; i + 2 < kNumServices; ++i) {
    catalogue.services.push_back(static_cast<Service>(i));
  }
  return catalogue;
}

template <std::size_t size>
void RequireWithin(const std::array<double, size>& values, double most) {
  Require(std::all_of(values.begin(), values.end(), [most](double v) { return std::abs(v) <= most; }),
          "a vector is finite and in its range");
}

struct Checker {
  void operator()(const Step& step) const {
    Require(step.ticks >= 1 && step.ticks <= kMostSteps, "a number of ticks is in its range");
  }
  void operator()(const Speed& speed) const {
    Require(speed.factor == 0.0 || (speed.factor >= kLeastFactor && speed.factor <= 1.0),
            "a speed is in its range");
  }
  void operator()(const StartFault& start) const {
    Require(start.fault == 0, "a fault is one of the catalogue");
    for (const auto& [name, size] : start.sizes) {
      Require(name == "g" && size >= 0.0 && size <= 2.0, "a fault's size is in its range");
    }
  }
  void operator()(const StopFault& stop) const {
    Require(stop.fault == 0, "a fault is one of the catalogue");
  }
  void operator()(const Pull& pull) const {
    RequireWithin(pull.p_link, kMostMetres);
    RequireWithin(pull.to_B, kMostMetres);
  }
  void operator()(const Throw& thrown) const {
    RequireWithin(thrown.v_BO, kMostSpeed);
    RequireWithin(thrown.omega_B, kMostTurnSpeed);
  }
  void operator()(const HoldTarget& hold) const {
    RequireWithin(hold.p_BO, kMostMetres);
    double squares = 0.0;
    for (const double part : hold.q_BO) {
      squares += part * part;
    }
    Require(std::abs(squares - 1.0) < 1e-9, "a quaternion has length 1");
  }
  void operator()(const SetParameter& set) const {
    Require(set.parameter == 0 && std::abs(set.value) <= 1.0, "a parameter is in its range");
  }
  template <typename Plain>
  void operator()(const Plain& /*request*/) const {}
};

// The run's side: takes and answers the calls that wait.
void AnswerAll(CallQueue& calls, Hub& hub) {
  for (const PendingCall& pending : calls.TakeAll()) {
    std::visit(Checker(), pending.call.request);
    calls.AddAnswer({pending.from, pending.call.request, {}});
  }
  hub.SendAnswers();
}

}  // namespace

// The input: messages, each with a byte that says which kind, and two for its length.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Limits limits;
  CallQueue calls(limits.calls);
  Hub hub(limits, Everything(), calls);
  const std::uint64_t viewer = hub.Join();
  // A channel of the viewer, so that its messages get through.
  hub.Receive(viewer, true,
              R"({"op":"advertise","channels":[{"id":1,"topic":"/target/pose","encoding":"json"}]})",
              Clock::now());
  fovea::fuzz::Bytes bytes(data, size);
  while (!bytes.empty()) {
    const std::uint8_t kind = bytes.Byte();
    const std::size_t length = 256U * bytes.Byte() + bytes.Byte();
    const auto content = bytes.Take(length);
    std::string message(content.begin(), content.end());
    if (kind % 4 == 1) {  // a call of a service that exists
      message.insert(message.begin(), {'\2', static_cast<char>(1 + kind / 4 % kNumServices), 0, 0, 0, 7, 0, 0,
                                       0, 4, 0, 0, 0, 'j', 's', 'o', 'n'});
    } else if (kind % 4 == 2) {  // a pose of the target
      message.insert(message.begin(), {'\1', 1, 0, 0, 0});
    }
    const auto closing = hub.Receive(viewer, kind % 4 == 0, message, Clock::now());
    Require(!closing || closing->code == kAgainstTheRules, "only a rule ends a connection");
    if (kind % 32 < 16) {
      AnswerAll(calls, hub);
    }
    while (const auto out = hub.Next(viewer)) {
      Require(!out->is_text || out->head.find('\n') == std::string::npos, "a text for a viewer is one line");
    }
  }
  hub.Leave(viewer);
  AnswerAll(calls, hub);
  return 0;
}
