// SPDX-License-Identifier: Apache-2.0
// The open connections of web.cpp, its only user: requests for files, and viewers.
#pragma once

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/host/live/web.hpp"

namespace fovea::live {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;
using tcp = asio::ip::tcp;

inline constexpr std::size_t kHeaderBytes = 8 * 1024;
inline constexpr std::size_t kBodyBytes = 1024;

class Viewer;
class Visit;

struct Web::Io {
  asio::io_context context{1};  // for one thread
};

struct Web::Parts : std::enable_shared_from_this<Web::Parts> {
  Parts(asio::io_context& the_io, const Limits& the_limits, Handlers the_handlers)
      : io(the_io), limits(the_limits), handlers(std::move(the_handlers)) {}

  void Accept();
  void Admit(tcp::socket socket);
  void Pulse();

  asio::io_context& io;
  const Limits& limits;
  const Handlers handlers;
  tcp::acceptor acceptor{io};
  asio::steady_timer pulse{io};
  asio::steady_timer farewell{io};
  asio::steady_timer pause{io};  // of accepting, when the process has no more files
  std::size_t connections = 0;
  std::map<std::uint64_t, std::shared_ptr<Viewer>> viewers;
  std::deque<std::weak_ptr<Visit>> visits;  // oldest first
  std::atomic<std::uint64_t> expelled{0};
  bool stops = false;
};

// Counts a connection as open while the result lives.
inline std::shared_ptr<void> Count(const std::shared_ptr<Web::Parts>& parts) {
  ++parts->connections;
  return {nullptr, [parts](void*) { --parts->connections; }};
}

// One open WebSocket.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(std::shared_ptr<Web::Parts> parts, std::shared_ptr<void> counted, beast::tcp_stream stream)
      : parts_(std::move(parts)),
        counted_(std::move(counted)),
        socket_(std::move(stream)),
        read_(parts_->limits.message_bytes) {}

  void Open(const http::request<http::string_body>& request, const std::string& subprotocol) {
    const Limits& limits = parts_->limits;
    socket_.next_layer().expires_never();  // from here on the WebSocket has its own time-outs
    socket_.set_option(websocket::stream_base::timeout{limits.handshake, limits.silence, true});
    socket_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, subprotocol);
    }));
    socket_.read_message_max(limits.message_bytes);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (!error && !self->parts_->stops) {
        self->number_ = self->parts_->handlers.join();
        self->parts_->viewers[self->number_] = self;
        self->Read();
        self->Write();
      }
    });
  }

  void Write() {
    if (is_writing_ || is_closed_) {
      return;
    }
    std::optional<Outgoing> next = parts_->handlers.next(number_);
    if (!next) {
      if (farewell_) {
        Close(*farewell_);
      }
      return;
    }
    message_ = *std::move(next);
    is_writing_ = true;
    write_began_ = Clock::now();
    socket_.text(message_.is_text);
    const asio::const_buffer payload =
        message_.payload ? asio::buffer(*message_.payload) : asio::const_buffer{};
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(message_.head), payload};
    socket_.async_write(buffers, [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
      self->is_writing_ = false;
      if (error) {
        self->End();
      } else {
        self->Write();
      }
    });
  }

  [[nodiscard]] bool IsBehind(Clock::time_point now) const {
    return is_writing_ && now - write_began_ > parts_->limits.behind;
  }

  // Closes when all that waits is written.
  void CloseAfterAll(const Closing& closing) {
    farewell_ = closing;
    Write();
  }
  void Close(const Closing& closing) {
    if (std::exchange(is_closed_, true)) {
      return;
    }
    constexpr std::size_t kMost = 120;  // bytes, by the WebSocket protocol
    const websocket::close_reason reason(static_cast<websocket::close_code>(closing.code),
                                         closing.reason.substr(0, kMost));
    socket_.async_close(reason, [self = shared_from_this()](error_code /*error*/) { self->End(); });
  }

  // Ends the connection now; safe to call again.
  void End() {
    is_closed_ = true;
    beast::get_lowest_layer(socket_).close();
    if (const std::uint64_t number = std::exchange(number_, 0); number != 0) {
      const auto self = shared_from_this();
      parts_->viewers.erase(number);
      parts_->handlers.leave(number);
      if (parts_->stops && parts_->viewers.empty()) {
        parts_->farewell.cancel();
      }
    }
  }

 private:
  void Read() {
    socket_.async_read(read_, [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
      if (error) {
        self->parts_->expelled += error == websocket::error::message_too_big ? 1U : 0U;
        self->End();
      } else if (!self->is_closed_) {
        self->Receive();
      }
    });
  }

  void Receive() {
    const auto data = read_.cdata();
    const std::string_view bytes(static_cast<const char*>(data.data()), data.size());
    const std::optional<Closing> closing = parts_->handlers.receive(number_, socket_.got_text(), bytes);
    read_.consume(read_.size());
    if (closing) {
      ++parts_->expelled;
      Close(*closing);
      return;
    }
    Write();
    Read();
  }

  std::shared_ptr<Web::Parts> parts_;
  std::shared_ptr<void> counted_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer read_;
  std::uint64_t number_ = 0;  // 0: has not joined, or has left
  Outgoing message_;          // that is being written
  bool is_writing_ = false;
  bool is_closed_ = false;
  std::optional<Closing> farewell_;
  Clock::time_point write_began_{};
};

