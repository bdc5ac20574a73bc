// SPDX-License-Identifier: Apache-2.0
// Writes a mesh in the formats that a URDF may name, for tests to read back.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::test {

inline void WriteStlText(const std::filesystem::path& file, const sim::Mesh& mesh) {
  std::ofstream out(file);
  out.precision(9);
  out << "solid test\n";
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    out << "facet normal 0 0 0\n outer loop\n";  // many programs write no normals
    for (std::size_t k = 0; k < 3; ++k) {
      out << "  vertex " << mesh.vertices[mesh.indices[t + k]].position.transpose() << "\n";
    }
    out << " endloop\nendfacet\n";
  }
  out << "endsolid test\n";
}

inline void WriteStlBinary(const std::filesystem::path& file, const sim::Mesh& mesh) {
  std::ofstream out(file, std::ios::binary);
  const auto put = [&out](const auto& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  const char head[80] = "made by a test";
  out.write(head, sizeof(head));
  put(static_cast<std::uint32_t>(mesh.num_triangles()));
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (int i = 0; i < 3; ++i) {
      put(0.0F);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& p = mesh.vertices[mesh.indices[t + k]].position;
      put(p.x());
      put(p.y());
      put(p.z());
    }
    put(std::uint16_t{0});
  }
}

// `normals`: also writes the mesh's normals. `material`: a line "usemtl <name>" and its library, or "".
inline void WriteObj(const std::filesystem::path& file, const sim::Mesh& mesh, bool normals,
                     const std::string& material = "") {
  std::ofstream out(file);
  out.precision(9);
  if (!material.empty()) {
    out << material << "\n";
  }
  for (const sim::Vertex& v : mesh.vertices) {
    out << "v " << v.position.transpose() << "\n";
    if (normals) {
      out << "vn " << v.normal.transpose() << "\n";
    }
  }
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    out << "f";
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = std::to_string(mesh.indices[t + k] + 1);
      out << " " << i << (normals ? "//" + i : "");
    }
    out << "\n";
  }
}

// Writes one red node with `matrix` (row by row). `asset`: the content of <asset>.
inline void WriteDae(const std::filesystem::path& file, const sim::Mesh& mesh, const std::string& asset,
                     const std::string& matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1") {
  std::ofstream out(file);
  out.precision(9);
  out << R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)"
      << asset << R"(</asset>
<library_effects><effect id="fx"><profile_COMMON><technique sid="common"><lambert>
<diffuse><color>0.8 0.1 0.2 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="red" name="red"><instance_effect url="#fx"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count=")"
      << 3 * mesh.vertices.size() << "\">";
  for (const sim::Vertex& v : mesh.vertices) {
    out << v.position.transpose() << " ";
  }
  out << "</float_array><technique_common><accessor source=\"#pa\" count=\"" << mesh.vertices.size()
      << R"(" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="m" count=")"
      << mesh.num_triangles() << R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)";
  for (const std::uint32_t i : mesh.indices) {
    out << i << " ";
  }
  out << "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene "
         "id=\"s\">"
      << "<node id=\"n\"><matrix>" << matrix << R"(</matrix><instance_geometry url="#g"><bind_material>
<technique_common><instance_material symbol="m" target="#red"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

}  // namespace fovea::test
