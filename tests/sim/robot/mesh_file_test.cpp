// SPDX-License-Identifier: Apache-2.0
// Mesh files: a tetrahedron written in each format is read back in place, with outward normals.
#include "sim/robot/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <sstream>

#include "sim/physics/hull_points.hpp"
#include "sim/render/mesh.hpp"
#include "sim/render/simplify.hpp"
#include "sim/robot/mesh_path.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::AllOf;
using testing::HasSubstr;

const Vector3d kOne(1.0, 1.0, 1.0);
const Vector3f kRed(0.8F, 0.1F, 0.2F);
const Vector3f kGrey(0.7F, 0.7F, 0.7F);

// A tetrahedron without rotation or mirror symmetry; volume 0.1 * 0.2 * 0.3 / 6.
Mesh Tetrahedron() {
  Mesh mesh;
  for (const Vector3f& p :
       {Vector3f(0, 0, 0), Vector3f(0.1F, 0, 0), Vector3f(0, 0.2F, 0), Vector3f(0, 0, 0.3F)}) {
    mesh.vertices.push_back({p, Vector3f::UnitZ(), kGrey});
  }
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  return mesh;
}

// Positive if the triangles are counter-clockwise seen from outside.
double Volume(const Mesh& mesh) {
  double six = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vector3f& a = mesh.vertices[mesh.indices[t]].position;
    const Vector3f& b = mesh.vertices[mesh.indices[t + 1]].position;
    const Vector3f& c = mesh.vertices[mesh.indices[t + 2]].position;
    six += static_cast<double>(a.dot(b.cross(c)));
  }
  return six / 6.0;
}

// The largest angle between a corner's normal and its triangle's, as 1 - cos.
double WorstNormal(const Mesh& mesh) {
  double worst = 0.0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vertex* v[3] = {&mesh.vertices[mesh.indices[t]], &mesh.vertices[mesh.indices[t + 1]],
                          &mesh.vertices[mesh.indices[t + 2]]};
    const Vector3f n = (v[1]->position - v[0]->position).cross(v[2]->position - v[0]->position).normalized();
    for (const Vertex* corner : v) {
      worst = std::max(worst, 1.0 - static_cast<double>(n.dot(corner->normal)));
    }
  }
  return worst;
}

// The largest coordinate along each axis, independent of the order of vertices.
Vector3f Reach(const Mesh& mesh, float sign) {
  Vector3f reach = Vector3f::Constant(-1e9F);
  for (const Vertex& v : mesh.vertices) {
    reach = reach.cwiseMax(sign * v.position);
  }
  return sign * reach;
}

class MeshFileTest : public testing::Test {
 protected:
  fs::path File(const std::string& name) const { return folder_.path() / name; }

  static void ExpectTetrahedron(const Mesh& mesh, const Vector3d& size, const Vector3f& colour,
                                const std::string& what) {
    const double box = size.prod();
    const double wrong =
        std::max((Reach(mesh, 1.0F).cast<double>() - size.cwiseMax(0.0)).cwiseAbs().maxCoeff(),
                 (Reach(mesh, -1.0F).cast<double>() - size.cwiseMin(0.0)).cwiseAbs().maxCoeff());
    std::cout << what << ": corners off by " << wrong << " m, volume by "
              << std::fabs(Volume(mesh) / (std::fabs(box) / 6.0) - 1.0) << ", normals by "
              << WorstNormal(mesh) << "\n";
    EXPECT_EQ(mesh.num_triangles(), 4U) << what;
    EXPECT_LT(wrong, 1e-6) << what;
    EXPECT_NEAR(Volume(mesh) / (std::fabs(box) / 6.0), 1.0, 1e-5) << what;
    EXPECT_LT(WorstNormal(mesh), 1e-5) << what << ": flat faces";
    for (const Vertex& v : mesh.vertices) {
      EXPECT_TRUE(v.colour.isApprox(colour, 1e-5F)) << what << ": " << v.colour.transpose();
    }
  }

  std::string Refusal(const fs::path& file, const Vector3d& scale = kOne) {
    try {
      LoadMeshFile(file, scale);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
      return error.what();
    }
    return "accepted";
  }

  const test::TempFolder folder_;
  const Vector3d size_{0.1, 0.2, 0.3};
};

