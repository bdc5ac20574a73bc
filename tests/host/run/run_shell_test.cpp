// SPDX-License-Identifier: Apache-2.0
// The common shell of all servo runs, around an arm at its ready posture.
#include "firmware/host/run/run_shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/recording/trace/trace.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::run {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

class StandingArm final : public hal::Arm {
 public:
  StandingArm() : Arm(7, false) {
    state_.num_joints = 7;
    state_.q = test::Panda().model.q_ready;
  }

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state_.stamp_ns += hal::kTickPeriodNs;
    ++state_.sequence;
    state = state_;
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    state_.tau_applied = command.tau_cmd;
    return hal::Status::Ok();
  }
  hal::ArmState state_;
};

// Its time is the last awaited deadline, except for one wait that ends late.
class SteppingClock final : public hal::Clock {
 public:
  std::int64_t late_at_ns = -1;
  std::int64_t late_by_ns = 0;

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return now_ns_; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    now_ns_ = deadline_ns + (deadline_ns == late_at_ns ? late_by_ns : 0);
    return hal::Status::Ok();
  }
  std::int64_t now_ns_ = 0;
};

std::int64_t Ms(int ms) { return ms * hal::kNsPerMs; }

// A shell with an arm and a clock.
class Bench {
 public:
  explicit Bench(RunFolderConfig folder = {}, std::size_t records = 4096, bool is_here = true) {
    EXPECT_TRUE(task_.Init(test::PandaConfig()).ok());
    shell.emplace(task_, is_here ? &task_ : nullptr, records, std::move(folder));
  }
  void RunTo(int ms) {
    task::ServoLoop* loop = shell->loop();
    if (loop == nullptr) {
      loop = &shell->BeginLoop(arm, clock);
    }
    EXPECT_TRUE(loop->Run(Ms(ms)).ok());
  }
  RunFigures Figures() {
    RunFigures figures;
    shell->Fill(figures);
    return figures;
  }

  StandingArm arm;
  SteppingClock clock;
  std::optional<RunShell> shell;

 private:
  task::ServoTask task_;
};

RunFacts Facts() {
  RunFacts facts;
  facts.name = "test";
  facts.servo = test::PandaConfig();
  facts.joint_names = test::Panda().joint_names;
  facts.has_camera = false;
  return facts;
}

RunFolderConfig FolderIn(const fs::path& out, bool has_log) {
  RunFolderConfig folder;
  folder.out = out;
  if (has_log) {
    folder.facts = Facts();
  }
  return folder;
}

std::set<std::string> FilesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    names.insert(file.path().filename());
  }
  return names;
}

