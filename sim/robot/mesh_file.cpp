// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/mesh_file.hpp"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/DefaultIOSystem.h>
#include <Eigen/LU>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/robot/mesh_path.hpp"

namespace fovea::sim {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3f kGrey(0.7F, 0.7F, 0.7F);
constexpr float kSmoothBelowDeg = 40.0F;  // an edge with a larger angle is sharp

[[noreturn]] void Fail(const std::string& what) { throw std::runtime_error(what); }

std::string LowerExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// The first line of the importer's message.
std::string OneLine(const std::string& text) { return text.substr(0, text.find('\n')); }

// Collada's index lists may hold only whole numbers. Anything else makes assimp's reader loop forever.
void CheckColladaLists(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string text = content.str();
  for (const std::string name : {"p", "vcount", "v", "h"}) {
    for (auto at = text.find("<" + name); at != std::string::npos; at = text.find("<" + name, at + 1)) {
      const auto after_name = at + 1 + name.size();
      const auto begin = text.find('>', at);
      const bool is_other =
          after_name < text.size() && std::string("> \t\r\n").find(text[after_name]) == std::string::npos;
      if (begin == std::string::npos || is_other || text[begin - 1] == '/') {
        continue;
      }
      const auto wrong = text.find_first_not_of("0123456789+- \t\r\n", begin + 1);
      if (wrong != std::string::npos && text[wrong] != '<') {
        Fail(fmt::format("cannot be read: <{}> may hold only whole numbers; byte {} is not part of one", name,
                         wrong));
      }
    }
  }
}

Vector3d ToVector(const aiVector3D& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

Eigen::Affine3d ToAffine(const aiMatrix4x4& m) {
  Eigen::Affine3d A;
  A.matrix() = Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>>(&m.a1).cast<double>();
  return A;
}

Vector3f ColourOf(const aiMaterial& material) {
  aiString name;
  aiColor3D colour;
  // Ignores the default material that the importer adds if a file has none.
  if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS &&
      std::string(name.C_Str()) == AI_DEFAULT_MATERIAL_NAME) {
    return kGrey;
  }
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) != aiReturn_SUCCESS) {
    return kGrey;
  }
  const Vector3f rgb(colour.r, colour.g, colour.b);
  return rgb.allFinite() ? rgb.cwiseMax(0.0F).cwiseMin(1.0F) : kGrey;
}

// Opens only regular files, no devices; outside `root_` only `file_`.
class OwnFiles final : public Assimp::DefaultIOSystem {
 public:
  OwnFiles(std::filesystem::path file, std::filesystem::path root)
      : file_(std::move(file)), root_(std::move(root)) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    std::error_code ignored;
    const bool may = std::filesystem::is_regular_file(file, ignored) &&
                     (root_.empty() || file == file_ || LiesIn(root_, file));
    return may ? Assimp::DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  std::filesystem::path file_;
  std::filesystem::path root_;
};

// Puts the parts of a file into one mesh.
class Collector {
 public:
  explicit Collector(const aiScene& scene) : scene_(scene) {}

  void Add(const aiNode& node, const Eigen::Affine3d& X_parent) {
    const Eigen::Affine3d X = X_parent * ToAffine(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      AddPart(*scene_.mMeshes[node.mMeshes[i]], X);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      Add(*node.mChildren[i], X);
    }
  }

  Mesh Take() && { return std::move(mesh_); }

