// The arrows of the design point one way, proved from what each file includes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>

#include "arch/source_tree.hpp"

namespace fovea {
namespace {

// Sources below `folder` may include what matches `allowed`, and the standard library.
struct Rule {
  const char* folder;
  const char* allowed;
  const char* why;
};

void PrintTo(const Rule& rule, std::ostream* out) { *out << rule.folder; }

// Headers of the standard library have neither folder nor extension.
const std::regex kStandard("[a-z_]+");

class IncludeRule : public testing::TestWithParam<Rule> {};

TEST_P(IncludeRule, Holds) {
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

INSTANTIATE_TEST_SUITE_P(
    Tree, IncludeRule,
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
        Rule{"firmware/include/fovea/model", "(fovea/(hal|model)/|Eigen/).*", "the model sees hal and Eigen"},
        Rule{"firmware/model", "(fovea/(hal|model)/|Eigen/).*", "the model sees hal and Eigen"},
        Rule{"firmware/include/fovea/features", "(fovea/(hal|model|features)/|Eigen/).*",
             "features see hal, model and Eigen"},
        Rule{"firmware/features", "(fovea/(hal|model|features)/|Eigen/).*",
             "features see hal, model and Eigen"},
        Rule{"firmware/include/fovea/servo", "(fovea/(hal|model|features|servo)/|Eigen/).*",
             "the servo sees hal, model, features and Eigen"},
        Rule{"firmware/servo",
             "(fovea/(hal|model|features|servo)/|Eigen/).*|(bracketed_root|pose_motion|(laws/"
             ")?motion_laws)[.]hpp",
             "the servo sees hal, model, features and Eigen"},
        Rule{"firmware/include/fovea/link", "(fovea/(hal|model|features|servo|link)/|Eigen/).*",
             "both ends of the line see the servo and no system"},
        Rule{"firmware/link", "(fovea/(hal|model|features|servo|link)/|Eigen/).*|(state|tick)_fields[.]hpp",
             "both ends of the line see the servo and no system"},
        Rule{"hal/drivers/cortex_m7", "fovea/cortex_m7/.*",
             "a driver depends on the contract and on its device"},
        Rule{"firmware/targets/cortex_m7", "fovea/(cortex_m7|link)/.*|emitted/panda[.]hpp",
             "the processor's program sees its driver and the servo behind the line"},
        Rule{"firmware/vision", "(fovea/(hal|model|features|vision)/|Eigen/|opencv2/).*",
             "vision sees hal, features and OpenCV"},
        Rule{"firmware/config",
             "fovea/(hal|model|features|servo|vision|config|robots)/.*|(fmt|toml\\+\\+|Eigen)/"
             ".*|(unistd|fcntl|sys/file)[.]h",
             "nothing of the firmware sees the simulator"},
        Rule{"firmware/robots",
             "fovea/(hal|model|config|robots)/.*|urdf_chain[.]hpp|(fmt|urdf_parser|console_bridge)/.*|Eigen/"
             ".*",
             "nothing of the firmware sees the simulator"},
        Rule{"firmware/log",
             "fovea/(hal|model|features|vision|linux_rt|log)/.*|(log_file|mcap_format|tick_writer)[.]hpp|"
             "(fovea|foxglove)/[a-z]+[.]pb[.]h|(fmt|google|openssl|opencv2)/.*|Eigen/.*|(zlib|zstd)[.]h",
             "nothing of the firmware sees the simulator"},
        Rule{"firmware/flight",
             "fovea/(hal|model|features|servo|link|linux_rt|log|flight)/.*|(fovea|foxglove)/[a-z]+[.]pb[.]h|"
             "(fmt|google)/.*",
             "what is recorded and replayed is the servo, by its log"},
        Rule{"firmware/film",
             "fovea/(hal|model|features|vision|film)/.*|(fmt|opencv2|libavcodec|libavformat|libavutil)/.*",
             "a film is made of frames and detections alone"},
        Rule{"firmware/report",
             "fovea/(hal|log|model|report)/.*|(image_error|scene_reader)[.]hpp|(fovea|foxglove)/"
             "[a-z]+[.]pb[.]h|(fmt|google|nlohmann|openssl)/.*",
             "a report is made of a log alone"},
        Rule{"firmware/trace", "fovea/(hal|servo|trace)/.*|nlohmann/.*",
             "a timeline watches the servo from outside"},
        Rule{"firmware/include/fovea/design", "(fovea/design|Eigen)/.*", "design is mathematics alone"},
        Rule{"firmware/design", "fovea/design/.*|characteristic[.]hpp|(unsupported/)?Eigen/.*",
             "design is mathematics alone"},
        Rule{"firmware/targets/linux",
             "fovea/"
             ".*|(await_leave|check(_camera|_robot)?|frame_figures|gravity_check|operator_(input|thread)|"
             "run_watch|speaker|hw_(camera|config|files|run|scene|summary|vision))[.]"
             "hpp|(fmt|CLI|"
             "nlohmann|Eigen|foxglove)/"
             ".*|(poll|pthread|unistd)[.]h",
             "the hardware target sees drivers and servo, not the simulator"},
        Rule{"tools/fovea",
             "(fovea|foxglove|fmt|CLI|nlohmann|Eigen|opencv2|sys|tools/bench)/.*|[a-z_]+[.]h(pp)?",
             "works beside runs, without the simulator"},
        Rule{"tools/bench",
             "(fovea|fmt|CLI|nlohmann|opencv2|Eigen|kdl|visp3|arpa|netinet|sys|linux)/.*|[a-z_]+[.]h(pp)?",
             "measures, without the simulator"},
        Rule{"firmware/include",
             "(fovea/"
             "(hal|model|features|servo|link|vision|config|design|film|flight|robots|linux_rt|log|report|"
             "trace)/"
             "|Eigen/"
             "|opencv2/"
             "|google/|CLI/).*",
             "nothing of the firmware sees the simulator"},
        Rule{"sim/camera", "fovea/hal/.*|sim/(camera|render)/.*|Eigen/.*",
             "the simulator sees hal, not the firmware"},
        Rule{"sim/physics", "sim/(physics|robot)/.*|Eigen/.*|Bullet.*",
             "physics sees Bullet and the robot alone"},
        Rule{"sim/render", "sim/(render|robot)/.*|(Eigen|epoxy|fmt)/.*",
             "rendering sees no physics and no servo"},
        Rule{"sim/robot", "sim/robot/.*|(Eigen|assimp|fmt|urdf_parser)/.*",
             "the simulated robot comes from its URDF and its meshes alone"},
        Rule{"sim/model_library", "fovea/model/.*|sim/model_library/.*|emitted/panda[.]hpp",
             "what the robot hands out is the servo's model and nothing else"},
        Rule{"sim/mcu",
             "fovea/(hal|model|servo|link)/.*|sim/(mcu/.*|wire/link_faults[.]hpp)|fmt/.*|sys/.*|"
             "(fcntl|poll|sched|signal|unistd)[.]h",
             "the host's end of a board's line sees the messages, and nothing of the simulated world"},
        Rule{"sim/wire", "fovea/(hal|linux_rt|franka)/.*|sim/(wire|robot|world)/.*|Eigen/.*|arv[.]h",
             "the robot's other end of the wire sees its messages and the simulator"},
        Rule{"sim/world", "fovea/hal/.*|sim/(world|physics|render|robot|faults)/.*|Eigen/.*",
             "the simulator sees hal, not the firmware"}),
    [](const auto& rule) {
      std::string name = rule.param.folder;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; },
          '_');
      return name;
    });

}  // namespace
}  // namespace fovea
