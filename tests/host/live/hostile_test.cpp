// SPDX-License-Identifier: Apache-2.0
// Clients that break the rules: none of them harms another viewer, and each costs a bounded amount.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "firmware/host/live/server.hpp"
#include "tests/host/live/live_server.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using test::LiveClient;
using testing::HasSubstr;

// Memory of this process [bytes].
std::size_t ResidentBytes() {
  std::size_t total = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

class HostileTest : public LiveServerTest {
 protected:
  // The server still serves a page and a viewer.
  void ExpectAlive() {
    EXPECT_EQ(LiveClient(Port()).Get(kTarget).status, 200);
    LiveClient viewer(Port());
    EXPECT_EQ(viewer.Open(kTarget).status, 101);
    EXPECT_EQ(viewer.Await("op", "serverInfo")["name"], "fovea: test");
  }
};

TEST_F(HostileTest, GarbageInsteadOfARequestEndsTheConnection) {
  Start();
  std::mt19937 random(1);
  for (int i = 0; i < 50; ++i) {
    std::string garbage(1 + random() % 3000, '\0');
    for (char& byte : garbage) {
      byte = static_cast<char>(random());
    }
    LiveClient client(Port());
    client.Send("GET /" + garbage + " \r\n\r\n");
    EXPECT_TRUE(client.AwaitEnd());
  }
  ExpectAlive();
}

TEST_F(HostileTest, LongHeadersAndBodiesAreRefused) {
  Start();
  LiveClient headers(Port());
  headers.Send("GET / HTTP/1.1\r\nHost: x\r\nA: " + std::string(100'000, 'a'), 1s);
  EXPECT_TRUE(headers.AwaitEnd());
  LiveClient body(Port());
  body.Send("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 100000000\r\n\r\n");
  EXPECT_TRUE(body.AwaitEnd());
  ExpectAlive();
}

TEST_F(HostileTest, GarbageMessagesAreRefusedInWords) {
  Start();
  const auto viewer = Viewer();
  viewer->Send(LiveClient::Head(1, 5) + "hello");
  EXPECT_EQ(viewer->Await("op", "status")["message"], "the message is no valid JSON");
  viewer->SendBinary("\x02\x01");
  EXPECT_EQ(viewer->Await("op", "status")["message"], "the binary message is too short");
  viewer->SendText({{"op", "fetchAsset"}, {"uri", "file:///etc/passwd"}, {"requestId", 1}});
  EXPECT_EQ(viewer->Await("op", "status")["message"], "the operation fetchAsset is not offered here");
}

TEST_F(HostileTest, GarbageFramesEndTheConnection) {
  Start();
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    LiveClient client(Port());
    ASSERT_EQ(client.Open(kTarget).status, 101);
    std::string garbage(200, '\0');
    for (char& byte : garbage) {
      byte = static_cast<char>(random());
    }
    garbage[0] = static_cast<char>(0xF3);  // reserved bits, an unknown frame
    client.Send(garbage);
    EXPECT_TRUE(client.AwaitEnd());
  }
  // A frame without a mask, and text that is no UTF-8.
  for (const std::string& bytes : {std::string("\x81\x02{}"), LiveClient::Head(1, 2) + "\xff\xff"}) {
    LiveClient client(Port());
    ASSERT_EQ(client.Open(kTarget).status, 101);
    client.Send(bytes);
    EXPECT_TRUE(client.AwaitEnd());
  }
  WaitForViewers(0);
  ExpectAlive();
}

TEST_F(HostileTest, HugeMessageClosesTheConnectionAtItsHead) {
  Start();
  const std::size_t before = ResidentBytes();
  LiveClient client(Port());
  ASSERT_EQ(client.Open(kTarget).status, 101);
  client.Send(LiveClient::Head(2, 100'000'000));
  const std::string part(1'000'000, 'x');
  for (int i = 0; i < 100 && client.Send(part, 500ms); ++i) {
  }
  EXPECT_TRUE(client.AwaitEnd());
  // The same in pieces that are small enough each.
  LiveClient pieces(Port());
  ASSERT_EQ(pieces.Open(kTarget).status, 101);
  std::string piece = LiveClient::Head(0, 60'000) + std::string(60'000, 'x');
  piece[0] = 0x01;  // the first of many
  for (int i = 0; i < 100 && pieces.Send(piece, 500ms); ++i) {
    piece[0] = 0x00;
  }
  EXPECT_TRUE(pieces.AwaitEnd());
  const std::size_t after = ResidentBytes();
  std::printf("memory: %zu kB before, %zu kB after\n", before / 1024, after / 1024);
  EXPECT_LT(after, before + 20'000'000);
  WaitForViewers(0);  // a connection ends a little before it is counted
  EXPECT_GE(server_->dropped().viewers, 2U);
  ExpectAlive();
}

TEST_F(HostileTest, LargestMessageIsTaken) {
  Start();
  const auto viewer = Viewer();
  std::string message(65'000, 'a');
  message.insert(0, R"({"op":")");
  message += R"("})";
  viewer->Send(LiveClient::Head(1, message.size()) + message);
  EXPECT_EQ(viewer->Await("op", "status")["message"], "the field op must be a short text");
}

TEST_F(HostileTest, FloodOfMessagesIsClosedWithAReason) {
  Start();
  const auto viewer = Viewer();
  const std::string one = LiveClient::Head(1, 2) + "{}";
  std::string many;
  for (int i = 0; i < 2000; ++i) {
    many += one;
  }
  viewer->Send(many);
  EXPECT_EQ(viewer->AwaitClose(), 1008);
  WaitForViewers(0);
  ExpectAlive();
}

// A viewer that reads nothing, while pictures come in at 30 Hz and more.
TEST_F(HostileTest, ViewerThatNeverReadsCostsABoundedAmountAndIsClosed) {
  config_.limits.behind = 1000ms;
  Start();
  const auto sleeper = Viewer();
  const auto reader = Viewer();
  Subscribe(*sleeper, 0);
  Subscribe(*sleeper, 2);
  Subscribe(*reader, 1);
  const std::size_t before = ResidentBytes();
  std::size_t most = 0;
  const std::string picture(200'000, 'p');
  const std::string plot(400, 't');
  const auto began = std::chrono::steady_clock::now();
  std::size_t published = 0;
  while (server_->viewers() == 2 && std::chrono::steady_clock::now() - began < 60s) {
    server_->Publish(2, 0, picture);
    server_->Publish(0, 0, plot);
    published += picture.size() + plot.size();
    most = std::max(most, ResidentBytes());
    std::this_thread::sleep_for(1ms);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  std::printf("closed after %.1f s and %zu kB; memory grew by %zu kB at most\n", seconds, published / 1024,
              (most - std::min(most, before)) / 1024);
  WaitForViewers(1);
  EXPECT_GT(published, 5'000'000U) << "the test published too little to fill anything";
  EXPECT_LT(most, before + 24'000'000) << "inbox, outbox and the system's buffers";
  EXPECT_GE(server_->dropped().pictures, 1U);
  EXPECT_EQ(server_->dropped().viewers, 1U);
  server_->Publish(1, 9, "still here");
  EXPECT_EQ(reader->Await("binary", 1)["payload"], "still here");
}

// It reads again before the time is over: it is told, and goes on.
TEST_F(HostileTest, SlowViewerIsToldWhatItLost) {
  Start();
  const auto viewer = Viewer();
  Subscribe(*viewer, 2);
  const std::string picture(200'000, 'p');
  for (int i = 0; i < 2000 && server_->dropped().pictures == 0; ++i) {
    server_->Publish(2, i, picture);
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_GT(server_->dropped().pictures, 0U);
  const json told = viewer->Await("id", "dropped");
  ASSERT_NE(told, nullptr);
  EXPECT_THAT(std::string(told["message"]), HasSubstr("this viewer reads too slowly: "));
  server_->Publish(2, 5, "the next");
  json next = viewer->Await("binary", 1);
  while (next != nullptr && next["payload"] != "the next") {
    next = viewer->Await("binary", 1);
  }
  EXPECT_NE(next, nullptr);
}

TEST_F(HostileTest, HalfOpenConnectionsEnd) {
  config_.limits.handshake = 500ms;
  config_.limits.silence = 1000ms;
  config_.limits.connections = 30;
  Start();
  std::vector<std::unique_ptr<LiveClient>> silent;
  for (int i = 0; i < 30; ++i) {
    silent.push_back(std::make_unique<LiveClient>(Port()));
    if (i % 2 == 0) {
      silent.back()->Send("GET / HTT");
    }
  }
  LiveClient surplus(Port());
  EXPECT_EQ(surplus.Get(kTarget).status, 200) << "the oldest of them made room";
  EXPECT_TRUE(silent.front()->AwaitEnd());
  for (const auto& client : silent) {
    EXPECT_TRUE(client->AwaitEnd());
  }
  ExpectAlive();
  // A viewer that answers no ping, as one whose computer has gone.
  const auto viewer = Viewer();
  WaitForViewers(1);
  WaitForViewers(0);
  EXPECT_TRUE(viewer->AwaitEnd());
}

TEST_F(HostileTest, ViewersThatVanishAreForgotten) {
  Start();
  for (int round = 0; round < 3; ++round) {
    std::vector<std::unique_ptr<LiveClient>> viewers;
    for (int i = 0; i < 15; ++i) {
      viewers.push_back(Viewer());
      Subscribe(*viewers.back(), 2);
      viewers.back()->SendBinary(
          test::BinaryServiceCall(1 + static_cast<std::uint32_t>(Service::kTrack), 5, "{}"));
    }
    server_->Publish(2, 0, std::string(100'000, 'x'));
    viewers.clear();
    WaitForViewers(0);
    EXPECT_FALSE(server_->Wants(2));
    server_->TakeCalls([](const Call&) { return Answer{}; });  // their answers go nowhere
  }
  ExpectAlive();
}

}  // namespace
}  // namespace fovea::live
