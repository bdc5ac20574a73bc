// SPDX-License-Identifier: Apache-2.0
// The only source that includes Boost, with web_connections.hpp: its headers take longer to compile than all
// the rest of the folder.
#include "firmware/host/live/web.hpp"

#include <fmt/format.h>

#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/live/port_owner.hpp"
#include "firmware/host/live/web_connections.hpp"

namespace fovea::live {
namespace {

constexpr auto kPulse = std::chrono::milliseconds(50);
constexpr auto kFarewell = std::chrono::milliseconds(500);  // for viewers to answer the close at the end
constexpr int kSendBufferBytes = 256 * 1024;                // of the system: more would only be older

// "" or why the acceptor cannot listen there.
std::string Listen(tcp::acceptor& acceptor, const tcp::endpoint& place) {
  try {
    acceptor.open(place.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    acceptor.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes));  // of its connections, too
    acceptor.bind(place);
    acceptor.listen();
    return "";
  } catch (const boost::system::system_error& error) {
    return error.code().message();
  }
}

}  // namespace

void Web::Parts::Accept() {
  acceptor.async_accept([self = shared_from_this()](error_code error, tcp::socket socket) {
    if (self->stops) {
      return;
    }
    if (error) {  // e.g. too many open files
      self->pause.expires_after(std::chrono::milliseconds(100));
      self->pause.async_wait([self](error_code) { self->Accept(); });
      return;
    }
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    self->Admit(std::move(socket));
    self->Accept();
  });
}

// Where all connections are taken, the oldest that is no viewer yet makes room: others cannot keep an
// operator out by opening connections.
void Web::Parts::Admit(tcp::socket socket) {
  std::erase_if(visits, [](const std::weak_ptr<Visit>& visit) { return visit.expired(); });
  if (connections >= limits.connections) {
    if (visits.empty()) {
      return;
    }
    if (const auto oldest = visits.front().lock()) {
      oldest->Drop();
    }
    visits.pop_front();
  }
  const auto visit = std::make_shared<Visit>(shared_from_this(), std::move(socket));
  visits.push_back(visit);
  visit->Read();
}

void Web::Parts::Pulse() {
  pulse.expires_after(kPulse);
  pulse.async_wait([self = shared_from_this()](error_code error) {
    if (error || self->stops) {
      return;
    }
    self->handlers.pulse();
    const auto now = Clock::now();
    const auto open = self->viewers;  // End changes the map
    for (const auto& [number, viewer] : open) {
      if (viewer->IsBehind(now)) {
        ++self->expelled;
        viewer->End();
      }
    }
    self->Pulse();
  });
}

Web::Web(const std::string& address, std::uint16_t port, const Limits& limits, Handlers handlers)
    : io_(std::make_unique<Io>()),
      parts_(std::make_shared<Parts>(io_->context, limits, std::move(handlers))) {
  error_code error;
  const auto literal = asio::ip::make_address(address, error);
  if (error) {
    throw config::InputError(address + " is no address to listen at; try 127.0.0.1");
  }
  const tcp::endpoint place(literal, port);
  if (const std::string why = Listen(parts_->acceptor, place); !why.empty()) {
    throw config::InputError(why == error_code(asio::error::address_in_use).message()
                                 ? PortIsTaken(address, port)
                                 : fmt::format("cannot listen at {} port {}: {}", address, port, why));
  }
  parts_->Accept();
  parts_->Pulse();
}

// Each connection shares the parts; the operations that still wait in the context go with it.
Web::~Web() {
  const auto viewers = parts_->viewers;
  for (const auto& [number, viewer] : viewers) {
    viewer->End();
  }
}

std::uint16_t Web::port() const { return parts_->acceptor.local_endpoint().port(); }

void Web::Run() { io_->context.run(); }

void Web::Stop(const Closing& closing) {
  Post([parts = parts_, closing] {
    parts->stops = true;
    parts->pulse.cancel();
    const auto viewers = parts->viewers;
    for (const auto& [number, viewer] : viewers) {
      viewer->CloseAfterAll(closing);
    }
    parts->farewell.expires_after(viewers.empty() ? std::chrono::milliseconds(0) : kFarewell);
    parts->farewell.async_wait([parts](error_code) { parts->io.stop(); });
  });
}

void Web::Post(std::function<void()> job) { asio::post(parts_->io, std::move(job)); }

void Web::Flush() {
  const auto viewers = parts_->viewers;
  for (const auto& [number, viewer] : viewers) {
    viewer->Write();
  }
}

void Web::Cut(std::uint64_t number) {
  if (const auto found = parts_->viewers.find(number); found != parts_->viewers.end()) {
    ++parts_->expelled;
    const auto viewer = found->second;
    viewer->End();
  }
}

std::uint64_t Web::expelled() const { return parts_->expelled; }

}  // namespace fovea::live
