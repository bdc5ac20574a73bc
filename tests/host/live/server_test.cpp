// SPDX-License-Identifier: Apache-2.0
// The server over a loopback socket: pages, viewers, the run's side, the end.
#include "firmware/host/live/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <regex>

#include "firmware/host/config/input_error.hpp"
#include "tests/host/live/live_server.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::LiveClient;
using testing::HasSubstr;

class ServerTest : public LiveServerTest {
 protected:
  LiveClient::Reply Get(const std::string& target, const std::string& more = "", const char* method = "GET") {
    return LiveClient(Port()).Get(target, more, method);
  }
};

TEST_F(ServerTest, ServesThePage) {
  Start();
  EXPECT_EQ(server_->url(), "http://127.0.0.1:" + std::to_string(Port()) + "/?token=test-token");
  const LiveClient::Reply page = Get(kTarget);
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("three.min.js"));
  EXPECT_THAT(page.head, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  EXPECT_THAT(page.head, HasSubstr("script-src 'self'; "));
  EXPECT_THAT(page.head, HasSubstr("connect-src 'self' ws://127.0.0.1:" + std::to_string(Port()) + ";"));
  EXPECT_THAT(page.head, HasSubstr("Referrer-Policy: no-referrer\r\n"));
  EXPECT_THAT(page.head, HasSubstr("Cache-Control: no-store\r\n"));
  const LiveClient::Reply script = Get("/page.js");  // no token: it has no data of the run
  EXPECT_EQ(script.status, 200);
  EXPECT_EQ(script.body, "let x;");
  EXPECT_THAT(script.head, HasSubstr("text/javascript"));
  EXPECT_GT(Get("/lib/three/three.min.js").body.size(), 100'000U);
  const LiveClient::Reply head = Get("/page.js", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_THAT(head.head, HasSubstr("Content-Length: 6\r\n"));
}

TEST_F(ServerTest, RefusesOtherRequests) {
  Start();
  EXPECT_EQ(Get("/").status, 401);
  EXPECT_EQ(Get("/index.html").status, 404);
  EXPECT_EQ(Get("/report").status, 404) << "this run has none";
  EXPECT_EQ(Get("/lib/three/three.js").status, 404) << "the page does not name it";
  for (const char* path :
       {"/../etc/passwd", "//etc/passwd", "/lib/../../../etc/passwd", "/%2e%2e/etc/passwd", "*"}) {
    EXPECT_EQ(Get(path).status, 404) << path;
  }
  EXPECT_EQ(Get("/page.js", "", "POST").status, 405);
  EXPECT_EQ(Get("/page.js", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(LiveClient(Port()).Get(kTarget, "", "GET", "evil.example").status, 403);
  const LiveClient::Reply refused = Get("/");
  EXPECT_EQ(refused.body,
            "The address lacks the token of this run: open the address that the program printed.\n");
  EXPECT_THAT(refused.head, HasSubstr("text/plain"));
}

TEST_F(ServerTest, RefusesViewersWithoutTokenHostOriginOrProtocol) {
  Start();
  const auto open = [&](const char* target, const char* protocol, const char* more = "",
                        const char* host = "") {
    return LiveClient(Port()).Open(target, protocol, more, host).status;
  };
  const char* const known = "foxglove.sdk.v1";
  EXPECT_EQ(open("/", known), 401);
  EXPECT_EQ(open("/?token=test-tokem", known), 401);
  EXPECT_EQ(open(kTarget, known, "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(open(kTarget, known, "Origin: null\r\n"), 403);
  EXPECT_EQ(open(kTarget, known, "", "evil.example"), 403);
  EXPECT_EQ(open(kTarget, "chat"), 400);
  EXPECT_EQ(open(kTarget, ""), 400);
  EXPECT_EQ(server_->viewers(), 0U);
}

TEST_F(ServerTest, AnswersWithTheSubprotocolThatWasAskedFor) {
  Start();
  for (const auto& [asked, expected] :
       {std::pair("foxglove.websocket.v1", "foxglove.websocket.v1"),
        std::pair("foxglove.sdk.v1", "foxglove.sdk.v1"),
        std::pair("x, foxglove.sdk.v1, foxglove.websocket.v1", "foxglove.sdk.v1")}) {
    LiveClient client(Port());
    const LiveClient::Reply reply = client.Open(kTarget, asked);
    EXPECT_EQ(reply.status, 101);
    EXPECT_THAT(reply.head, HasSubstr(std::string("Sec-WebSocket-Protocol: ") + expected + "\r\n"));
    EXPECT_EQ(client.Await("op", "serverInfo")["name"], "fovea: test");
  }
}

TEST_F(ServerTest, ViewersGetWhatTheRunPublishes) {
  Start();
  server_->Publish(1, 7, "at the start");
  const auto viewer = Viewer();
  Subscribe(*viewer, 1);
  const json once = viewer->Await("binary", 1);
  EXPECT_EQ(once["payload"], "at the start");
  EXPECT_EQ(once["stamp"], 7);
  EXPECT_FALSE(server_->Wants(0));
  Subscribe(*viewer, 0);
  server_->Publish(0, 8, std::string("\0\xff", 2));
  EXPECT_EQ(viewer->Await("binary", 1)["payload"], std::string("\0\xff", 2));
  server_->SetTime(1234);
  EXPECT_EQ(viewer->Await("stamp", 1234)["binary"], 2);
  State state;
  state.mode = "hold";
  server_->SetState(state);
  viewer->SendText({{"op", "subscribe"}, {"subscriptions", {{{"id", 5}, {"channelId", 4}}}}});
  EXPECT_THAT(std::string(viewer->Await("subscription", 5)["payload"]), HasSubstr("\"mode\":\"hold\""));
  viewer->SendText({{"op", "subscribe"}, {"subscriptions", {{{"id", 6}, {"channelId", 5}}}}});
  EXPECT_THAT(std::string(viewer->Await("subscription", 6)["payload"]), HasSubstr("servo.lambda"));
  server_->SetParameter(0, 3.5);
  EXPECT_THAT(std::string(viewer->Await("subscription", 6)["payload"]), HasSubstr("\"value\":3.5"));
}

TEST_F(ServerTest, CallsAreAnsweredByTheRun) {
  Start();
  const auto viewer = Viewer();
  EXPECT_EQ(server_->TakeCalls([](const Call&) { return Answer{}; }), 0U);
  viewer->SendBinary(test::BinaryServiceCall(1 + static_cast<std::uint32_t>(Service::kTrack), 5, "{}"));
  ASSERT_TRUE(server_->WaitForCalls(20s));
  EXPECT_EQ(server_->TakeCalls([](const Call& call) {
    EXPECT_EQ(call.client, "viewer 1");
    EXPECT_TRUE(std::holds_alternative<Track>(call.request));
    return Answer{"", R"({"done":true})"};
  }),
            1U);
  EXPECT_EQ(viewer->Await("binary", 3)["payload"], R"({"done":true})");
}

TEST_F(ServerTest, ReportIsMadeOneAtATime) {
  std::promise<void> began;
  std::promise<void> go;
  int made = 0;
  config_.report = [&]() -> std::string {
    if (++made > 1) {
      throw std::runtime_error("the disk is full");
    }
    began.set_value();
    go.get_future().wait();
    return "<html>";
  };
  Start();
  const std::string target = "/report?token=test-token";
  EXPECT_EQ(Get("/report").status, 401);
  auto first = std::async(std::launch::async, [&] { return Get(target); });
  began.get_future().wait();
  const LiveClient::Reply busy = Get(target);
  EXPECT_EQ(busy.status, 503);
  EXPECT_EQ(busy.body, "A report is being made: try again in a moment.\n");
  EXPECT_EQ(Get("/page.js").status, 200) << "all else is served meanwhile";
  go.set_value();
  const LiveClient::Reply report = first.get();
  EXPECT_EQ(report.status, 200);
  EXPECT_EQ(report.body, "<html>");
  EXPECT_THAT(report.head, HasSubstr("text/html"));
  LiveClient::Reply failed = Get(target);
  for (int i = 0; i < 100 && failed.body == busy.body; ++i) {  // the first thread is about to end
    failed = Get(target);
  }
  EXPECT_EQ(failed.status, 503);
  EXPECT_EQ(failed.body, "The report cannot be made: the disk is full\n");
}

TEST_F(ServerTest, TwentyFirstViewerIsRefused) {
  Start();
  std::vector<std::unique_ptr<LiveClient>> viewers;
  for (int i = 0; i < 20; ++i) {
    viewers.push_back(Viewer());
  }
  EXPECT_EQ(server_->viewers(), 20U);
  const LiveClient::Reply refused = LiveClient(Port()).Open(kTarget);
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(refused.body, "There are 20 viewers already: close one of them first.\n");
  EXPECT_EQ(LiveClient(Port()).Get(kTarget).status, 200) << "the page itself is still served";
  for (const auto& viewer : viewers) {
    Subscribe(*viewer, 0);
    viewer->SendText({{"op", "getParameters"}, {"parameterNames", nlohmann::json::array()}, {"id", "here"}});
    EXPECT_FALSE(viewer->Await("id", "here").is_null()) << "then the subscription has arrived, too";
  }
  server_->Publish(0, 1, "to all");
  for (const auto& viewer : viewers) {
    EXPECT_EQ(viewer->Await("binary", 1)["payload"], "to all");
  }
  viewers.pop_back();
  WaitForViewers(19);
  EXPECT_EQ(LiveClient(Port()).Open(kTarget).status, 101);
}

TEST_F(ServerTest, EndOfTheRunIsTold) {
  Start();
  const auto viewer = Viewer();
  const auto began = std::chrono::steady_clock::now();
  server_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 5s);
  EXPECT_EQ(viewer->Await("op", "status")["message"], "the run has ended");
  EXPECT_EQ(viewer->AwaitClose(), 1001);
}

TEST_F(ServerTest, TakenPortIsNamedWithItsOwnerAndAFreeOne) {
  Start();
  ServerConfig second = config_;
  second.port = Port();
  try {
    const Server server(second, SmallCatalogue());
    FAIL() << "two servers listen at one port";
  } catch (const config::InputError& error) {
    const std::string text = error.what();
    const std::regex pattern("port " + std::to_string(Port()) +
                             R"( of 127\.0\.0\.1 is in use by \S+ \(process )" + std::to_string(getpid()) +
                             R"(\); port (\d+) is free: --port \1)");
    std::smatch match;
    ASSERT_TRUE(std::regex_match(text, match, pattern)) << text;
    second.port = static_cast<std::uint16_t>(std::stoi(match[1]));
    EXPECT_NO_THROW(Server(second, SmallCatalogue())) << "the proposed port is free";
  }
}

TEST_F(ServerTest, WrongConfigurationIsRefused) {
  const auto why = [&](auto&& change) {
    ServerConfig config = config_;
    Catalogue catalogue = SmallCatalogue();
    change(config, catalogue);
    try {
      const Server server(config, catalogue);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why([](ServerConfig& c, Catalogue&) { c.address = "localhost"; }),
            "localhost is no address to listen at; try 127.0.0.1");
  EXPECT_THAT(why([](ServerConfig& c, Catalogue&) { c.address = "192.0.2.1"; }),
              HasSubstr("cannot listen at 192.0.2.1 port 0: "));
  EXPECT_THAT(why([](ServerConfig& c, Catalogue&) { c.token = "a b"; }), HasSubstr("8 to 128 letters"));
  EXPECT_THAT(why([](ServerConfig& c, Catalogue&) { c.page /= "none"; }), HasSubstr("index.html: missing"));
  EXPECT_EQ(why([](ServerConfig&, Catalogue& c) { c.parameters[0].value = NAN; }),
            "servo.lambda: its value nan is not in its range 0.1 to 10");
  EXPECT_EQ(why([](ServerConfig&, Catalogue&) {}), "");
}

}  // namespace
}  // namespace fovea::live