// One request for a file, or for a WebSocket. Each connection carries one request.
class Visit : public std::enable_shared_from_this<Visit> {
 public:
  Visit(std::shared_ptr<Web::Parts> parts, tcp::socket socket)
      : parts_(std::move(parts)),
        counted_(Count(parts_)),
        stream_(std::move(socket)),
        buffer_(kHeaderBytes + kBodyBytes) {
    parser_.header_limit(kHeaderBytes);
    parser_.body_limit(kBodyBytes);
  }

  void Read() {
    stream_.expires_after(parts_->limits.handshake);
    http::async_read(
        stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
          if (!error) {
            self->Answer();
          } else if (error != http::error::end_of_stream && error != beast::error::timeout) {
            self->Reply({.status = 400, .content = "This is no request that this server reads."});
          }
        });
  }

  // What it still does fails.
  void Drop() {
    error_code ignored;
    stream_.socket().close(ignored);
  }

 private:
  void Answer() {
    const auto& request = parser_.get();
    const auto text = [](beast::string_view view) { return std::string(view.data(), view.size()); };
    is_head_ = request.method() == http::verb::head;
    const WebRequest asked{
        text(request.target()), text(request[http::field::host]), text(request[http::field::origin]),
        is_head_ || request.method() == http::verb::get, text(request[http::field::sec_websocket_protocol])};
    if (websocket::is_upgrade(request)) {
      const auto welcome = parts_->handlers.welcome(asked);
      if (welcome.refusal) {
        Reply(*welcome.refusal);
      } else {
        std::make_shared<Viewer>(parts_, std::move(counted_), std::move(stream_))
            ->Open(request, welcome.subprotocol);
      }
      return;
    }
    stream_.expires_never();  // a report may take its time
    parts_->handlers.get(asked, [self = shared_from_this()](WebResponse response) {
      asio::post(self->parts_->io, [self, response = std::move(response)] { self->Reply(response); });
    });
  }

  void Reply(const WebResponse& response) {
    response_.result(response.status);
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::content_type, response.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Content-Security-Policy", response.policy);
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Referrer-Policy", "no-referrer");  // the address has the token
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("X-Frame-Options", "DENY");
    response_.content_length(response.content.size());
    if (!is_head_) {
      response_.body() = response.content;
    }
    serializer_.emplace(response_);
    stream_.expires_after(parts_->limits.behind);
    http::async_write(stream_, *serializer_,
                      [self = shared_from_this()](error_code /*error*/, std::size_t /*bytes*/) {
                        error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  std::shared_ptr<Web::Parts> parts_;
  std::shared_ptr<void> counted_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool is_head_ = false;
};

}  // namespace fovea::live
