// SPDX-License-Identifier: Apache-2.0
// The server of the live page: HTTP and the Foxglove WebSocket protocol on one port, at a loopback address.
//
//   run's threads -> Publish, SetState -> bounded inbox -> the server's thread -> one bounded outbox per
//   viewer viewers -> the server's thread: checks -> bounded queue -> TakeCalls, on the run's own thread ->
//   answers
//
// One thread of normal priority does all network work. No call of this class waits for a viewer.
// README.md in this folder has the rules of trust.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"

namespace fovea::live {

// What one viewer may cost.
struct Limits {
  std::size_t viewers = 20;
  std::size_t connections = 64;           // viewers, and requests for files
  std::size_t message_bytes = 64 * 1024;  // of a message from a viewer; larger ones close the connection
  double messages_per_s = 200.0;          // from a viewer, on average; more close the connection
  double messages_burst = 400.0;          // from a viewer at once
  std::size_t calls = 256;                // that wait for TakeCalls, of all viewers; more are refused
  std::size_t pictures = 2;               // that wait for a viewer; older ones are dropped
  std::size_t plot_bytes = 1024 * 1024;   // of plots that wait for a viewer; older ones are dropped
  std::size_t essential_bytes = 32 * 1024 * 1024;  // of all else that waits; more close the connection
  std::size_t inbox_bytes = 16 * 1024 * 1024;      // published and not yet distributed; more is dropped
  std::chrono::milliseconds behind{10'000};        // a viewer that takes nothing for so long is disconnected
  std::chrono::milliseconds control{10'000};       // control ends after so long without a message
  std::chrono::milliseconds handshake{5'000};      // a request must be complete by then
  std::chrono::milliseconds silence{20'000};  // a viewer that answers no ping for so long is disconnected
};

struct ServerConfig {
  std::string address = "127.0.0.1";  // to listen at
  std::uint16_t port = 8765;          // 0: any free one
  std::string token;                  // "": a random one
  // Besides the server's own: origins of pages that may connect, e.g. "https://app.foxglove.dev".
  std::vector<std::string> allowed_origins;
  std::vector<std::string> host_names;  // besides the address and localhost: names by which viewers call it
  std::filesystem::path page;           // folder of the page; empty: the one in the share folder
  // Makes the page /report of the run so far. Called on a thread of its own, one call at a time; an exception
  // is shown to the viewer. Empty: there is no such page.
  std::function<std::string()> report;
  Limits limits;
};

class Server {
 public:
  // Listens, and starts the thread. config::InputError: the port is taken (names who holds it, if the system
  // tells, and the next free port), the address is not one of this computer's, or an entry of the catalogue
  // is invalid. std::runtime_error: the page is missing.
  Server(ServerConfig config, Catalogue catalogue);
  // Tells the viewers that the run has ended, and disconnects them: within a second, and after a report that
  // is being made.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  // http://ADDRESS:PORT/?token=TOKEN, for a person.
  [[nodiscard]] std::string url() const;

  // From any thread that is not real-time. Locks for the time of a list operation; never waits for a viewer.
  // `channel`: index in Catalogue::channels. `stamp_ns`: log time. Drops the message where there is no room.
  void Publish(std::size_t channel, std::int64_t stamp_ns, std::string payload);
  // Whether Publish would take a message: a viewer has subscribed, or the channel is latched. From any
  // thread; lock-free.
  [[nodiscard]] bool Wants(std::size_t channel) const;
  // The run's time, in the clock of the stamps; viewers get it each 50 ms. From any thread; lock-free.
  void SetTime(std::int64_t now_ns);
  // From any thread that is not real-time, as often as it likes. Viewers get the state at 10 Hz, and at once
  // when anything but times, real-time factor and poses changes.
  void SetState(const State& state);
  // A parameter that the program itself changed, e.g. by a reset.
  void SetParameter(std::size_t parameter, double value);

  // From one thread, the run's own, often: passes each waiting call to `handle` in the order of arrival, and
  // sends its answer. Returns the number of calls. `handle` must not throw.
  using Handler = std::function<Answer(const Call& call)>;
  std::size_t TakeCalls(const Handler& handle);
  // The same thread, e.g. while the run is paused: waits until a call is there. False after `at_most`.
  [[nodiscard]] bool WaitForCalls(std::chrono::milliseconds at_most);

  // From any thread.
  [[nodiscard]] std::size_t viewers() const;
  // Messages that the run published and that did not reach every subscriber.
  struct Dropped {
    std::uint64_t inbox = 0;     // for all viewers, because the server's thread lagged
    std::uint64_t pictures = 0;  // for one viewer, which lagged
    std::uint64_t plots = 0;
    std::uint64_t viewers = 0;   // disconnected because they took nothing, too much, or broke a rule
    std::uint64_t troubles = 0;  // exceptions of the server's thread, e.g. no memory for a message
  };
  [[nodiscard]] Dropped dropped() const;

 private:
  class Network;
  std::unique_ptr<Network> network_;
};

}  // namespace fovea::live