 private:
  void AddPart(const aiMesh& part, const Eigen::Affine3d& X) {
    if (mesh_.num_triangles() + part.mNumFaces > kMostMeshTriangles) {
      Fail(fmt::format("more than {} triangles", kMostMeshTriangles));
    }
    const Vector3f colour = ColourOf(*scene_.mMaterials[part.mMaterialIndex]);
    const double turn = X.linear().determinant() < 0.0 ? -1.0 : 1.0;  // mirroring reverses the triangles
    // Normals use the cofactor matrix: they stay perpendicular to their surface under any scaling.
    const Eigen::Matrix3d cofactors = Cofactors(X.linear()) * turn;
    const auto base = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const Vector3f position = (X * ToVector(part.mVertices[i])).cast<float>();
      if (!position.allFinite()) {
        Fail("a coordinate is not a finite number");
      }
      const Vector3d normal = part.HasNormals() ? ToVector(part.mNormals[i]) : Vector3d::Zero();
      mesh_.vertices.push_back({position, Unit(cofactors * normal), colour});
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) {
        continue;
      }
      const std::uint32_t a = base + face.mIndices[0];
      const std::uint32_t b = base + face.mIndices[1];
      const std::uint32_t c = base + face.mIndices[2];
      mesh_.indices.insert(mesh_.indices.end(), {a, turn > 0.0 ? b : c, turn > 0.0 ? c : b});
    }
    MakeMissingNormals(base);
  }

  static Eigen::Matrix3d Cofactors(const Eigen::Matrix3d& A) {
    Eigen::Matrix3d cofactors;
    cofactors << A.col(1).cross(A.col(2)), A.col(2).cross(A.col(0)), A.col(0).cross(A.col(1));
    return cofactors;
  }

  static Vector3f Unit(const Vector3d& v) {
    const double length = v.norm();
    return length > 0.0 && std::isfinite(length) ? Vector3f((v / length).cast<float>()) : Vector3f::Zero();
  }

  // Replaces normals of length 0, which some files have, by the mean of the adjacent triangles' normals.
  void MakeMissingNormals(std::uint32_t base) {
    const auto missing = [this](std::uint32_t i) { return mesh_.vertices[i].normal.squaredNorm() < 0.5F; };
    std::vector<Vector3d> sums(mesh_.vertices.size() - base, Vector3d::Zero());
    for (std::size_t t = 0; t < mesh_.indices.size(); t += 3) {
      const std::uint32_t* corner = &mesh_.indices[t];
      if (corner[0] < base) {
        continue;  // belongs to an earlier part
      }
      const Vector3d a = mesh_.vertices[corner[0]].position.cast<double>();
      const Vector3d b = mesh_.vertices[corner[1]].position.cast<double>();
      const Vector3d c = mesh_.vertices[corner[2]].position.cast<double>();
      for (int k = 0; k < 3; ++k) {
        sums[corner[k] - base] += (b - a).cross(c - a);
      }
    }
    for (std::uint32_t i = base; i < mesh_.vertices.size(); ++i) {
      if (missing(i)) {
        const Vector3f normal = Unit(sums[i - base]);
        mesh_.vertices[i].normal = normal.isZero() ? Vector3f(Vector3f::UnitZ()) : normal;
      }
    }
  }

  const aiScene& scene_;
  Mesh mesh_;
};

}  // namespace

Mesh LoadMeshFile(const std::filesystem::path& file, const Vector3d& scale,
                  const std::filesystem::path& root) {
  const std::string extension = LowerExtension(file);
  if (extension != ".stl" && extension != ".dae" && extension != ".obj") {
    Fail(fmt::format("\"{}\" is not supported; mesh formats are .stl, .dae and .obj", extension));
  }
  if (!scale.allFinite() || (scale.array() == 0.0).any()) {
    Fail(fmt::format("scale = {} {} {} is not allowed: finite numbers other than 0", scale.x(), scale.y(),
                     scale.z()));
  }
  if (extension == ".dae") {
    CheckColladaLists(file);
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new OwnFiles(file, root));  // the importer deletes it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSmoothBelowDeg);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const unsigned normals =
      extension == ".stl" ? aiProcess_GenNormals | aiProcess_ForceGenNormals : aiProcess_GenSmoothNormals;
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType | normals |
                                           aiProcess_JoinIdenticalVertices | aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    Fail(fmt::format("cannot be read: {}", OneLine(importer.GetErrorString())));
  }
  Collector collector(*scene);
  collector.Add(*scene->mRootNode, Eigen::Affine3d(Eigen::Scaling(scale)));
  Mesh mesh = std::move(collector).Take();
  if (mesh.indices.empty()) {
    Fail("the file has no triangles");
  }
  return mesh;
}

}  // namespace fovea::sim
