// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/server.hpp"

#include <algorithm>
#include <ctime>
#include <string>
#include <utility>

namespace fovea::sim {
namespace {

// A world behind the clock catches up as fast as it can: a robot's time does not wait for its client. A
// larger delay than this is skipped.
constexpr std::int64_t kMostBehindNs = hal::kNsPerSecond;
constexpr std::int64_t kFirstPatienceNs = 100 * hal::kNsPerMs;
constexpr std::int64_t kStopLookNs = 10 * hal::kNsPerMs;  // longest wait between two checks of `stop`

std::int64_t NowNs() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * hal::kNsPerSecond + now.tv_nsec;
}

}  // namespace

FciServer::FciServer(FciRobot& robot, const FciServerConfig& config)
    : robot_(robot),
      config_(config),
      listener_(config.at),
      udp_(franka::Endpoint{config.at.ip, 0}),
      intake_(config.late_ms),
      commands_(config.faults, 2 * config.seed),
      states_(config.faults, 2 * config.seed + 1),
      state_dice_(config.faults, 2 * config.seed + 1),
      loss_(config.faults.loss) {}

void FciServer::Run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& say) {
  say_ = say;
  next_tick_ns_ = NowNs();
  while (!stop.load(std::memory_order_relaxed)) {
    TakeHandInput();
    const double loss = loss_.load(std::memory_order_relaxed);
    commands_.SetLoss(loss);
    states_.SetLoss(loss);
    state_dice_.SetLoss(loss);
    const std::int64_t sent_ns = NowNs();
    SendState();
    const bool hangs = hangs_.load(std::memory_order_relaxed);
    if (WaitsForAnswer() && !hangs) {
      AwaitCommands();
      if (config_.most_speed > 0.0) {
        ServeUntil(sent_ns + static_cast<std::int64_t>(hal::kTickPeriodNs / config_.most_speed));
      }
      next_tick_ns_ = NowNs();
    } else {
      AwaitTick();
    }
    if (!hangs) {
      Tick();
    }
  }
}

// Waits for the next millisecond of the clock.
void FciServer::AwaitTick() {
  next_tick_ns_ += static_cast<std::int64_t>(hal::kTickPeriodNs / ClockSpeed());
  const std::int64_t now_ns = NowNs();
  counters_.overruns += now_ns > next_tick_ns_ ? 1U : 0U;
  if (const std::int64_t lost_ns = now_ns - next_tick_ns_; lost_ns > kMostBehindNs) {
    say_("this computer is too slow for real pace: " + std::to_string(lost_ns / hal::kNsPerMs) +
         " ms are skipped");
    counters_.given_up_ns += lost_ns;
    next_tick_ns_ += lost_ns;
  }
  ServeUntil(next_tick_ns_);
}

// Passes a person's inputs to the robot.
void FciServer::TakeHandInput() {
  if (const bool pressed = stop_button_.load(std::memory_order_relaxed); pressed != stop_pressed_) {
    stop_pressed_ = pressed;
    robot_.UserStop(pressed);
    say_(pressed ? "user stop" : "user stop released");
  }
  if (const bool pressed = guiding_button_.load(std::memory_order_relaxed); pressed != guiding_pressed_) {
    guiding_pressed_ = pressed;
    robot_.PressGuiding(pressed);
    say_(pressed ? "guiding button pressed" : "guiding button released");
  }
  const std::lock_guard lock(hand_mutex_);
  robot_.PullHand(hand_force_B_);
}

// Steps the robot with the commands that have arrived.
void FciServer::Tick() {
  while (const auto command = commands_.Take(LinkNowNs())) {
    intake_.Put(*command);
  }
  const bool was_moving = robot_.moving();
  const auto command = was_moving ? intake_.Take(robot_.state().message_id) : std::nullopt;
  if (was_moving) {
    counters_.missing += command || !robot_.commanded() ? 0U : 1U;
    counters_.commands += command ? 1U : 0U;
  }
  counters_.unused = intake_.refused();
  robot_.Step(command);
  if (config_.after_step) {
    config_.after_step();
  }
}

// True in lockstep, in a motion, if the state was sent to the client.
bool FciServer::WaitsForAnswer() const {
  return config_.lockstep && session_ && robot_.moving() && !state_lost_;
}

