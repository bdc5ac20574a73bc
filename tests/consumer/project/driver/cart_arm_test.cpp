// SPDX-License-Identifier: Apache-2.0
// Tests the driver with the contract of hal::Arm, with a failing device, and with the servo.
#include "cart_arm.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "fovea/contract/arm_contract.hpp"
#include "fovea/linux_rt/record_ring.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "fovea/robot.hpp"
#include "fovea/servo_loop.hpp"

namespace {

using namespace fovea;

constexpr std::int64_t kPatientNs = 60 * hal::kNsPerSecond;  // long, since a busy computer is late

// The simulated device. It moves only in Advance.
class Cart {
 public:
  explicit Cart(int socket) : socket_(socket) { Send(std::as_bytes(std::span(&state_, 1))); }
  ~Cart() { Close(); }

  // Simulates one millisecond.
  void Advance() {
    constexpr double kMass = 1.0;
    constexpr double kPeriodS = 1e-3;
    CartCommand command{};
    while (recv(socket_, &command, sizeof(command), MSG_DONTWAIT) == static_cast<ssize_t>(sizeof(command))) {
      command_ = command;
    }
    state_.velocity = command_.brake != 0 ? 0.0 : state_.velocity + kPeriodS * command_.force / kMass;
    state_.position += kPeriodS * state_.velocity;
    state_.force_measured = state_.force_in_force = command_.force;
    state_.time_ns += hal::kTickPeriodNs;
    ++state_.count;
    Send(std::as_bytes(std::span(&state_, 1)));
  }
  void Send(std::span<const std::byte> bytes) {
    ASSERT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  void PressButton() { state_.emergency = 1; }
  void Close() {
    if (socket_ >= 0) {
      close(socket_);
      socket_ = -1;
    }
  }
  [[nodiscard]] const CartState& state() const { return state_; }

 private:
  int socket_;
  CartState state_{};
  CartCommand command_{};
};

// A driver and its device, connected.
struct Bench {
  struct Pair {
    int fd[2] = {-1, -1};
    Pair() {
      const int room = 1 << 20;  // holds what the device sends while nobody reads
      if (socketpair(AF_UNIX, SOCK_STREAM, 0, fd) != 0 ||
          setsockopt(fd[1], SOL_SOCKET, SO_SNDBUF, &room, sizeof(room)) != 0) {
        throw std::runtime_error("cannot create a socket pair");
      }
    }
  };
  explicit Bench(std::int64_t timeout_ns = kPatientNs) : driver(pair.fd[0], timeout_ns), cart(pair.fd[1]) {}

  Pair pair;
  CartArm driver;
  Cart cart;
};

struct CartFixture {
  Bench bench;
  hal::Arm& arm() { return bench.driver; }
  void Advance() { bench.cart.Advance(); }
};

}  // namespace

namespace fovea::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Cart, ArmContract, CartFixture);
}  // namespace fovea::test

namespace {

TEST(CartArmTest, ReadReturnsTheNewestOfManyStates) {
  Bench bench;
  for (int i = 0; i < 200; ++i) {  // more than the driver's buffer holds
    bench.cart.Advance();
  }
  hal::ArmState state;
  ASSERT_TRUE(bench.driver.Read(state).ok());
  EXPECT_EQ(state.sequence, 200U);
}

TEST(CartArmTest, StateReceivedInTwoPartsIsAssembled) {
  Bench bench;
  CartState next = bench.cart.state();
  next.count = 9;
  const auto bytes = std::as_bytes(std::span(&next, 1));
  hal::ArmState state;
  bench.cart.Send(bytes.first(11));
  ASSERT_TRUE(bench.driver.Read(state).ok());
  EXPECT_EQ(state.sequence, 0U);
  bench.cart.Send(bytes.subspan(11));
  ASSERT_TRUE(bench.driver.Read(state).ok());
  EXPECT_EQ(state.sequence, 9U);
}

TEST(CartArmTest, SilenceTimesOutStopButtonFaultsLostLineDisconnects) {
  Bench silent(/*timeout_ns=*/0);
  hal::ArmState state;
  static_cast<void>(silent.driver.Read(state));  // takes the first state
  EXPECT_EQ(silent.driver.Read(state).code(), hal::StatusCode::kTimeout);
  Bench bench;
  bench.cart.PressButton();
  bench.cart.Advance();
  EXPECT_EQ(bench.driver.Read(state).code(), hal::StatusCode::kDeviceFault);
  bench.cart.Close();
  EXPECT_EQ(bench.driver.Read(state).code(), hal::StatusCode::kDisconnected);
  hal::ArmCommand command;
  command.num_joints = 1;
  EXPECT_EQ(bench.driver.Write(command).code(), hal::StatusCode::kDisconnected);
}

// Time advances only while the loop waits, and the cart moves with it.
class CartClock final : public hal::Clock {
 public:
  explicit CartClock(Cart& cart) : cart_(cart) {}

 private:
  std::int64_t DoNowNs() const noexcept override { return cart_.state().time_ns; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    while (cart_.state().time_ns < deadline_ns) {
      cart_.Advance();
    }
    return hal::Status::Ok();
  }
  Cart& cart_;
};

TEST(CartArmTest, ServoHoldsTheCartWithoutHeapCalls) {
  const robots::Robot robot = robots::LoadRobot(ARM_FILE);
  config::ServoConfig config;
  config.arm = robot.model;
  config.law.q_posture = robot.model.q_ready;
  task::ServoTask task;
  ASSERT_TRUE(task.Init(config).ok());
  Bench bench;
  CartClock clock(bench.cart);
  hal::FeatureMailbox mailbox;
  linux_rt::RecordRing records(1024);
  linux_rt::TickMeter meter;
  task::ServoLoop loop(task, bench.driver, clock, mailbox, records, meter);
  ASSERT_TRUE(loop.Run(hal::kNsPerSecond / 2).ok());
  hal::TickRecord last;
  records.Drain([&](const hal::TickRecord& record) { last = record; });
  EXPECT_EQ(last.mode, hal::Mode::kHold) << hal::Name(last.fault);
  EXPECT_NEAR(bench.cart.state().position, 0.0, 1e-4);
  EXPECT_EQ(meter.heap_calls(), 0U);
}

}  // namespace
