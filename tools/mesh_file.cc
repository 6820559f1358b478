// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tools/error.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::string extension(const std::string& path) {
  std::string ext = fs::path(path).extension().string();
  std::transform(ext.begin(), ext.end(), ext.begin(), [](unsigned char c) { return tolower(c); });
  return ext;
}

// Damage that assimp 5.2 does not tell of: triangles missing at the end of an STL, vertices or
// faces at the end of an ASCII PLY; and a PLY without the end of its header, which it reads
// forever.
void checkWhole(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  const std::string bytes = content.str();
  const auto cutShort = [&](const std::string& why) {
    throw Error(fmt::format("{}: the file is cut short ({}); copy or export it again", path, why));
  };
  if (extension(path) == ".ply") {
    const std::size_t header = bytes.find("end_header");
    if (header == std::string::npos) cutShort("its header has no end_header");
    if (bytes.find("format ascii") > header) return;
    // A line for each element.
    long elements = 0;
    for (std::size_t at = bytes.find("element "); at < header;
         at = bytes.find("element ", at + 1)) {
      elements += std::strtol(bytes.c_str() + bytes.find(' ', at + 8), nullptr, 10);
    }
    long lines = std::count(bytes.begin() + static_cast<long>(header), bytes.end(), '\n') - 1;
    if (bytes.back() != '\n') lines++;
    if (lines < elements) cutShort(fmt::format("{} elements of {}", lines, elements));
    return;
  }
  if (bytes.rfind("solid", 0) == 0 && bytes.find("facet") != std::string::npos) {
    if (bytes.find("endsolid") == std::string::npos) cutShort("no endsolid");
    return;
  }
  if (bytes.size() < 84) cutShort("no whole header");
  std::uint32_t count;
  std::copy_n(bytes.data() + 80, 4, reinterpret_cast<char*>(&count));
  if ((bytes.size() - 84) / 50 < count) {
    cutShort(fmt::format("{} triangles of {}", (bytes.size() - 84) / 50, count));
  }
}

void addNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent,
             const std::string& path, std::vector<NamedMesh>* out) {
  const aiMatrix4x4 X = parent * node.mTransformation;
  for (unsigned k = 0; k < node.mNumMeshes; k++) {
    const aiMesh& m = *scene.mMeshes[node.mMeshes[k]];
    NamedMesh object;
    object.file = path;
    object.name = m.mName.length > 0 ? m.mName.C_Str() : node.mName.C_Str();
    for (unsigned i = 0; i < m.mNumVertices; i++) {
      const aiVector3D v = X * m.mVertices[i];
      object.mesh.vertices.emplace_back(v.x, v.y, v.z);
    }
    for (unsigned i = 0; i < m.mNumFaces; i++) {
      const aiFace& f = m.mFaces[i];
      if (f.mNumIndices != 3) continue;  // points and lines
      object.mesh.faces.push_back({static_cast<int>(f.mIndices[0]), static_cast<int>(f.mIndices[1]),
                                   static_cast<int>(f.mIndices[2])});
    }
    if (!object.mesh.faces.empty()) out->push_back(object);
  }
  for (unsigned k = 0; k < node.mNumChildren; k++) {
    addNode(scene, *node.mChildren[k], X, path, out);
  }
}

