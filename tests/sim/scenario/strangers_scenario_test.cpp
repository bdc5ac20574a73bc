// SPDX-License-Identifier: Apache-2.0
// A scenario from an untrusted source: no file that it names is read from outside its folder, by any path.
// Paths that the user types are allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "firmware/host/config/inside_folder.hpp"
#include "sim/render/mesh.hpp"
#include "sim/scenario/run_description.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// A folder with a scenario, and an arm with a mesh both inside and outside of it.
class UntrustedScenario : public testing::Test {
 protected:
  UntrustedScenario() {
    std::ostringstream panda;
    panda << std::ifstream(test::RobotsFolder() + "/panda.urdf").rdbuf();
    urdf_ = panda.str();
    const Mesh box = MakeBox({0.08F, 0.08F, 0.05F}, 0.0F, Eigen::Vector3f::Ones());
    for (const fs::path& folder : {Own("arm"), Outside("")}) {
      fs::create_directories(folder);
      test::WriteStlBinary(folder / "link.stl", box);
      fs::copy_file(test::RobotsFolder() + "/panda.toml", folder / "panda.toml");
      std::ofstream(folder / "panda.urdf") << urdf_;
    }
  }
  fs::path Own(const std::string& name) const { return folder_.path() / "theirs" / name; }
  fs::path Outside(const std::string& name) const { return folder_.path() / "outside" / name; }

  // The error of a scenario with this text; "" if it is accepted.
  std::string Said(const std::string& toml, const std::vector<std::string>& assignments = {}) const {
    std::ofstream(Own("scenario.toml")) << toml;
    try {
      DescribeRun(LoadScenario(Own("scenario.toml"), assignments));
    } catch (const std::exception& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
      return error.what();
    }
    return "";
  }
  std::string SaidOfArm(const std::string& model) const { return Said("[arm]\nmodel = \"" + model + "\"\n"); }
  // The error of the arm in its folder, with `mesh` at its last link.
  std::string SaidOfMesh(const std::string& mesh) const {
    const auto link = urdf_.find("<link name=\"panda_link7\">");
    const auto begin = urdf_.find("<geometry>", link);
    const auto end = urdf_.find("</geometry>", begin);
    std::string urdf = urdf_;
    urdf.replace(begin, end - begin, "<geometry><mesh filename=\"" + mesh + "\"/>");
    std::ofstream(Own("arm/panda.urdf")) << urdf;
    return SaidOfArm("arm/panda.toml");
  }

  const test::TempFolder folder_;

 private:
  std::string urdf_;
};

TEST_F(UntrustedScenario, ArmInItsFolderIsAccepted) {
  EXPECT_EQ(SaidOfArm("panda"), "");
  EXPECT_EQ(SaidOfArm("arm/panda.toml"), "");
  EXPECT_EQ(SaidOfArm("./arm/../arm/panda.toml"), "");
  EXPECT_EQ(SaidOfArm(Own("arm/panda.toml")), "") << "an absolute path to the same place";
  for (const char* mesh : {"link.stl", "../arm/link.stl", "package://arm/link.stl"}) {
    EXPECT_EQ(SaidOfMesh(mesh), "") << mesh;
  }
}

TEST_F(UntrustedScenario, ArmOutsideItsFolderIsRefused) {
  fs::create_symlink(Outside("panda.toml"), Own("linked.toml"));
  fs::create_directory_symlink(Outside(""), Own("linked"));
  for (const std::string& model :
       {std::string("../outside/panda.toml"), std::string("arm/../../outside/panda.toml"),
        Outside("panda.toml").string(), std::string("linked.toml"), std::string("linked/panda.toml"),
        std::string("linked/panda.urdf")}) {
    EXPECT_THAT(SaidOfArm(model), AllOf(HasSubstr("arm.model = \"" + model + "\" is not allowed"),
                                        HasSubstr("outside " + Own("").string())));
  }
  EXPECT_THAT(SaidOfArm("../robots/panda"), HasSubstr("arm.model: unknown arm \"../robots/panda\""));
  EXPECT_THAT(SaidOfArm("pandda"), AllOf(HasSubstr("did you mean panda?"),
                                         HasSubstr("shipped are gantry, panda, puma560, slider, ur5e")));
}

