// The arrows of the design point one way, proved from what each file includes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>

#include "tests/arch/source_tree.hpp"

namespace fovea {
namespace {

// Sources below `folder` may include what matches `allowed`, and the standard library.
struct Rule {
  std::string folder;
  std::string allowed;
  std::string why;
};

void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.folder; }

// Headers of the standard library have neither folder nor extension.
const std::regex kStandard("[a-z_]+");

std::string NameOf(const testing::TestParamInfo<Rule>& rule) {
  std::string name = rule.param.folder;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

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

// The rooms of the core, each with those that it may see besides itself, hal and Eigen.
std::string Rooms(const char* rooms) {
  return std::string("fovea/hal/.*|Eigen/.*|firmware/core/(") + rooms + ")/.*";
}

INSTANTIATE_TEST_SUITE_P(
    Hal, IncludeRule,
    testing::Values(
        Rule{"hal/include", "fovea/hal/.*", "the contract depends on the standard library alone"},
        Rule{"hal/src", "fovea/hal/.*", "the contract depends on the standard library alone"},
        Rule{"hal/drivers/linux_rt", "fovea/(hal|linux_rt)/.*|(sys/|fcntl|malloc|sched|unistd|pthread).*",
             "a driver depends on the contract and on its device"},
        Rule{"hal/drivers/camera", "fovea/(hal|linux_rt|camera)/.*|opencv2/.*",
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
        Rule{"firmware/core", Rooms("[a-z_]+"), "the core sees hal and Eigen alone"},
        Rule{"firmware/core/model", Rooms("model"), "the model sees no other room"},
        Rule{"firmware/core/features", Rooms("model|features"), "a feature sees the model alone"},
        Rule{"firmware/core/config", Rooms("model|features|config"), "settings are data"},
        Rule{"firmware/core/trajectory", Rooms("model|features|config|trajectory"),
             "motions of axes know neither target nor barriers"},
        Rule{"firmware/core/barriers", Rooms("model|features|config|trajectory|barriers"),
             "a barrier knows no law"},
        Rule{"firmware/core/estimate", Rooms("model|features|config|estimate"),
             "what is estimated does not depend on what is done"},
        Rule{"firmware/core/guard", Rooms("model|features|config|trajectory|barriers|guard"),
             "the proof of a stop knows no wish"},
        Rule{"firmware/core/control", Rooms("model|features|config|trajectory|barriers|control"),
             "a law knows neither estimate nor guard"},
        Rule{"firmware/core/motion_laws", Rooms("model|features|config|trajectory|motion_laws"),
             "a motion law follows a reference"},
        Rule{"firmware/core/moves", Rooms("model|features|config|trajectory|barriers|control|guard|moves"),
             "commanded motions pass the same limits as the law"},
        Rule{"firmware/core/task", Rooms("[a-km-z][a-z_]+"), "the task sees every room but the line"},
        Rule{"firmware/core/link", Rooms("[a-z_]+"), "both ends of the line see the servo and no system"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Firmware, IncludeRule,
    testing::Values(
        Rule{"firmware/include", "firmware/(core|vision|host)/.*",
             "the outside sees no driver and no target"},
        Rule{"firmware/vision", "fovea/hal/.*|firmware/(core|vision)/.*|(Eigen|opencv2)/.*",
             "vision sees core and OpenCV"},
        Rule{"firmware/host",
             "(fovea/(hal|linux_rt)|firmware/(core|vision|host)|Eigen|unsupported/Eigen|opencv2)/.*|"
             "(fovea|foxglove)/[a-z]+[.]pb[.]h|"
             "(CLI|console_bridge|fmt|google|libavcodec|libavformat|libavutil|nlohmann|openssl|toml\\+\\+|"
             "urdf_parser)/.*|(fcntl|unistd|sys/file|sys/ioctl|zlib|zstd)[.]h",
             "the host's part sees core, vision and libraries, no driver of a device and no simulator"},
        Rule{"firmware/host/config",
             "fovea/hal/.*|firmware/(core|vision|host/(calibration|config|robots))/"
             ".*|(CLI|fmt|toml\\+\\+|Eigen)/.*|"
             "(unistd|fcntl|sys/file|sys/ioctl)[.]h",
             "keys are of servo and vision"},
        Rule{"firmware/host/robots",
             "firmware/(core/model|host/(config|robots))/.*|(fmt|urdf_parser|console_bridge|Eigen)/.*",
             "an arm comes from its files"},
        Rule{"firmware/host/design", "firmware/host/design/.*|(unsupported/)?Eigen/.*",
             "design is mathematics alone"},
        Rule{"firmware/host/recording",
             "(fovea/(hal|linux_rt)|firmware/(core|vision|host/recording)|Eigen|opencv2|fmt|google|nlohmann|"
             "openssl)/.*|(fovea|foxglove)/[a-z]+[.]pb[.]h|(zlib|zstd)[.]h",
             "what is recorded is the servo and its pictures"},
        Rule{"firmware/host/film",
             "fovea/(hal|linux_rt)/.*|firmware/(core|vision|host/film)/.*|"
             "(Eigen|fmt|opencv2|libavcodec|libavformat|libavutil)/.*",
             "a film is made of frames and detections alone"},
        Rule{"firmware/host/report",
             "fovea/hal/.*|firmware/(core/(config|link|model)|host/(recording|report))/.*|"
             "firmware/core/features/target_traits[.]hpp|(fovea|foxglove)/[a-z]+[.]pb[.]h|"
             "(fmt|google|nlohmann|openssl)/.*",
             "a report is made of a log alone, and knows the kinds of arms and targets in it"},
        Rule{"firmware/host/run",
             "fovea/(hal|linux_rt)/.*|firmware/(core|vision|host/"
             "(build_info|config|film|recording|report|run))"
             "[./].*|(fmt|nlohmann)/.*|(fovea|foxglove)/[a-z]+[.]pb[.]h",
             "what a run leaves is its servo, its pictures and their recording, whoever ran it"},
        Rule{"firmware/targets/cortex_m7", "fovea/cortex_m7/.*|firmware/core/.*|emitted/panda[.]hpp",
             "the processor's program sees its driver and the servo behind the line"},
        Rule{"firmware/targets/linux",
             "(fovea|firmware|fmt|CLI|nlohmann|Eigen|foxglove)/.*|(poll|pthread|unistd)[.]h",
             "the hardware target sees drivers and servo, not the simulator"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Sim, IncludeRule,
    testing::Values(
        Rule{"sim/camera", "fovea/hal/.*|sim/(camera|render)/.*|Eigen/.*",
             "the simulated world sees hal, not the firmware"},
        Rule{"sim/faults", "fovea/hal/.*|sim/(camera|faults|render)/.*|Eigen/.*",
             "the simulated world sees hal, not the firmware"},
        Rule{"sim/physics", "sim/(physics|robot)/.*|Eigen/.*|Bullet.*",
             "physics sees Bullet and the robot alone"},
        Rule{"sim/render", "sim/(render|robot)/.*|(Eigen|epoxy|fmt)/.*",
             "rendering sees no physics and no servo"},
        Rule{"sim/robot", "sim/robot/.*|(Eigen|assimp|fmt|urdf_parser)/.*",
             "the simulated robot comes from its URDF and its meshes alone"},
        Rule{"sim/model_library", "firmware/core/model/.*|sim/model_library/.*|emitted/panda[.]hpp",
             "what the robot hands out is the servo's model and nothing else"},
        Rule{"sim/mcu",
             "fovea/hal/.*|firmware/core/.*|sim/(mcu/.*|faults/link_faults[.]hpp)|fmt/.*|sys/.*|"
             "(fcntl|poll|sched|signal|unistd)[.]h",
             "the host's end of a board's line sees the messages, and nothing of the simulated world"},
        Rule{
            "sim/panda",
            "fovea/(hal|linux_rt|franka)/.*|sim/(panda|robot|world)/.*|sim/faults/link_faults[.]hpp|Eigen/.*",
            "the robot's other end of the wire sees its messages and the simulator"},
        Rule{"sim/gige", "fovea/(hal|linux_rt)/.*|fovea/franka/sockets[.]hpp|sim/gige/.*|arv[.]h",
             "the camera's other end of the wire sees frames alone"},
        Rule{"sim/world", "fovea/hal/.*|sim/(world|physics|render|robot|faults)/.*|Eigen/.*",
             "the simulated world sees hal, not the firmware"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Tools, IncludeRule,
    testing::Values(
        Rule{"tools/fovea",
             "(fovea|firmware|tools|foxglove|fmt|CLI|nlohmann|Eigen|opencv2|sys)/.*|[a-z_]+[.]h",
             "works beside runs, without the simulator"},
        Rule{"tools/bench",
             "(fovea|firmware|tools|fmt|CLI|nlohmann|opencv2|Eigen|kdl|visp3|arpa|netinet|sys|linux)/.*|"
             "[a-z_]+[.]h",
             "measures, without the simulator"}),
    NameOf);

}  // namespace
}  // namespace fovea
