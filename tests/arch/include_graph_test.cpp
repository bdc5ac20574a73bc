// SPDX-License-Identifier: Apache-2.0
// Checks from the #include lines that dependencies between folders point one way only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "tests/arch/source_tree.hpp"

namespace fovea {
namespace {

// Sources below `folder` may include headers that match `allowed`, and the standard library.
struct Rule {
  std::string folder;
  std::string allowed;
  std::string why;
};

void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.folder; }

// Headers of the standard library have neither folder nor extension.
const std::regex kStandard("[a-z_]+");

std::string NameOfFolder(std::string folder) {
  std::replace_if(
      folder.begin(), folder.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; },
      '_');
  return folder;
}

std::string NameOf(const testing::TestParamInfo<Rule>& rule) { return NameOfFolder(rule.param.folder); }

class IncludeRule : public testing::TestWithParam<Rule> {};

TEST_P(IncludeRule, EveryIncludeIsAllowed) {
  const Rule& rule = GetParam();
  const std::regex allowed(rule.allowed);
  const auto files = test::SourcesIn(rule.folder);
  ASSERT_FALSE(files.empty());
  for (const auto& file : files) {
    for (const std::string& include : test::IncludesOf(file)) {
      EXPECT_TRUE(std::regex_match(include, kStandard) || std::regex_match(include, allowed))
          << std::filesystem::relative(file, test::SourceRoot()).string() << " includes " << include << ": "
          << rule.why;
    }
  }
}

// Matches hal, Eigen and the core modules that match `rooms`.
std::string Rooms(const char* rooms) {
  return std::string("fovea/hal/.*|Eigen/.*|firmware/core/(") + rooms + ")/.*";
}

// Matches core, OpenCV, the types that all of vision shares, and the modules of vision that match `rooms`.
std::string Vision(const char* rooms) {
  return std::string("fovea/hal/.*|firmware/core/.*|(Eigen|opencv2)/.*|firmware/vision/([a-z_]+[.]hpp|(") +
         rooms + ")/.*)";
}

// Matches what scenarios, runs and verdicts use, and the folders of sim that match `rooms`.
std::string Runs(const char* rooms) {
  return std::string(
             "(fovea|firmware|foxglove|fmt|CLI|nlohmann|Eigen|opencv2|sys)/"
             ".*|(fcntl|poll|spawn|unistd)[.]h|sim/"
             "(") +
         rooms + ")/.*";
}