void FciServer::AwaitCommands() {
  // A client may skip the first states of a motion.
  const std::int64_t patience_ns = !robot_.commanded() ? kFirstPatienceNs
                                   : impatient_        ? hal::kTickPeriodNs
                                                       : config_.patience_ns;
  const std::int64_t end_ns = NowNs() + patience_ns;
  while (newest_answered_ < robot_.state().message_id && session_ && robot_.moving()) {
    const std::int64_t now_ns = NowNs();
    if (now_ns >= end_ns) {
      impatient_ = robot_.commanded();
      return;
    }
    Poll(std::min(end_ns, now_ns + kStopLookNs));
  }
}

void FciServer::ServeUntil(std::int64_t time_ns) {
  do {
    Poll(time_ns);
    FlushStates();
  } while (NowNs() < time_ns);
}

// Waits until something arrives or `until_ns`, then handles what has arrived.
void FciServer::Poll(std::int64_t until_ns) {
  constexpr std::int64_t kFlushNs = 200'000;  // a delayed state leaves at most this late
  const bool delays =
      config_.faults.delay_ms > 0.0 || config_.faults.jitter_ms > 0.0 || config_.faults.reorder > 0.0;
  const std::int64_t left_ns = until_ns - NowNs();
  const std::array fds{listener_.fd(), udp_.fd(), session_ ? session_->fd() : -1};
  franka::WaitReadable(fds, delays ? std::min(left_ns, kFlushNs) : left_ns);
  if (session_ && !session_->Serve()) {
    EndSession();
  }
  AcceptClient();  // last, because the present client may have disconnected
  if (session_ && session_->TakeMotionStart()) {
    intake_.Begin(robot_.state().message_id);
    commands_.Clear();
    impatient_ = false;
  }
  TakeDatagrams();
}

void FciServer::AcceptClient() {
  auto client = listener_.Accept();
  if (!client) {
    return;
  }
  if (session_) {
    ++counters_.refused_clients;  // only one client at a time; the connection closes here
    say_("a second client was refused");
    return;
  }
  ++counters_.clients;
  newest_answered_ = 0;
  states_.Clear();
  commands_.Clear();
  session_.emplace(robot_, std::move(*client), config_.model_library);
  say_("a client connected");
}

void FciServer::EndSession() {
  say_(std::string("the client is gone: ") + session_->end_reason());
  session_.reset();
  robot_.Abandon();
}

void FciServer::TakeDatagrams() {
  std::array<std::byte, franka::kCommandSize + 1> bytes;
  std::size_t size = 0;
  franka::Endpoint from;
  while (udp_.Receive(bytes, size, from)) {
    franka::RobotCommand command;
    const bool from_client = session_ && session_->state_endpoint() && *session_->state_endpoint() == from;
    if (!from_client || size != franka::kCommandSize || !franka::Decode(bytes, command)) {
      ++counters_.malformed;
      continue;
    }
    newest_answered_ = std::max(newest_answered_, command.message_id);
    impatient_ = false;
    commands_.Put(command, LinkNowNs());
  }
}

// Time base of the link's delays: in lockstep the robot's time, else the clock scaled by ClockSpeed.
std::int64_t FciServer::LinkNowNs() const {
  return config_.lockstep ? static_cast<std::int64_t>(robot_.state().message_id) * hal::kNsPerMs
                          : static_cast<std::int64_t>(static_cast<double>(NowNs()) * ClockSpeed());
}

// Speed of the robot's time relative to the clock; 1 in lockstep (at rest).
double FciServer::ClockSpeed() const {
  return config_.lockstep || config_.most_speed == 0.0 ? 1.0 : config_.most_speed;
}

void FciServer::SendState() {
  state_lost_ = false;
  if (!session_ || !session_->state_endpoint()) {
    return;
  }
  ++counters_.states;
  if (config_.lockstep) {
    // A delayed state would only delay its answer, so delays apply to commands only.
    state_lost_ = state_dice_.Loses();
    for (int copies = state_lost_ ? 0 : (state_dice_.Repeats() ? 2 : 1); copies > 0; --copies) {
      static_cast<void>(udp_.Send(franka::Bytes(robot_.state()), *session_->state_endpoint()));
    }
  } else {
    states_.Put(robot_.state(), LinkNowNs());
    FlushStates();
  }
  session_->AnswerMoveEnd();
}

void FciServer::FlushStates() {
  while (const auto state = states_.Take(LinkNowNs())) {
    if (session_ && session_->state_endpoint()) {
      static_cast<void>(udp_.Send(franka::Bytes(*state), *session_->state_endpoint()));
    }
  }
}

}  // namespace fovea::sim