std::string TextOf(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(RunShellTest, ObserversAreCalledInTheOrderOfTheirAddition) {
  Bench bench;
  std::vector<std::string> calls;
  for (const char* name : {"a", "b"}) {
    bench.shell->OnRecord([&calls, name](const flight::FlightRecord& flown) {
      calls.push_back(name + std::to_string(flown.record.tick));
    });
  }
  bench.RunTo(2);
  bench.shell->TakeRecords();
  bench.RunTo(3);
  bench.shell->TakeRecords();
  bench.shell->TakeRecords();
  EXPECT_THAT(calls, ElementsAre("a0", "b0", "a1", "b1", "a2", "b2"));
  EXPECT_EQ(bench.Figures().ticks, 3U);
}

TEST(RunShellTest, HasModeAndTimeOfTheLastTakenRecord) {
  Bench bench;
  bench.RunTo(100);
  EXPECT_EQ(bench.shell->mode(), hal::Mode::kBoot);
  EXPECT_EQ(bench.shell->now_s(), 0.0);
  hal::TickRecord last;
  bench.shell->OnRecord([&](const flight::FlightRecord& flown) { last = flown.record; });
  bench.shell->TakeRecords();
  EXPECT_EQ(last.mode, hal::Mode::kHold) << "the arm has been at rest long enough";
  EXPECT_EQ(bench.shell->mode(), last.mode);
  EXPECT_DOUBLE_EQ(bench.shell->now_s(), 1e-9 * static_cast<double>(last.stamp_ns));
}

TEST(RunShellTest, CountsDroppedRecords) {
  Bench bench({}, 16);
  int taken = 0;
  bench.shell->OnRecord([&](const flight::FlightRecord&) { ++taken; });
  bench.RunTo(100);
  bench.shell->TakeRecords();
  EXPECT_EQ(taken, 16);
  const RunFigures figures = bench.Figures();
  EXPECT_EQ(figures.ticks, 100U);
  EXPECT_EQ(figures.records_dropped, 84U);
}

TEST(RunShellTest, HashCoversTheTakenRecords) {
  log::RecordHash expected;
  Bench bench;
  bench.shell->OnRecord([&](const flight::FlightRecord& flown) { expected.Add(flown.record); });
  bench.RunTo(50);
  bench.shell->TakeRecords();
  const std::string hash = bench.Figures().log_hash;
  EXPECT_EQ(hash, expected.Finish());
  // The hash does not depend on logging and tracing.
  const test::TempFolder folder;
  Bench logged(FolderIn(folder.path(), /*has_log=*/true), 8);
  trace::Trace trace("test");
  logged.shell->UseTrack(trace.AddTrack("servo", 4096));
  for (int ms = 1; ms <= 50; ++ms) {
    logged.RunTo(ms);
    logged.shell->TakeRecords();
  }
  EXPECT_EQ(logged.Figures().log_hash, hash);
}

TEST(RunShellTest, CountsTicksAndOverrunsAndTheirDurations) {
  Bench bench;
  bench.clock.late_at_ns = Ms(20);
  bench.clock.late_by_ns = Ms(3);
  bench.RunTo(100);
  const RunFigures figures = bench.Figures();
  EXPECT_EQ(figures.ticks, 97U);
  EXPECT_EQ(figures.overruns, 1U);
  EXPECT_EQ(figures.missed_ticks, 3U);
  EXPECT_GT(figures.tick_ns_p50, 0);
  EXPECT_GE(figures.tick_ns_max, figures.tick_ns_p50);
}

TEST(RunShellTest, CountersOutliveTheLoop) {
  Bench bench;
  bench.RunTo(100);
  bench.shell->EndLoop();
  EXPECT_EQ(bench.shell->loop(), nullptr);
  bench.shell->EndLoop();
  EXPECT_EQ(bench.Figures().ticks, 100U);
}

TEST(RunShellTest, WithoutALoopNothingWasCounted) {
  Bench bench;
  const RunFigures figures = bench.Figures();
  EXPECT_EQ(figures.ticks, 0U);
  EXPECT_EQ(figures.heap_allocations_in_tick, std::nullopt);
  EXPECT_EQ(figures.log_hash, log::RecordHash().Finish());
}

// A recorder that inspects records in the tick and passes every second one on.
class Gate final : public hal::Recorder {
 public:
  explicit Gate(hal::Recorder& next) : next_(next) {}
  void Record(const hal::TickRecord& record) noexcept override {
    if (record.tick % 2 == 0) {
      next_.Record(record);
    }
  }

 private:
  hal::Recorder& next_;
};

TEST(RunShellTest, TheFirstRecorderGetsRecordsBeforeAllOthers) {
  Bench bench;
  Gate gate(bench.shell->recorder());
  int taken = 0;
  bench.shell->OnRecord([&](const flight::FlightRecord&) { ++taken; });
  EXPECT_TRUE(bench.shell->BeginLoop(bench.arm, bench.clock, &gate).Run(Ms(10)).ok());
  bench.shell->TakeRecords();
  EXPECT_EQ(taken, 5);
}

TEST(RunShellTest, TracedTicksAreMeasuredAndRecordedAsWell) {
  Bench bench;
  trace::Trace trace("test");
  trace::Track& track = trace.AddTrack("servo", 4096);
  bench.shell->UseTrack(track);
  int taken = 0;
  bench.shell->OnRecord([&](const flight::FlightRecord&) { ++taken; });
  bench.RunTo(10);
  bench.shell->TakeRecords();
  bench.shell->EndLoop();
  int ticks = 0;
  std::set<std::string> names;
  for (const trace::Span& span : track.Spans()) {
    names.insert(span.name);
    ticks += std::string(span.name) == "tick" ? 1 : 0;
  }
  EXPECT_EQ(ticks, 10);
  EXPECT_GT(names.size(), 3U) << "the stages are traced too";
  EXPECT_EQ(taken, 10);
  EXPECT_GT(bench.Figures().tick_ns_p50, 0);
}

TEST(RunShellTest, DigestsNeedALogAndAServoInThisProcess) {
  const test::TempFolder folder;
  const auto has_digest = [&](bool has_log, bool is_here) {
    Bench bench(has_log ? FolderIn(folder.path(), true) : RunFolderConfig{}, 4096, is_here);
    bool has = false;
    bench.shell->OnRecord([&](const flight::FlightRecord& flown) { has = flown.state_digest.has_value(); });
    bench.RunTo(10);
    bench.shell->TakeRecords();
    return has;
  };
  EXPECT_TRUE(has_digest(true, true));
  EXPECT_FALSE(has_digest(true, false));
  EXPECT_FALSE(has_digest(false, true));
}

TEST(RunShellTest, LogHasEveryTickAndOneKeyframePerSecond) {
  const test::TempFolder folder;
  Bench bench(FolderIn(folder.path(), /*has_log=*/true));
  ASSERT_NE(bench.shell->book(), nullptr);
  for (int ms = 100; ms <= 2000; ms += 100) {
    bench.RunTo(ms);
    bench.shell->TakeRecords();
  }
  RunFigures figures = bench.Figures();
  EXPECT_EQ(figures.records_dropped + figures.log_entries_dropped, 0U);
  nlohmann::ordered_json summary;
  BeginSummary(summary);
  AddFigures(figures, summary);
  bench.shell->Write(summary.dump());
  EXPECT_EQ(FilesIn(folder.path()), (std::set<std::string>{"log.mcap", "report.html", "summary.json"}));
  std::map<std::string, int> messages;
  log::McapVisitor visitor;
  visitor.on_message = [&](const log::McapMessage& m) { ++messages[std::string(m.topic)]; };
  EXPECT_TRUE(log::ReadMcap(folder.path() / "log.mcap", visitor).complete);
  EXPECT_EQ(messages[log::kTickTopic], 2000);
  EXPECT_EQ(messages[log::kKeyframeTopic], 2);
  EXPECT_EQ(nlohmann::json::parse(TextOf(folder.path() / "summary.json"))["log_hash"], figures.log_hash);
}

TEST(RunShellTest, WithoutFactsOnlySummaryAndAddedFilesAreWritten) {
  const test::TempFolder folder;
  RunFolderConfig config = FolderIn(folder.path(), /*has_log=*/false);
  config.options.more_files = {"bench.png", "of-another-run.png"};
  std::ofstream(folder.path() / "of-another-run.png") << "old";
  std::ofstream(folder.path() / "log.mcap") << "old";
  Bench bench(config);
  EXPECT_EQ(bench.shell->book(), nullptr);
  bench.RunTo(10);
  bench.shell->TakeRecords();
  bench.Figures();
  bench.shell->Write("{}", [] { return std::vector<config::OutputFile>{{"bench.png", "a picture"}}; });
  EXPECT_EQ(FilesIn(folder.path()), (std::set<std::string>{"bench.png", "summary.json"}));
  EXPECT_EQ(TextOf(folder.path() / "summary.json"), "{}");
}

TEST(RunShellTest, WithoutAFolderNothingIsWritten) {
  Bench bench;
  EXPECT_EQ(bench.shell->book(), nullptr);
  bench.RunTo(10);
  bench.shell->TakeRecords();
  bench.Figures();
  bench.shell->KeepLog();
  bench.shell->Write("{}", [] {
    ADD_FAILURE() << "files were requested without a folder";
    return std::vector<config::OutputFile>{};
  });
}

TEST(RunShellTest, UnwritableFolderIsRefusedAtOnce) {
  const test::TempFolder folder;
  std::ofstream(folder.path() / "file") << "no folder";
  EXPECT_THROW(Bench(FolderIn(folder.path() / "file", true)), config::InputError);
  EXPECT_THROW(Bench(FolderIn(folder.path() / "file", false)), config::InputError);
}

TEST(RunShellTest, KeepLogKeepsTheIncompleteLog) {
  const test::TempFolder folder;
  Bench bench(FolderIn(folder.path(), /*has_log=*/true));
  bench.RunTo(100);
  bench.shell->TakeRecords();
  bench.shell->KeepLog();
  EXPECT_TRUE(fs::exists(folder.path() / "log.mcap"));
  EXPECT_FALSE(fs::exists(folder.path() / "summary.json"));
}

TEST(RunShellTest, ListsMissingRealtimePrivileges) {
  Bench bench;
  // SCHED_FIFO refuses priority 0 for every user.
  bench.shell->MakeThreadRealtime({.fifo_priority = 0,
                                   .lock_memory = false,
                                   .stack_prefault_kib = 0,
                                   .keep_awake = false,
                                   .keep_memory = false});
  const std::vector<std::string> missing = bench.shell->realtime_missing();
  EXPECT_FALSE(missing.empty());
  EXPECT_EQ(bench.Figures().realtime_missing, missing);
}

}  // namespace
}  // namespace fovea::run