INSTANTIATE_TEST_SUITE_P(
    Hal, IncludeRule,
    testing::Values(
        Rule{"hal/include", "fovea/hal/.*", "the contract depends only on the standard library"},
        Rule{"hal/src", "fovea/hal/.*", "the contract depends only on the standard library"},
        Rule{"hal/drivers/linux_rt",
             "fovea/(hal|linux_rt)/.*|(sys/|fcntl|malloc|poll|sched|unistd|pthread).*",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/camera", "fovea/(hal|camera)/.*|opencv2/.*",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/recorded", "fovea/(hal|linux_rt|camera|recorded)/.*|opencv2/.*",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/genicam",
             "fovea/(hal|linux_rt|camera|genicam)/.*|opencv2/.*|(aravis_session|device_clock)[.]hpp|arv[.]h",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/franka",
             "fovea/(hal|linux_rt|franka)/.*|(arpa|netinet|sys)/.*|(fcntl|netdb|poll|unistd)[.]h",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/v4l2",
             "fovea/(hal|linux_rt|camera|v4l2)/.*|opencv2/.*|v4l2_session[.]hpp|(linux|sys)/"
             ".*|(fcntl|poll|unistd)[.]h",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/cortex_m7", "fovea/cortex_m7/.*",
             "a driver depends on the contract and on its device"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Core, IncludeRule,
    testing::Values(
        Rule{"firmware/core", Rooms("[a-z_]+"), "the core depends only on hal and Eigen"},
        Rule{"firmware/core/model", Rooms("model"), "the model depends on no other module"},
        Rule{"firmware/core/features", Rooms("model|features"), "a feature depends only on the model"},
        Rule{"firmware/core/config", Rooms("model|features|config"), "the configuration is plain data"},
        Rule{"firmware/core/trajectory", Rooms("model|features|config|trajectory"),
             "axis motions depend on neither target nor barriers"},
        Rule{"firmware/core/barriers", Rooms("model|features|config|trajectory|barriers"),
             "a barrier depends on no control law"},
        Rule{"firmware/core/estimate", Rooms("model|features|config|estimate"),
             "an estimate does not depend on the control law"},
        Rule{"firmware/core/guard", Rooms("model|features|config|trajectory|barriers|guard"),
             "the proof of a stop does not depend on the control law"},
        Rule{"firmware/core/control", Rooms("model|features|config|trajectory|barriers|control"),
             "a law depends on neither estimate nor guard"},
        Rule{"firmware/core/motion_laws", Rooms("model|features|config|trajectory|motion_laws"),
             "a motion law only follows a reference"},
        Rule{"firmware/core/moves", Rooms("model|features|config|trajectory|barriers|control|guard|moves"),
             "commanded motions pass the same limits as the law"},
        Rule{"firmware/core/task", Rooms("(?!link/)[a-z_]+"),
             "the task depends on every module except the link"},
        Rule{"firmware/core/link", Rooms("[a-z_]+"),
             "both ends of the link depend on the servo and on no operating system"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Firmware, IncludeRule,
    testing::Values(
        Rule{"firmware/include", "firmware/(core|vision|host)/.*",
             "public headers expose no driver and no hardware target"},
        Rule{"firmware/planning", "fovea/hal/.*|firmware/(core|planning)/.*|Eigen/.*",
             "planning depends on the core alone"},
        Rule{"firmware/vision", "fovea/hal/.*|firmware/(core|vision)/.*|(Eigen|opencv2)/.*",
             "vision depends only on core and OpenCV"},
        Rule{"firmware/vision/find", Vision("find"), "finding depends on no fit and no pose"},
        Rule{"firmware/vision/fit", Vision("find|pose|fit"), "a fit depends on no detector"},
        Rule{"firmware/vision/pose", Vision("find|pose"), "a pose depends on no fit"},
        Rule{"firmware/host",
             "(fovea/(hal|linux_rt)|firmware/(core|vision|host)|Eigen|unsupported/Eigen|opencv2)/.*|"
             "(fovea|foxglove)/[a-z]+[.]pb[.]h|"
             "(CLI|arpa|boost|console_bridge|fmt|google|libavcodec|libavformat|libavutil|netinet|nlohmann|"
             "openssl|"
             "sys|toml\\+\\+|urdf_parser)/.*|(fcntl|poll|unistd|zlib|zstd)[.]h",
             "the host part depends on core, vision and libraries, on no device driver and no simulator"},
        Rule{"firmware/host/config",
             "fovea/hal/.*|firmware/(core|vision|host/(calibration|config|robots))/"
             ".*|(CLI|fmt|toml\\+\\+|Eigen)/.*|"
             "(unistd|fcntl|poll|sys/file|sys/ioctl)[.]h",
             "keys configure servo and vision only"},
        Rule{"firmware/host/desk",
             "fovea/hal/.*|firmware/(core/(config|task)|host/(desk|live))/.*|firmware/host/beliefs/"
             "belief[.]hpp|fmt/.*",
             "a desk passes on what viewers ask of a servo, and knows no program"},
        Rule{"firmware/host/live",
             "firmware/host/(config|live|recording)/.*|(arpa|boost|fmt|google|netinet|nlohmann|sys)/.*|"
             "(fovea|foxglove)/[a-z]+[.]pb[.]h|unistd[.]h",
             "the live page shows a run's log, and knows neither the servo nor who runs it"},
        Rule{"firmware/host/robots",
             "firmware/(core/model|host/(config|robots))/.*|(fmt|urdf_parser|console_bridge|Eigen)/.*",
             "an arm is read from its files only"},
        Rule{"firmware/host/beliefs", "fovea/hal/.*|firmware/(core|host/beliefs)/.*|(Eigen|fmt|nlohmann)/.*",
             "what a run tells follows from the servo's records, whatever program ran it"},
        Rule{"firmware/host/design", "firmware/host/design/.*|(unsupported/)?Eigen/.*",
             "gain design is mathematics only"},
        Rule{"firmware/host/recording",
             "(fovea/(hal|linux_rt)|firmware/(core|vision|host/recording)|Eigen|opencv2|fmt|google|nlohmann|"
             "openssl)/.*|(fovea|foxglove)/[a-z]+[.]pb[.]h|(zlib|zstd)[.]h",
             "a recording contains only the servo and its pictures"},
        Rule{"firmware/host/film",
             "fovea/(hal|linux_rt)/.*|firmware/(core|vision|host/film)/.*|"
             "(Eigen|fmt|opencv2|libavcodec|libavformat|libavutil)/.*",
             "a film is made only of frames and detections"},
        Rule{"firmware/host/report",
             "fovea/hal/.*|firmware/(core/(config|link|model)|host/(recording|report))/.*|"
             "firmware/core/features/target_traits[.]hpp|(fovea|foxglove)/[a-z]+[.]pb[.]h|"
             "(fmt|google|nlohmann|openssl)/.*",
             "a report is made only from a log, and knows the kinds of arms and targets in it"},
        Rule{"firmware/host/run",
             "fovea/(hal|linux_rt)/.*|firmware/(core|vision|host/"
             "(build_info|config|film|recording|report|run))"
             "[./].*|(fmt|nlohmann)/.*|(fovea|foxglove)/[a-z]+[.]pb[.]h",
             "a run's files come from servo, pictures and recording, whichever program runs it"},
        Rule{"firmware/targets/cortex_m7", "fovea/cortex_m7/.*|firmware/core/.*|emitted/panda[.]hpp",
             "the processor's program depends on its driver and on the servo behind the link"},
        Rule{"firmware/targets/linux",
             "(fovea|firmware|fmt|CLI|nlohmann|Eigen|foxglove)/.*|(poll|pthread|unistd)[.]h",
             "the hardware target depends on drivers and servo, not on the simulator"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Sim, IncludeRule,
    testing::Values(
        Rule{"sim/camera",
             "fovea/(hal/.*|camera/raw_picture[.]hpp)|opencv2/core[.]hpp|sim/(camera|render)/.*|Eigen/.*",
             "the simulated world depends on hal and the formats of its drivers, not on the firmware"},
        Rule{"sim/drives",
             "fovea/hal/types[.]hpp|sim/(drives|robot)/.*|sim/physics/friction_impulse[.]hpp|Eigen/.*",
             "a drive knows its joint only"},
        Rule{"sim/faults", "fovea/hal/.*|sim/(camera|faults|render)/.*|Eigen/.*",
             "the simulated world depends on hal and the formats of its drivers, not on the firmware"},
        Rule{"sim/physics", "sim/(physics|robot)/.*|Eigen/.*|(Bullet|LinearMath).*",
             "physics depends only on Bullet and the robot"},
        Rule{"sim/render", "sim/(render|robot)/.*|(Eigen|epoxy|fmt)/.*",
             "rendering depends on neither physics nor servo"},
        Rule{"sim/robot", "sim/robot/.*|(Eigen|assimp|fmt|urdf_parser)/.*",
             "the simulated robot is read only from its URDF and its meshes"},
        Rule{"sim/model_library", "firmware/core/model/.*|sim/model_library/.*|emitted/panda[.]hpp",
             "the robot's model library contains only the servo's model"},
        Rule{"sim/mcu",
             "fovea/hal/.*|firmware/core/.*|sim/(mcu/.*|faults/link_faults[.]hpp)|fmt/.*|sys/.*|"
             "(fcntl|poll|sched|signal|unistd)[.]h",
             "the host end of the board's link depends on the messages, not on the simulated world"},
        Rule{
            "sim/panda",
            "fovea/(hal|linux_rt|franka)/.*|sim/(panda|robot|world)/.*|sim/faults/link_faults[.]hpp|Eigen/.*",
            "the robot's network end depends on its messages and on the simulator"},
        Rule{"sim/gige", "fovea/(hal|linux_rt)/.*|fovea/franka/sockets[.]hpp|sim/gige/.*|arv[.]h",
             "the camera's network end depends only on frames"},
        Rule{"sim/world", "fovea/hal/.*|sim/(world|drives|physics|render|robot|faults)/.*|Eigen/.*",
             "the simulated world depends on hal and the formats of its drivers, not on the firmware"},
        Rule{"sim/truth",
             "firmware/host/config/(input_error|key_table)[.]hpp|sim/truth/.*|sim/camera/mix_bits[.]hpp|"
             "sim/faults/chance[.]hpp|(fmt|nlohmann)/.*",
             "what may be true is known without a run"},
        Rule{"sim/scenario", Runs("scenario|camera|drives|faults|physics|render|robot|truth|world"),
             "a scenario describes a run and knows no verdict"},
        Rule{"sim/theory", Runs("theory|scenario|world"), "an analytic response depends on no run"},
        Rule{"sim/verdict",
             "fovea/hal/(events|record|types)[.]hpp|firmware/core/(config|features|model|trajectory)/.*|"
             "firmware/host/(beliefs/(belief|findings_json)|config/(printed_table|terminal)|run/"
             "(fault_event|in_words|run_figures))[.]hpp|"
             "sim/verdict/.*|sim/(camera/lens|mcu/board_summary|render/pinhole|theory/run|truth/"
             "(truth_draw|truth_text)|world/world)[.]hpp|"
             "sim/scenario/(commanded_motion|fault_settings|run_description)[.]hpp|(fmt|nlohmann)/.*",
             "a verdict depends on truth, records and scenario, not on the run that it judges"},
        Rule{"sim/run", Runs("run|verdict|theory|scenario|camera|faults|gige|render|world"),
             "a run depends on no program"},
        Rule{"sim/operator", Runs("operator|run|scenario|faults|render|robot|world"),
             "what an operator may do depends on no program and no verdict"},
        Rule{"sim/calibration", Runs("calibration|scenario|camera|physics|render|robot|world"),
             "calibration pictures need no run"},
        Rule{"sim/app", Runs("[a-z_]+"), "the programs combine everything"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Tools, IncludeRule,
    testing::Values(
        Rule{"tools/fovea",
             "(fovea|firmware|tools|foxglove|fmt|google|CLI|nlohmann|Eigen|opencv2|sys)/.*|[a-z_]+[.]h|"
             "sim/(robot|scenario|world)/.*",
             "the programs work on recorded runs; one compares these with the simulated arm, one asks what "
             "the arm "
             "hides"},
        Rule{"tools/bench",
             "(fovea|firmware|foxglove|tools|fmt|CLI|nlohmann|opencv2|Eigen|kdl|visp3|arpa|netinet|sys|linux)"
             "/.*|"
             "[a-z_]+[.]h",
             "the benchmarks run without the simulator"}),
    NameOf);

// The others are built without the simulator.
TEST(ToolsTest, OnlyTheComparisonAndTheDrawnArmUseTheSimulator) {
  int used = 0;
  for (const auto& file : test::SourcesIn("tools/fovea")) {
    const std::string name = std::filesystem::relative(file, test::SourceRoot()).generic_string();
    for (const std::string& include : test::IncludesOf(file)) {
      const bool is_sim = include.starts_with("sim/");
      used += is_sim ? 1 : 0;
      EXPECT_TRUE(!is_sim || name.starts_with("tools/fovea/compare/") ||
                  name == "tools/fovea/atlas/drawn_arm.cpp")
          << name << " includes " << include;
    }
  }
  EXPECT_GT(used, 0);
}

// Boost's headers take long to compile.
TEST(IncludeRules, OnlyTheServersConnectionsIncludeBoost) {
  std::vector<std::string> users;
  for (const char* tree : {"hal", "firmware", "sim", "tools", "tests"}) {
    for (const auto& file : test::SourcesIn(tree)) {
      const std::vector<std::string> includes = test::IncludesOf(file);
      if (std::any_of(includes.begin(), includes.end(),
                      [](const std::string& include) { return include.starts_with("boost/"); })) {
        users.push_back(std::filesystem::relative(file, test::SourceRoot()).string());
      }
    }
  }
  EXPECT_EQ(users, std::vector<std::string>{"firmware/host/live/web_connections.hpp"});
}

TEST(IncludeRules, CoverEveryFolder) {
  std::set<std::string> ruled;
  const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
  for (int i = 0; i < tests.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *tests.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k) {
      const std::string name = suite.GetTestInfo(k)->name();
      if (name.starts_with("EveryIncludeIsAllowed/")) {
        ruled.insert(name.substr(name.find('/') + 1));
      }
    }
  }
  for (const char* tree : {"hal", "firmware", "sim", "tools"}) {
    for (const auto& file : test::SourcesIn(tree)) {
      const auto inside = std::filesystem::relative(file, test::SourceRoot());
      bool has_rule = false;
      for (auto folder = inside.parent_path(); !folder.empty(); folder = folder.parent_path()) {
        has_rule = has_rule || ruled.contains(NameOfFolder(folder.string()));
      }
      EXPECT_TRUE(has_rule) << "no rule for the folder of " << inside.string();
    }
  }
}

// The folders below a tree use each other in one direction: no folder reaches itself.
class FolderOrder : public testing::TestWithParam<const char*> {};

TEST_P(FolderOrder, FoldersFormNoCycle) {
  const std::string tree = GetParam();
  // The tree for its own files, "" for files outside.
  const auto folder_of = [&tree](const std::string& path) {
    const std::size_t end = path.find('/', tree.size() + 1);
    const std::string folder = end == std::string::npos ? tree : path.substr(0, end);
    return path.starts_with(tree + "/") ? folder : std::string();
  };
  std::map<std::string, std::set<std::string>> uses;
  for (const auto& file : test::SourcesIn(tree)) {
    const std::string from = folder_of(std::filesystem::relative(file, test::SourceRoot()).string());
    for (const std::string& include : test::IncludesOf(file)) {
      if (const std::string to = folder_of(include); !from.empty() && !to.empty() && to != from) {
        uses[from].insert(to);
      }
    }
  }
  EXPECT_FALSE(uses.empty());
  for (const auto& [folder, first] : uses) {
    std::set<std::string> reached;
    std::vector<std::string> open(first.begin(), first.end());
    while (!open.empty()) {
      const std::string next = open.back();
      open.pop_back();
      if (reached.insert(next).second) {
        open.insert(open.end(), uses[next].begin(), uses[next].end());
      }
    }
    EXPECT_FALSE(reached.contains(folder)) << folder << " uses folders that use it";
  }
}

INSTANTIATE_TEST_SUITE_P(Trees, FolderOrder,
                         testing::Values("firmware/core", "firmware/vision", "firmware/host", "sim"),
                         [](const testing::TestParamInfo<const char*>& tree) {
                           return NameOfFolder(tree.param);
                         });

}  // namespace
}  // namespace fovea
