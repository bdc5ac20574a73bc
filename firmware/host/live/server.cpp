// SPDX-License-Identifier: Apache-2.0
// The server: the threads around the hub, what the run publishes, and the rules of trust for each request.
#include "firmware/host/live/server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/live/access.hpp"
#include "firmware/host/live/call_queue.hpp"
#include "firmware/host/live/hub.hpp"
#include "firmware/host/live/inbox.hpp"
#include "firmware/host/live/page_files.hpp"
#include "firmware/host/live/web.hpp"

namespace fovea::live {
namespace {

// The page's own scripts and styles, and no others.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self' {}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
// A report holds its own scripts, and its own stricter policy.
constexpr const char* kReportPolicy = "frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

constexpr std::array<std::string_view, 2> kSubprotocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};

// The first known name of the list that a client offers; "" when it offers none.
std::string ChooseSubprotocol(std::string_view offered) {
  while (!offered.empty()) {
    const std::size_t end = std::min(offered.find(','), offered.size());
    std::string_view name = offered.substr(0, end);
    offered.remove_prefix(std::min(end + 1, offered.size()));
    while (name.starts_with(' ')) {
      name.remove_prefix(1);
    }
    while (name.ends_with(' ')) {
      name.remove_suffix(1);
    }
    if (std::find(kSubprotocols.begin(), kSubprotocols.end(), name) != kSubprotocols.end()) {
      return std::string(name);
    }
  }
  return "";
}

WebResponse TextResponse(unsigned status, std::string text) {
  return {.status = status, .content = std::move(text) + "\n"};
}

// The authority of the server's own address.
std::string AuthorityOf(const Access& access) {
  const bool is_version_6 = access.address.find(':') != std::string::npos;
  return fmt::format("{}{}{}:{}", is_version_6 ? "[" : "", access.address, is_version_6 ? "]" : "",
                     access.port);
}

std::filesystem::path PageOf(const ServerConfig& config) {
  return config.page.empty() ? config::ShareFolder() / "live" : config.page;
}

Access AccessOf(const ServerConfig& config) {
  if (!config.token.empty() && !IsUsableToken(config.token)) {
    throw config::InputError("the live page's token must be 8 to 128 letters, digits, '-' or '_'");
  }
  return {config.address, config.port, config.token.empty() ? RandomToken() : config.token,
          config.allowed_origins, config.host_names};
}

void CheckCatalogue(const Catalogue& catalogue) {
  for (const Parameter& parameter : catalogue.parameters) {
    if (!(parameter.min <= parameter.value && parameter.value <= parameter.max)) {
      throw config::InputError(fmt::format("{}: its value {:g} is not in its range {:g} to {:g}",
                                           parameter.name, parameter.value, parameter.min, parameter.max));
    }
  }
}

}  // namespace

class Server::Network {
 public:
  Network(ServerConfig config, Catalogue catalogue)
      : config_(std::move(config)),
        access_(AccessOf(config_)),
        files_(PageOf(config_), config::ShareFolder() / "report" / "shared"),
        calls_(config_.limits.calls),
        hub_(config_.limits, std::move(catalogue), calls_),
        inbox_(config_.limits.inbox_bytes),
        web_(config_.address, config_.port, config_.limits, MakeHandlers()) {
    access_.port = web_.port();
    policy_ = fmt::format(kPagePolicy, "ws://" + AuthorityOf(access_));
    thread_ = std::thread([this] { Serve(); });
  }

  ~Network() {
    web_.Post([this] { hub_.Tell(StatusLevel::kInfo, "the run has ended"); });
    web_.Stop({kGoingAway, "the run has ended"});
    thread_.join();
    if (report_thread_.joinable()) {
      report_thread_.join();
    }
  }
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  [[nodiscard]] const Access& access() const { return access_; }
  [[nodiscard]] const Hub& hub() const { return hub_; }
  [[nodiscard]] bool Wants(std::size_t channel) const {
    return hub_.catalogue().channels[channel].latched || hub_.IsWanted(channel);
  }
  void Publish(std::size_t channel, std::int64_t stamp_ns, std::string payload) {
    if (Wants(channel)) {
      inbox_.Add({channel, stamp_ns, std::move(payload)}, hub_.catalogue().channels[channel]);
      Wake();
    }
  }
  void SetTime(std::int64_t now_ns) { now_ns_.store(now_ns, std::memory_order_relaxed); }
  void SetState(const State& state) {
    inbox_.SetState(state);
    Wake();
  }
  void SetParameter(std::size_t parameter, double value) {
    web_.Post([this, parameter, value] { hub_.SetParameter(parameter, value); });
  }

  std::size_t TakeCalls(const Handler& handle) {
    const std::deque<PendingCall> pending = calls_.TakeAll();
    for (const PendingCall& each : pending) {
      calls_.AddAnswer({each.from, each.call.request, handle(each.call)});
    }
    if (!pending.empty()) {
      Wake();
    }
    return pending.size();
  }
  bool WaitForCalls(std::chrono::milliseconds at_most) { return calls_.WaitForOne(at_most); }

  [[nodiscard]] Dropped dropped() const {
    return {inbox_.dropped(), hub_.dropped_pictures(), hub_.dropped_plots(), web_.expelled(), troubles_};
  }

 private:
  // Trouble with one connection, e.g. no memory for its message, must not end the program or the server.
  void Serve() noexcept {
    for (bool runs = true; runs;) {
      try {
        web_.Run();
        runs = false;
      } catch (...) {
        ++troubles_;
      }
    }
  }

  // At most one waits, however much is published.
  void Wake() {
    if (!is_woken_.exchange(true)) {
      web_.Post([this] {
        is_woken_ = false;
        Distribute();
      });
    }
  }

