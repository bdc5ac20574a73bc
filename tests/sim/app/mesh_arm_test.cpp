// SPDX-License-Identifier: Apache-2.0
// An arm whose robot description has meshes, on the command line of fovea-sim.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/render/mesh.hpp"
#include "tests/sim/app/command_line.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// The Panda with a mesh at its last link.
class MeshArmTest : public CommandLineTest {
 protected:
  MeshArmTest() {
    std::ostringstream panda;
    panda << std::ifstream(test::RobotsFolder() + "/panda.urdf").rdbuf();
    urdf_ = panda.str();
    fs::create_directory(folder_.path() / "meshes");
    const sim::Mesh box = sim::MakeBox({0.08F, 0.08F, 0.05F}, 0.0F, Eigen::Vector3f::Ones());
    WriteStlBinary(folder_.path() / "meshes" / "link.stl", box);
    fs::copy_file(test::RobotsFolder() + "/panda.toml", folder_.path() / "panda.toml");
  }
  // Replaces the first visual and the first collision geometry
  // of link 7 by `mesh`. Returns the setting of this arm.
  std::string Arm(const std::string& mesh) {
    const auto link = urdf_.find("<link name=\"panda_link7\">");
    std::string urdf = urdf_;
    for (const char* tag : {"<visual>", "<collision>"}) {
      const auto begin = urdf.find("<geometry>", urdf.find(tag, link));
      const auto end = urdf.find("</geometry>", begin);
      urdf.replace(begin, end - begin, "<geometry>" + mesh);
    }
    Write("panda.urdf", urdf);
    return "arm.model=\"" + (folder_.path() / "panda.toml").string() + "\"";
  }

 private:
  std::string urdf_;
};

TEST_F(MeshArmTest, RunWithMeshesFindsTheTargetInEveryFrame) {
  const std::string arm = Arm("<mesh filename=\"meshes/link.stl\"/>");
  const ProgramResult result = Sim(
      {"run", "ball", "--set", arm, "--set", "run.duration_s=0.5", "--json", "--no-report", "--out", Out()});
  ASSERT_EQ(result.exit_code, 1) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["ticks"], 500);
  EXPECT_EQ(json["frames_detected"], json["frames"]);
  EXPECT_EQ(json["contact_ticks"], 0);
}

TEST_F(MeshArmTest, UnusableMeshIsRefusedWithAReason) {
  const auto refusal = [&](const std::string& mesh) { return Refusal({"ball", "--set", Arm(mesh)}); };
  const std::string gone = refusal("<mesh filename=\"package://panda_description/gone.stl\"/>");
  EXPECT_THAT(
      gone, AllOf(HasSubstr("panda.urdf: link \"panda_link7\": mesh \"package://panda_description/gone.stl"),
                  HasSubstr("ROS_PACKAGE_PATH")));
  EXPECT_THAT(refusal("<mesh filename=\"meshes/gone.stl\"/>"), HasSubstr("meshes/gone.stl"));
  EXPECT_THAT(refusal("<mesh filename=\"panda.toml\"/>"), HasSubstr(".stl, .dae and .obj"));
  EXPECT_THAT(refusal("<mesh filename=\"meshes/link.stl\" scale=\"1 1 0\"/>"), HasSubstr("scale = 1 1 0"));
  EXPECT_THAT(refusal("<mesh filename=\"meshes/link.stl\" scale=\"1 1\"/>"),
              AllOf(HasSubstr("panda.urdf"), HasSubstr("scale"), HasSubstr("panda_link7")));
  EXPECT_THAT(refusal("<mesh/>"),
              AllOf(HasSubstr("panda.urdf"), HasSubstr("filename"), HasSubstr("panda_link7")));
  EXPECT_THAT(refusal("<cone/>"),
              AllOf(HasSubstr("panda.urdf"), HasSubstr("cone"), HasSubstr("panda_link7")));
  Write("meshes/empty.dae", "");
  EXPECT_THAT(refusal("<mesh filename=\"meshes/empty.dae\"/>"), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace fovea::test