TEST_F(MeshFileTest, EveryFormatReadsBackTheWrittenMesh) {
  const Mesh solid = Tetrahedron();
  test::WriteStlText(File("a.stl"), solid);
  test::WriteStlBinary(File("b.STL"), solid);
  test::WriteObj(File("c.obj"), solid, /*normals=*/false);
  test::WriteDae(File("d.dae"), solid, "<up_axis>Z_UP</up_axis>");
  ExpectTetrahedron(LoadMeshFile(File("a.stl"), kOne), size_, kGrey, "STL, text");
  ExpectTetrahedron(LoadMeshFile(File("b.STL"), kOne), size_, kGrey, "STL, binary");
  ExpectTetrahedron(LoadMeshFile(File("c.obj"), kOne), size_, kGrey, "OBJ");
  ExpectTetrahedron(LoadMeshFile(File("d.dae"), kOne), size_, kRed, "DAE");
}

TEST_F(MeshFileTest, ScaleStretchesAndMirrorsWithoutTurningTheSurfaceInsideOut) {
  test::WriteStlBinary(File("a.stl"), Tetrahedron());
  for (const Vector3d& scale :
       {Vector3d(0.001, 0.001, 0.001), Vector3d(1.0, 2.0, 0.5), Vector3d(1.0, -1.0, 1.0)}) {
    ExpectTetrahedron(LoadMeshFile(File("a.stl"), scale), size_.cwiseProduct(scale), kGrey, "scaled");
  }
}

// As in ROS's viewers: coordinates unchanged, lengths in the file's unit.
TEST_F(MeshFileTest, ColladaUsesItsUnitAndIgnoresItsUpAxis) {
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    const std::string axis = std::string("<up_axis>") + up + "</up_axis>";
    test::WriteDae(File("a.dae"), Tetrahedron(), axis);
    ExpectTetrahedron(LoadMeshFile(File("a.dae"), kOne), size_, kRed, up);
    test::WriteDae(File("a.dae"), Tetrahedron(), "<unit meter=\"0.01\" name=\"centimeter\"/>" + axis);
    ExpectTetrahedron(LoadMeshFile(File("a.dae"), kOne), 0.01 * size_, kRed, std::string(up) + " in cm");
  }
  // A node that rotates x to y and y to -x, and mirrors z.
  test::WriteDae(File("a.dae"), Tetrahedron(), "<up_axis>Z_UP</up_axis>",
                 "0 -1 0 0 1 0 0 0 0 0 -1 0 0 0 0 1");
  ExpectTetrahedron(LoadMeshFile(File("a.dae"), kOne), {-0.2, 0.1, -0.3}, kRed, "turned node");
}

TEST_F(MeshFileTest, NormalsComeFromTheFileOrKeepSharpEdges) {
  const Mesh ball = MakeSphere(0.1F, 24, kGrey);
  // Compared with the ball's own normals, at all triangles except the degenerate ones at the poles.
  const auto worst = [](const Mesh& mesh) {
    float off = 0.0F;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      const Vertex* v[3] = {&mesh.vertices[mesh.indices[t]], &mesh.vertices[mesh.indices[t + 1]],
                            &mesh.vertices[mesh.indices[t + 2]]};
      if ((v[1]->position - v[0]->position).cross(v[2]->position - v[0]->position).norm() > 1e-7F) {
        for (const Vertex* corner : v) {
          off = std::max(off, (corner->normal - corner->position.normalized()).norm());
        }
      }
    }
    return off;
  };
  test::WriteObj(File("own.obj"), ball, /*normals=*/true);
  test::WriteObj(File("made.obj"), ball, /*normals=*/false);
  test::WriteStlBinary(File("flat.stl"), ball);
  const float own = worst(LoadMeshFile(File("own.obj"), kOne));
  const float made = worst(LoadMeshFile(File("made.obj"), kOne));
  const float flat = worst(LoadMeshFile(File("flat.stl"), kOne));
  std::cout << "a ball's normals off by " << own << " from the file, " << made << " if computed, " << flat
            << " from STL, which has flat faces\n";
  EXPECT_LT(own, 1e-4F);
  EXPECT_LT(made, 0.06F);
  EXPECT_GT(flat, 0.1F);
}

TEST_F(MeshFileTest, ObjMaterialsColourTheirParts) {
  std::ofstream(File("c.mtl")) << "newmtl blue\nKd 0.1 0.2 0.9\n";
  test::WriteObj(File("c.obj"), Tetrahedron(), false, "mtllib c.mtl\nusemtl blue");
  ExpectTetrahedron(LoadMeshFile(File("c.obj"), kOne), size_, {0.1F, 0.2F, 0.9F}, "OBJ with material");
}