std::vector<NamedMesh> readAssimp(const std::string& path) {
  if (extension(path) == ".stl" || extension(path) == ".ply") checkWhole(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (!scene || !scene->mRootNode) {
    throw Error(fmt::format("{}: cannot be read as a mesh: {}", path, importer.GetErrorString()));
  }
  std::vector<NamedMesh> out;
  addNode(*scene, *scene->mRootNode, aiMatrix4x4(), path, &out);
  return out;
}

class VtpReader {
 public:
  explicit VtpReader(const std::string& path) : path_(path) {}

  NamedMesh read() {
    tinyxml2::XMLDocument document;
    if (document.LoadFile(path_.c_str()) != tinyxml2::XML_SUCCESS) {
      throw Error(fmt::format("{}: line {}: not whole XML ({}); copy or export it again", path_,
                              document.ErrorLineNum(), document.ErrorName()));
    }
    const tinyxml2::XMLElement* piece = tinyxml2::XMLHandle(document.FirstChildElement("VTKFile"))
                                            .FirstChildElement("PolyData")
                                            .FirstChildElement("Piece")
                                            .ToElement();
    if (!piece) throw Error(path_ + ": no VTKFile/PolyData/Piece; only VTK PolyData can be read");
    NamedMesh out;
    out.file = path_;
    const std::vector<double> xyz = numbers(piece, "Points", nullptr);
    const auto count = static_cast<std::size_t>(piece->IntAttribute("NumberOfPoints"));
    if (xyz.size() != 3 * count) {
      throw Error(
          fmt::format("{}: Points: {} numbers instead of 3 x {}; the file is cut short or "
                      "damaged",
                      path_, xyz.size(), count));
    }
    for (std::size_t i = 0; i < count; i++) {
      out.mesh.vertices.emplace_back(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]);
    }
    addPolygons(piece, &out.mesh);
    return out;
  }

 private:
  // The numbers of a DataArray, by name; the first if name is null.
  std::vector<double> numbers(const tinyxml2::XMLElement* piece, const char* section,
                              const char* name) {
    const tinyxml2::XMLElement* parent = piece->FirstChildElement(section);
    const tinyxml2::XMLElement* array = parent ? parent->FirstChildElement("DataArray") : nullptr;
    while (array && name && !array->Attribute("Name", name)) {
      array = array->NextSiblingElement("DataArray");
    }
    const std::string what = std::string(section) + (name ? std::string(" ") + name : "");
    if (!array) throw Error(fmt::format("{}: no DataArray for {}", path_, what));
    const char* format = array->Attribute("format");
    if (!format || std::string(format) != "ascii") {
      throw Error(fmt::format("{}: line {}: {} is not in ASCII; save the file with ASCII data",
                              path_, array->GetLineNum(), what));
    }
    std::vector<double> values;
    const char* text = array->GetText() ? array->GetText() : "";
    for (;;) {
      while (*text && std::isspace(static_cast<unsigned char>(*text))) text++;
      if (!*text) return values;
      char* end;
      values.push_back(std::strtod(text, &end));
      if (end == text) {
        throw Error(fmt::format("{}: line {}: {}: '{}' is not a number", path_, array->GetLineNum(),
                                what, std::string(text).substr(0, 12)));
      }
      text = end;
    }
  }

  void addPolygons(const tinyxml2::XMLElement* piece, TriMesh* mesh) {
    const std::vector<double> connectivity = numbers(piece, "Polys", "connectivity");
    const std::vector<double> offsets = numbers(piece, "Polys", "offsets");
    if (offsets.size() != static_cast<std::size_t>(piece->IntAttribute("NumberOfPolys"))) {
      throw Error(fmt::format("{}: Polys offsets: {} instead of {}; the file is cut short", path_,
                              offsets.size(), piece->IntAttribute("NumberOfPolys")));
    }
    for (double index : connectivity) {
      if (!(index >= 0 && index < static_cast<double>(mesh->vertices.size()))) {
        throw Error(fmt::format("{}: Polys connectivity: there is no point {}", path_, index));
      }
    }
    double start = 0;
    for (double end : offsets) {
      if (!(end >= start && end <= static_cast<double>(connectivity.size()))) {
        throw Error(fmt::format("{}: Polys offsets: {} is out of order", path_, end));
      }
      const auto first = static_cast<std::size_t>(start), last = static_cast<std::size_t>(end);
      for (std::size_t k = first + 2; k < last; k++) {
        mesh->faces.push_back({static_cast<int>(connectivity[first]),
                               static_cast<int>(connectivity[k - 1]),
                               static_cast<int>(connectivity[k])});
      }
      start = end;
    }
  }

  std::string path_;
};

}  // namespace

bool isMeshFile(const std::string& path) {
  const std::string ext = extension(path);
  if (ext == ".vtp") return true;
  return ext.size() > 1 && ext != ".xml" && Assimp::Importer().IsExtensionSupported(ext);
}

std::vector<NamedMesh> readMeshFile(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || !std::ifstream(path)) {
    throw Error(path + ": cannot be opened");
  }
  std::vector<NamedMesh> objects;
  if (extension(path) == ".vtp") {
    objects.push_back(VtpReader(path).read());
  } else {
    objects = readAssimp(path);
  }
  bool any = false;
  for (const NamedMesh& object : objects) {
    any = any || !object.mesh.faces.empty();
    for (std::size_t i = 0; i < object.mesh.vertices.size(); i++) {
      if (object.mesh.vertices[i].allFinite()) continue;
      throw Error(fmt::format("{}: vertex {}{} is not a finite number; export the mesh again", path,
                              i, object.name.empty() ? "" : " of " + object.name));
    }
  }
  if (!any) throw Error(path + ": holds no triangles");
  return objects;
}

}  // namespace torso::tools
