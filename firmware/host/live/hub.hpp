// SPDX-License-Identifier: Apache-2.0
// The viewers of a run and what is said to them: the Foxglove protocol, without sockets.
//
// One thread uses it, the server's. It never blocks.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/live/call_queue.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/client_message.hpp"
#include "firmware/host/live/control.hpp"
#include "firmware/host/live/outbox.hpp"
#include "firmware/host/live/rate_limit.hpp"
#include "firmware/host/live/server.hpp"
#include "firmware/host/live/server_messages.hpp"

namespace fovea::live {

// Why a connection ends: a WebSocket close code, and one line.
struct Closing {
  unsigned code = 1000;
  std::string reason;
};
inline constexpr unsigned kGoingAway = 1001;
inline constexpr unsigned kAgainstTheRules = 1008;
inline constexpr unsigned kTryLater = 1013;

class Hub {
 public:
  // Borrows both. Adds /live/state, /live/parameters and the services of control to the catalogue.
  Hub(const Limits& limits, Catalogue catalogue, CallQueue& calls);
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }

  // A viewer came; its number, from 1. Its outbox has the messages that begin a connection.
  std::uint64_t Join();
  void Leave(std::uint64_t viewer);
  // A message from a viewer. None: the connection goes on.
  std::optional<Closing> Receive(std::uint64_t viewer, bool is_text, std::string_view bytes,
                                 Clock::time_point now);
  // The next message to a viewer; none when there is none, or no such viewer.
  std::optional<Outgoing> Next(std::uint64_t viewer);
  // The viewers whose outboxes overflowed, since the last call: their connections have to end.
  std::vector<std::uint64_t> TakeHopeless();

  // From the run. `channel`: index in the catalogue that was given.
  void Distribute(std::size_t channel, std::int64_t stamp_ns, std::string payload, Clock::time_point now);
  void SetState(const State& state);
  void SetParameter(std::size_t parameter, double value);
  // Sends the answers that wait in the call queue.
  void SendAnswers();
  // Says something to all viewers.
  void Tell(StatusLevel level, const std::string& text);

  // Call each 50 ms: time, state, parameters, the end of a silent viewer's control, and what was dropped.
  void Pulse(std::int64_t now_ns, Clock::time_point now);

  // From any thread; lock-free. `channel`: index in the catalogue.
  [[nodiscard]] bool IsWanted(std::size_t channel) const {
    return subscribers_[channel].load(std::memory_order_relaxed) > 0;
  }
  [[nodiscard]] std::size_t viewers() const { return num_viewers_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t dropped_pictures() const { return dropped_pictures_; }
  [[nodiscard]] std::uint64_t dropped_plots() const { return dropped_plots_; }

 private:
  struct Viewer {
    Viewer(std::uint64_t viewer, const Limits& limits);

    std::uint64_t number;
    std::string name;
    Outbox outbox;
    RateLimit messages;
    RateLimit statuses;                       // that the viewer gets about its own mistakes
    std::vector<Subscription> subscriptions;  // their channel is an index
    std::vector<ClientChannel> channels;      // of its own
    std::vector<bool> watched;                // parameters whose changes it gets
    std::uint64_t counted_pictures = 0;       // drops that the hub's sums contain
    std::uint64_t counted_plots = 0;
    bool is_hopeless = false;
  };
  // The parameters of one message, until all of them are answered.
  struct ParameterGroup {
    std::uint64_t viewer = 0;
    std::string id;
    std::vector<std::size_t> parameters;
    std::size_t left = 0;
  };
  struct Message {
    std::int64_t stamp_ns = 0;
    std::shared_ptr<const std::string> payload;  // null: none
  };
  // The last messages of a channel.
  struct ChannelState {
    Message latched;
    Message held;  // came too soon after the last one that was sent
    Clock::time_point sent{};
    Clock::time_point held_since{};
  };

  void Handle(Viewer& viewer, const Subscribe& message);
  void Handle(Viewer& viewer, const Unsubscribe& message);
  void Handle(Viewer& viewer, const Advertise& message);
  void Handle(Viewer& viewer, const Unadvertise& message);
  void Handle(Viewer& viewer, const GetParameters& message);
  void Handle(Viewer& viewer, const SetParameters& message);
  void Handle(Viewer& viewer, const SubscribeParameters& message);
  void Handle(Viewer& viewer, const ClientData& message);
  void Handle(Viewer& viewer, const ServiceCall& message);
  void Handle(Viewer& viewer, const UnknownOperation& message);

  void Send(Viewer& viewer, Outgoing message);
  // An error about the viewer's own message; a few a second at most.
  void Complain(Viewer& viewer, const std::string& text, StatusLevel level = StatusLevel::kError);
  // Refusal: somebody else has control, or there are no such services.
  void RequireControl(Viewer& viewer);
  // To the run. Refusal: too many calls wait.
  void Forward(Viewer& viewer, ReturnAddress from, Request request);
  void CallService(Viewer& viewer, Service service, const ServiceCall& message);
  std::string TakeControl(Viewer& viewer, std::string_view payload);
  void EndControl(Viewer& viewer);
  void CheckNewValue(Viewer& viewer, const NewValue& value, std::size_t parameter);
  [[nodiscard]] std::size_t IndexOfParameter(const std::string& name) const;  // size() when there is none
  [[nodiscard]] std::vector<const Parameter*> Values(const std::vector<std::size_t>& parameters) const;
  void FinishParameter(std::uint64_t group);
  void SendState(Viewer& viewer, const std::string& common);
  void SendStates();
  void SendParameters();
  void SendHeld(Clock::time_point now);
  void DeliverToAll(std::size_t channel, const Message& message, Clock::time_point now);
  void CountDrops(Viewer& viewer);
  void Deliver(Viewer& viewer, const Subscription& subscription, const Message& message);
  [[nodiscard]] std::size_t StateChannel() const { return catalogue_.channels.size() - 2; }
  [[nodiscard]] std::size_t ParametersChannel() const { return catalogue_.channels.size() - 1; }

  const Limits& limits_;
  CallQueue& calls_;
  Catalogue catalogue_;
  const std::string session_;
  Control control_;
  std::map<std::uint64_t, Viewer> viewers_;
  std::uint64_t last_viewer_ = 0;
  std::vector<ChannelState> channels_;                         // by channel
  std::unique_ptr<std::atomic<std::uint32_t>[]> subscribers_;  // by channel
  std::map<std::uint64_t, ParameterGroup> groups_;
  std::uint64_t last_group_ = 0;
  State state_;
  bool has_state_ = false;
  std::int64_t now_ns_ = 0;
  Clock::time_point now_{};
  Clock::time_point state_sent_{};
  Clock::time_point drops_told_{};
  bool parameters_changed_ = false;
  std::atomic<std::size_t> num_viewers_{0};
  std::atomic<std::uint64_t> dropped_pictures_{0};
  std::atomic<std::uint64_t> dropped_plots_{0};
};

}  // namespace fovea::live