  void Distribute() {
    const Clock::time_point now = Clock::now();
    for (Published& message : inbox_.TakeMessages()) {
      hub_.Distribute(message.channel, message.stamp_ns, std::move(message.payload), now);
    }
    if (const std::optional<State> state = inbox_.TakeState()) {
      hub_.SetState(*state);
    }
    hub_.SendAnswers();
    Write();
  }

  void Write() {
    for (const std::uint64_t viewer : hub_.TakeHopeless()) {
      web_.Cut(viewer);
    }
    web_.Flush();
  }

  Web::Handlers MakeHandlers() {
    Web::Handlers handlers;
    handlers.get = [this](const WebRequest& request, const Web::Handlers::Reply& reply) {
      Get(request, reply);
    };
    handlers.welcome = [this](const WebRequest& request) { return Welcome(request); };
    handlers.join = [this] { return hub_.Join(); };
    handlers.leave = [this](std::uint64_t viewer) { hub_.Leave(viewer); };
    handlers.receive = [this](std::uint64_t viewer, bool is_text, std::string_view bytes) {
      return hub_.Receive(viewer, is_text, bytes, Clock::now());
    };
    handlers.next = [this](std::uint64_t viewer) { return hub_.Next(viewer); };
    handlers.pulse = [this] {
      hub_.Pulse(now_ns_.load(std::memory_order_relaxed), Clock::now());
      Write();
    };
    return handlers;
  }

  Web::Handlers::Welcome Welcome(const WebRequest& request) const {
    std::optional<Denial> denial = CheckHost(access_, request.host, request.origin);
    if (!denial) {
      denial = CheckToken(access_, request.target);
    }
    const std::string subprotocol = ChooseSubprotocol(request.subprotocols);
    if (!denial && subprotocol.empty()) {
      denial = Denial{400, fmt::format("A viewer must ask for the subprotocol {} or {}.", kSubprotocols[0],
                                       kSubprotocols[1])};
    }
    if (!denial && hub_.viewers() >= config_.limits.viewers) {
      denial = Denial{
          503, fmt::format("There are {} viewers already: close one of them first.", config_.limits.viewers)};
    }
    return {subprotocol, denial ? std::optional(TextResponse(denial->status, denial->text)) : std::nullopt};
  }

  void Get(const WebRequest& request, const Web::Handlers::Reply& reply) {
    const std::string_view path = PathOf(request.target);
    const bool is_report = path == "/report" && config_.report;
    const bool is_private = path == "/" || is_report;
    std::optional<Denial> denial = CheckHost(access_, request.host, request.origin);
    if (!denial && is_private) {
      denial = CheckToken(access_, request.target);
    }
    const PageFile* const file = files_.Find(path);
    if (!denial && !request.is_get) {
      denial = Denial{405, "This server only shows pages."};
    }
    if (!denial && !is_report && file == nullptr) {
      denial = Denial{404, "There is no such page."};
    }
    if (denial) {
      reply(TextResponse(denial->status, denial->text));
    } else if (is_report) {
      MakeReport(reply);
    } else {
      reply({200, file->type, file->content, policy_});
    }
  }

  void MakeReport(const Web::Handlers::Reply& reply) {
    if (is_reporting_.exchange(true)) {
      reply(TextResponse(503, "A report is being made: try again in a moment."));
      return;
    }
    if (report_thread_.joinable()) {
      report_thread_.join();  // it has ended
    }
    report_thread_ = std::thread([this, answer = reply]() mutable {
      WebResponse response{200, "text/html; charset=utf-8", {}, kReportPolicy};
      try {
        response.content = config_.report();
      } catch (const std::exception& error) {
        response = TextResponse(503, std::string("The report cannot be made: ") + error.what());
      }
      // The connection belongs to the server's thread, which is also the one that lets go of it.
      web_.Post([answer = std::move(answer), response = std::move(response)] { answer(response); });
      is_reporting_ = false;
    });
  }

  const ServerConfig config_;
  Access access_;
  const PageFiles files_;
  CallQueue calls_;
  Hub hub_;
  Inbox inbox_;
  std::atomic<bool> is_woken_{false};
  std::atomic<std::uint64_t> troubles_{0};  // exceptions of the server's thread
  std::atomic<std::int64_t> now_ns_{0};
  Web web_;  // destroyed before all that its handlers use
  std::string policy_;
  std::atomic<bool> is_reporting_{false};
  std::thread report_thread_;
  std::thread thread_;
};

Server::Server(ServerConfig config, Catalogue catalogue) {
  CheckCatalogue(catalogue);
  network_ = std::make_unique<Network>(std::move(config), std::move(catalogue));
}

Server::~Server() = default;

std::uint16_t Server::port() const { return network_->access().port; }

std::string Server::url() const {
  return fmt::format("http://{}/?token={}", AuthorityOf(network_->access()), network_->access().token);
}

void Server::Publish(std::size_t channel, std::int64_t stamp_ns, std::string payload) {
  network_->Publish(channel, stamp_ns, std::move(payload));
}

bool Server::Wants(std::size_t channel) const { return network_->Wants(channel); }

void Server::SetTime(std::int64_t now_ns) { network_->SetTime(now_ns); }

void Server::SetState(const State& state) { network_->SetState(state); }

void Server::SetParameter(std::size_t parameter, double value) { network_->SetParameter(parameter, value); }

std::size_t Server::TakeCalls(const Handler& handle) { return network_->TakeCalls(handle); }

bool Server::WaitForCalls(std::chrono::milliseconds at_most) { return network_->WaitForCalls(at_most); }

std::size_t Server::viewers() const { return network_->hub().viewers(); }

Server::Dropped Server::dropped() const { return network_->dropped(); }

}  // namespace fovea::live
