// SPDX-License-Identifier: Apache-2.0
// Who may connect: token, Host and Origin; and who holds a port or the control.
#include "firmware/host/live/access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/host/live/control.hpp"

namespace fovea::live {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Access Loopback() { return {"127.0.0.1", 8765, "0123456789abcdef", {}, {}}; }

unsigned StatusOf(const Access& access, std::string_view host, std::string_view origin = "") {
  const auto denial = CheckHost(access, host, origin);
  return denial ? denial->status : 200;
}

TEST(Access, HostMustBeTheServersOwn) {
  const Access access = Loopback();
  EXPECT_EQ(StatusOf(access, "127.0.0.1:8765"), 200U);
  EXPECT_EQ(StatusOf(access, "localhost:8765"), 200U);
  EXPECT_EQ(StatusOf(access, "LocalHost:8765"), 200U);
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:80", "localhost:87650", "evil.example:8765", "127.0.0.1.evil:8765",
        "127.0.0.2:8765", "[::1]:8765", "localhost:8765:8765", ":8765"}) {
    EXPECT_EQ(StatusOf(access, host), 403U) << host;
  }
  EXPECT_THAT(CheckHost(access, "evil.example", "")->text, HasSubstr("127.0.0.1:8765"));
}

TEST(Access, OriginMustBeOwnOrAllowed) {
  Access access = Loopback();
  const char* host = "127.0.0.1:8765";
  EXPECT_EQ(StatusOf(access, host, "http://127.0.0.1:8765"), 200U);
  EXPECT_EQ(StatusOf(access, host, "http://localhost:8765"), 200U);
  for (const char* origin : {"http://evil.example", "https://127.0.0.1:8765", "http://127.0.0.1:9000", "null",
                             "http://127.0.0.1:8765.evil.example", "app://foxglove"}) {
    EXPECT_EQ(StatusOf(access, host, origin), 403U) << origin;
  }
  access.allowed_origins = {"https://App.foxglove.dev"};
  EXPECT_EQ(StatusOf(access, host, "https://app.foxglove.dev"), 200U);
  EXPECT_EQ(StatusOf(access, host, "https://app.foxglove.dev.evil"), 403U);
}

TEST(Access, OtherAddressesHaveTheirOwnNames) {
  Access access = Loopback();
  access.address = "::1";
  EXPECT_EQ(StatusOf(access, "[::1]:8765"), 200U);
  EXPECT_EQ(StatusOf(access, "127.0.0.1:8765"), 403U);
  // Every literal address of this computer, but no name: a name can be rebound.
  access.address = "0.0.0.0";
  access.host_names = {"robot.lab"};
  EXPECT_EQ(StatusOf(access, "192.168.1.7:8765"), 200U);
  EXPECT_EQ(StatusOf(access, "robot.lab:8765"), 200U);
  EXPECT_EQ(StatusOf(access, "evil.example:8765"), 403U);
  access.port = 80;
  EXPECT_EQ(StatusOf(access, "192.168.1.7"), 200U);
}

TEST(Access, TokenMustBeTheSame) {
  const Access access = Loopback();
  EXPECT_FALSE(CheckToken(access, "/?token=0123456789abcdef").has_value());
  EXPECT_FALSE(CheckToken(access, "/report?a=b&token=0123456789abcdef&c").has_value());
  for (const char* target :
       {"/", "/?", "/?token=", "/?token=0123456789abcdeF", "/?token=0123456789abcdef0",
        "/?token=0123456789abcde", "/?xtoken=0123456789abcdef", "/token=0123456789abcdef", "/?&&&"}) {
    EXPECT_EQ(CheckToken(access, target)->status, 401U) << target;
  }
}

TEST(Access, TokensAreRandomAndUsable) {
  EXPECT_NE(RandomToken(), RandomToken());
  EXPECT_EQ(RandomToken().size(), 32U);
  EXPECT_TRUE(IsUsableToken(RandomToken()));
  EXPECT_FALSE(IsUsableToken("short"));
  EXPECT_FALSE(IsUsableToken("has a space"));
  EXPECT_FALSE(IsUsableToken("has&another=1"));
}

TEST(Access, PathEndsAtTheQuery) {
  EXPECT_EQ(PathOf("/a/b?token=c"), "/a/b");
  EXPECT_EQ(PathOf("/"), "/");
}

TEST(Control, OneViewerAtATime) {
  Control control(10s);
  const Clock::time_point now = Clock::now();
  EXPECT_TRUE(control.IsFree());
  EXPECT_TRUE(control.Take(1, "Ada", now));
  EXPECT_FALSE(control.Take(2, "Bob", now));
  EXPECT_EQ(control.name(), "Ada");
  EXPECT_TRUE(control.Take(1, "Ada L", now));
  EXPECT_EQ(control.name(), "Ada L");
  EXPECT_FALSE(control.End(2));
  EXPECT_TRUE(control.End(1));
  EXPECT_EQ(control.name(), "");
  EXPECT_TRUE(control.Take(2, "Bob", now));
}

TEST(Control, SilenceEndsIt) {
  Control control(10s);
  const Clock::time_point now = Clock::now();
  EXPECT_FALSE(control.IsSilent(now + 1h));
  EXPECT_TRUE(control.Take(1, "Ada", now));
  control.Hear(2, now + 9s);
  EXPECT_FALSE(control.IsSilent(now + 10s));
  EXPECT_TRUE(control.IsSilent(now + 10001ms));
  control.Hear(1, now + 9s);
  EXPECT_FALSE(control.IsSilent(now + 19s));
}

}  // namespace
}  // namespace fovea::live