TEST_F(UntrustedScenario, UrdfOutsideItsFolderIsRefused) {
  std::ofstream(Own("far.toml")) << "urdf = \"../outside/panda.urdf\"\n";
  EXPECT_THAT(SaidOfArm("far.toml"),
              AllOf(HasSubstr("urdf = \"../outside/panda.urdf\" is not allowed"), HasSubstr("outside")));
  fs::create_symlink(Outside("panda.urdf"), Own("near.urdf"));
  std::ofstream(Own("far.toml")) << "urdf = \"near.urdf\"\n";
  EXPECT_THAT(SaidOfArm("far.toml"), HasSubstr("is not allowed"));
}

TEST_F(UntrustedScenario, MeshOutsideItsFolderIsRefused) {
  fs::create_symlink(Outside("link.stl"), Own("arm/linked.stl"));
  for (const std::string& mesh : {std::string("../../outside/link.stl"), Outside("link.stl").string(),
                                  "file://" + Outside("link.stl").string(), std::string("linked.stl"),
                                  std::string("package://arm/../../outside/link.stl")}) {
    EXPECT_THAT(SaidOfMesh(mesh), AllOf(HasSubstr("mesh \"" + mesh + "\""), HasSubstr("lies outside")))
        << mesh;
  }
  // Packages are not searched above the folder.
  EXPECT_THAT(SaidOfMesh("package://outside/link.stl"), HasSubstr("no folder of package \"outside\""));
}

// The environment belongs to the user, so its packages are allowed.
TEST_F(UntrustedScenario, MeshInAPackageOfTheUserIsRead) {
  setenv("ROS_PACKAGE_PATH", folder_.path().c_str(), 1);
  EXPECT_EQ(SaidOfMesh("package://outside/link.stl"), "");
  EXPECT_THAT(
      SaidOfMesh("package://outside/../../" + folder_.path().filename().string() + "/outside/link.stl"), "");
  EXPECT_THAT(SaidOfMesh("package://outside/../../../../etc/passwd"), HasSubstr("lies outside"));
  unsetenv("ROS_PACKAGE_PATH");
}

TEST_F(UntrustedScenario, PathTypedByTheUserMayLieAnywhere) {
  EXPECT_EQ(Said("", {"arm.model=\"" + Outside("panda.toml").string() + "\""}), "");
  EXPECT_EQ(Said("[arm]\nmodel = \"../outside/panda.toml\"\n", {"arm.model=panda"}), "");
}

// The run's output folder is named after the file.
TEST_F(UntrustedScenario, NameThatIsAParentFolderIsRefused) {
  for (const char* name : {"..toml", "...toml"}) {
    std::ofstream(Own(name)) << "";
    try {
      ADD_FAILURE() << LoadScenario(Own(name), {}).name;
    } catch (const std::exception& error) {
      EXPECT_THAT(error.what(), HasSubstr("needs a name"));
    }
  }
}

TEST(InsideFolder, FollowsLinksAndDots) {
  const test::TempFolder folder;
  const fs::path top = folder.path() / "top";
  fs::create_directories(top / "below");
  fs::create_directory(folder.path() / "top-most");
  fs::create_directory_symlink(folder.path(), top / "up");
  fs::create_directory_symlink(top / "below", folder.path() / "into");
  for (const char* inside : {"a", "below/a", "below/../a", "up/top/a", ".", ""}) {
    EXPECT_TRUE(config::IsInside(top, inside)) << inside;
  }
  EXPECT_TRUE(config::IsInside(top, top / "a"));
  EXPECT_TRUE(config::IsInside(top, folder.path() / "into/a"));
  for (const char* outside :
       {"..", "../a", "up/a", "up/../a", "below/../../top-most/a", "../top-most", "/", "/etc/passwd"}) {
    EXPECT_FALSE(config::IsInside(top, outside)) << outside;
  }
}

}  // namespace
}  // namespace fovea::sim