// With an allowed folder, no materials are read from outside it. Device files are never read.
TEST_F(MeshFileTest, ObjMaterialsAreReadOnlyFromTheAllowedFolder) {
  fs::create_directory(File("own"));
  std::ofstream(File("paint.mtl")) << "newmtl blue\nKd 0.1 0.2 0.9\n";
  fs::copy_file(File("paint.mtl"), File("own/paint.mtl"));
  fs::create_symlink(File("paint.mtl"), File("own/linked.mtl"));
  const Vector3f blue(0.1F, 0.2F, 0.9F);
  struct Case {
    const char* materials;
    bool confined;
    Vector3f colour;
  };
  // assimp's default colour for a material with only a name.
  const Vector3f unknown(0.6F, 0.6F, 0.6F);
  for (const Case& c : {Case{"paint.mtl", true, blue}, Case{"../own/paint.mtl", true, blue},
                        Case{"../paint.mtl", true, unknown}, Case{"linked.mtl", true, unknown},
                        Case{"../paint.mtl", false, blue}, Case{"/dev/zero", false, unknown},
                        Case{"/dev/zero", true, unknown}}) {
    test::WriteObj(File("own/c.obj"), Tetrahedron(), false,
                   std::string("mtllib ") + c.materials + "\nusemtl blue");
    const Mesh mesh = LoadMeshFile(File("own/c.obj"), kOne, c.confined ? File("own") : fs::path());
    ExpectTetrahedron(mesh, size_, c.colour, c.materials);
  }
}

TEST_F(MeshFileTest, UnusableFileIsRefusedWithTheReason) {
  const Mesh solid = Tetrahedron();
  test::WriteStlBinary(File("good.stl"), solid);
  EXPECT_EQ(Refusal(File("good.stl")), "accepted");
  EXPECT_THAT(Refusal(File("good.ply")), AllOf(HasSubstr("\".ply\""), HasSubstr(".stl, .dae and .obj")));
  EXPECT_THAT(Refusal(File("good")), HasSubstr(".stl, .dae and .obj"));
  EXPECT_THAT(Refusal(File("good.stl"), {1.0, 0.0, 1.0}), HasSubstr("scale = 1 0 1 is not allowed"));
  EXPECT_THAT(Refusal(File("good.stl"), {1.0, std::nan(""), 1.0}), HasSubstr("is not allowed"));
  for (const char* name : {"empty.stl", "empty.obj", "empty.dae"}) {
    std::ofstream(File(name)).flush();
    EXPECT_THAT(Refusal(File(name)), HasSubstr("cannot be read")) << name;
    std::ofstream(File(name))
        << "this is no mesh at all, only words, and more words until it is long enough for "
           "every header that a reader might want to see before it gives up";
    EXPECT_NE(Refusal(File(name)), "accepted") << name;
  }
  test::WriteStlText(File("none.stl"), Mesh{});
  EXPECT_NE(Refusal(File("none.stl")), "accepted");
  Mesh points = solid;
  points.indices.clear();
  test::WriteObj(File("points.obj"), points, false);
  EXPECT_NE(Refusal(File("points.obj")), "accepted");
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Mesh broken = solid;
    broken.vertices[2].position.y() = bad;
    test::WriteStlBinary(File("broken.stl"), broken);
    EXPECT_THAT(Refusal(File("broken.stl")), HasSubstr("not a finite number"));
  }
  EXPECT_THAT(Refusal(File("good.stl"), {1e300, 1.0, 1.0}), HasSubstr("not a finite number"));
}

// assimp's reader hangs on such a list.
TEST_F(MeshFileTest, ColladaListWithNonNumbersIsRefused) {
  test::WriteDae(File("a.dae"), Tetrahedron(), "<up_axis>Z_UP</up_axis>");
  std::ostringstream good;
  good << std::ifstream(File("a.dae")).rdbuf();
  EXPECT_EQ(Refusal(File("a.dae")), "accepted");
  for (const char* bad : {"<p>x", "<p>1 2 ; ", "<p>0.5 "}) {
    std::string text = good.str();
    text.replace(text.find("<p>"), 3, bad);
    std::ofstream(File("a.dae")) << text;
    EXPECT_THAT(Refusal(File("a.dae")), AllOf(HasSubstr("<p>"), HasSubstr("only whole numbers")));
  }
}

TEST_F(MeshFileTest, MoreTrianglesThanCanBeDrawnAreRefused) {
  Mesh many = Tetrahedron();
  many.indices.reserve(3 * (kMostMeshTriangles + 4));
  while (many.num_triangles() <= kMostMeshTriangles) {
    many.indices.insert(many.indices.end(), {0, 2, 1});
  }
  test::WriteStlBinary(File("many.stl"), many);
  EXPECT_THAT(Refusal(File("many.stl")), HasSubstr("more than 1000000 triangles"));
}

