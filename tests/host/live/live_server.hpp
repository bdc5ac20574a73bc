// SPDX-License-Identifier: Apache-2.0
// A server with a small catalogue and page at a free port, for tests.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "firmware/host/live/server.hpp"
#include "tests/host/live/live_client.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::live {

inline Catalogue SmallCatalogue() {
  Catalogue catalogue;
  catalogue.name = "test";
  catalogue.channels = {{"/plot", "A", "schema", Weight::kPlot},
                        {"/once", "B", "schema", Weight::kEssential, true},
                        {"/picture", "C", "schema", Weight::kPicture}};
  catalogue.parameters = {{"servo.lambda", "1/s", "decay", 0.1, 10.0, 2.0, 2.0}};
  catalogue.tune = true;
  catalogue.services = {Service::kHold, Service::kTrack};
  return catalogue;
}

class LiveServerTest : public testing::Test {
 protected:
  LiveServerTest() {
    std::ofstream(folder_.path() / "index.html") << "<script src=\"lib/three/three.min.js\"></script>";
    std::ofstream(folder_.path() / "page.js") << "let x;";
    config_.page = folder_.path();
    config_.port = 0;
    config_.token = kToken;
  }
  void Start() { server_ = std::make_unique<Server>(config_, SmallCatalogue()); }
  [[nodiscard]] std::uint16_t Port() const { return server_->port(); }
  // An open viewer that has read the messages of the beginning.
  std::unique_ptr<test::LiveClient> Viewer() {
    auto client = std::make_unique<test::LiveClient>(Port());
    EXPECT_EQ(client->Open(kTarget).status, 101);
    EXPECT_NE(client->Await("op", "advertiseServices"), nullptr);
    return client;
  }
  void WaitForViewers(std::size_t count) {
    for (int i = 0; i < 2000 && server_->viewers() != count; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(server_->viewers(), count);
  }
  // A viewer subscribes to a channel, by its index.
  void Subscribe(test::LiveClient& client, std::size_t channel) {
    client.SendText(
        {{"op", "subscribe"}, {"subscriptions", {{{"id", channel + 100}, {"channelId", channel + 1}}}}});
    for (int i = 0; i < 2000 && !server_->Wants(channel); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(server_->Wants(channel));
  }

  static constexpr const char* kToken = "test-token";
  static constexpr const char* kTarget = "/?token=test-token";

  const test::TempFolder folder_;
  ServerConfig config_;
  std::unique_ptr<Server> server_;
};

}  // namespace fovea::live