TEST_F(MeshFileTest, PackagesAreFoundAboveTheUrdfAndInTheEnvironment) {
  const auto make = [&](const std::string& name) {
    fs::create_directories(File(name).parent_path());
    test::WriteStlBinary(File(name), Tetrahedron());
    return File(name);
  };
  const fs::path own = make("ws/arm_description/meshes/a.stl");
  const fs::path beside = make("ws/hand_description/meshes/h.stl");
  const fs::path ros = make("ros/tool_description/t.stl");
  const fs::path ament = make("install/share/gripper/g.stl");
  const fs::path urdf = File("ws/arm_description/urdf/arm.urdf");
  fs::create_directories(urdf.parent_path());
  EXPECT_EQ(FindMeshFile(urdf, "package://arm_description/meshes/a.stl"), own);
  EXPECT_EQ(FindMeshFile(urdf, "package://hand_description/meshes/h.stl"), beside);
  EXPECT_TRUE(fs::equivalent(FindMeshFile(urdf, "../meshes/a.stl"), own));
  EXPECT_EQ(FindMeshFile(urdf, own.string()), own);
  EXPECT_EQ(FindMeshFile(urdf, "file://" + own.string()), own);

  const auto refusal = [&](const std::string& name) -> std::string {
    try {
      FindMeshFile(urdf, name);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "found";
  };
  EXPECT_THAT(refusal("package://tool_description/t.stl"),
              AllOf(HasSubstr("package \"tool_description\""), HasSubstr(urdf.parent_path().string()),
                    HasSubstr("ROS_PACKAGE_PATH"), HasSubstr("AMENT_PREFIX_PATH")));
  setenv("ROS_PACKAGE_PATH", (File("nowhere").string() + ":" + File("ros").string()).c_str(), 1);
  setenv("AMENT_PREFIX_PATH", File("install").c_str(), 1);
  EXPECT_EQ(FindMeshFile(urdf, "package://tool_description/t.stl"), ros);
  EXPECT_EQ(FindMeshFile(urdf, "package://gripper/g.stl"), ament);
  unsetenv("ROS_PACKAGE_PATH");
  unsetenv("AMENT_PREFIX_PATH");

  EXPECT_THAT(refusal("package://arm_description/meshes/gone.stl"),
              HasSubstr("no such file: " + File("ws/arm_description/meshes/gone.stl").string()));
  EXPECT_THAT(refusal("gone.stl"),
              HasSubstr("no such file: " + File("ws/arm_description/urdf/gone.stl").string()));
  EXPECT_THAT(refusal("package://arm_description"), HasSubstr("package://name/path"));
  EXPECT_THAT(refusal("file://meshes/a.stl"), HasSubstr("file:///absolute/path"));
  EXPECT_THAT(refusal("http://somewhere/a.stl"), HasSubstr("only package:// and file://"));
  EXPECT_THAT(refusal(File("ws").string()), HasSubstr("no such file"));
}

// The hull has fewer points: all corners of a box, and points that nearly reach a ball's surface.
TEST(HullPointsTest, KeepsBoxCornersAndStaysCloseToABall) {
  const std::vector<Vector3d> box = HullPoints(MakeBox({0.2F, 0.3F, 0.4F}, 0.0F, kGrey));
  EXPECT_EQ(box.size(), 8U);
  for (const Vector3d& p : box) {
    EXPECT_LT((p.cwiseAbs() - Vector3d(0.1, 0.15, 0.2)).cwiseAbs().maxCoeff(), 1e-7);
  }
  const std::vector<Vector3d> ball = HullPoints(MakeSphere(1.0F, 400, kGrey));
  double worst = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d direction = Vector3d::Random().normalized();
    double reach = 0.0;
    for (const Vector3d& p : ball) {
      reach = std::max(reach, p.dot(direction));
    }
    worst = std::max(worst, 1.0 - reach);
  }
  std::cout << ball.size() << " points of a ball; missing at most " << 100.0 * worst << " % of its radius\n";
  EXPECT_LT(worst, 0.01);
}

TEST(SimplifyTest, DenseMeshKeepsItsShadowWithFewTriangles) {
  const Mesh dense = MakeSphere(0.06F, 300, kGrey);
  const Mesh simple = Simplify(dense, 0.004F);
  double worst = 0.0;
  for (const Vertex& v : simple.vertices) {
    worst = std::max(worst, std::fabs(static_cast<double>(v.position.norm()) - 0.06));
  }
  std::cout << dense.num_triangles() << " triangles become " << simple.num_triangles() << ", off by "
            << 1e3 * worst << " mm\n";
  EXPECT_LT(simple.num_triangles(), dense.num_triangles() / 10);
  EXPECT_LT(worst, 1e-3);
}

}  // namespace
}  // namespace fovea::sim
