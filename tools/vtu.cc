// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/vtu.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cstdint>
#include <cstring>
#include <string_view>

#include "model/disc_field.h"
#include "tools/disc_data.h"

namespace torso::tools {
namespace {

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; k++) {
      group = group << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; k++) {
      text += k <= n ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

class Writer {
 public:
  explicit Writer(const char* type) {
    xml_.PushHeader(false, true);
    open("VTKFile", {{"type", type},
                     {"version", "1.0"},
                     {"byte_order", "LittleEndian"},
                     {"header_type", "UInt32"}});
  }

  using Attributes = std::vector<std::pair<const char*, std::string>>;
  void open(const char* element, const Attributes& attributes = {}) {
    xml_.OpenElement(element);
    for (const auto& [name, value] : attributes) xml_.PushAttribute(name, value.c_str());
  }
  void close() { xml_.CloseElement(); }
  void comment(const std::string& text) { xml_.PushComment(text.c_str()); }

  // T: float, std::int32_t or std::uint8_t
  template <typename T>
  void array(const char* name, int components, const std::vector<T>& values) {
    const char* type = std::is_same_v<T, float>          ? "Float32"
                       : std::is_same_v<T, std::int32_t> ? "Int32"
                                                         : "UInt8";
    open("DataArray", {{"type", type},
                       {"Name", name},
                       {"NumberOfComponents", std::to_string(components)},
                       {"format", "binary"}});
    // The number of bytes comes before them.
    const std::uint32_t size = static_cast<std::uint32_t>(values.size() * sizeof(T));
    std::string bytes(sizeof(size) + size, '\0');
    std::memcpy(bytes.data(), &size, sizeof(size));
    if (size) std::memcpy(bytes.data() + sizeof(size), values.data(), size);
    xml_.PushText(base64(bytes).c_str());
    close();
  }

  std::string text() {
    close();
    return xml_.CStr();
  }

 private:
  tinyxml2::XMLPrinter xml_;
};

template <typename Matrix>
void append(std::vector<float>* array, const Matrix& values) {
  for (int i = 0; i < values.size(); i++) array->push_back(static_cast<float>(values(i)));
}

}  // namespace

std::string vtu(const mjModel* m, const mjData* d) {
  std::vector<float> points, displacement, stress, pressures, mises, stretch;
  std::vector<std::int32_t> connectivity, offsets, disc_index;
  std::vector<std::uint8_t> types, region;
  constexpr std::uint8_t kTetra = 10;  // VTK_TETRA
  std::string names;
  std::int32_t first = 0, index = 0;
  for (const DiscData& disc : discData(m, d)) {
    for (std::size_t i = 0; i < disc.nodes.size(); i++) {
      append(&points, disc.nodes[i]);
      append(&displacement, (disc.nodes[i] - disc.origin - disc.axes * disc.rest[i]).eval());
    }
    for (std::size_t e = 0; e < disc.tets.size(); e++) {
      for (int node : disc.tets[e]) connectivity.push_back(first + node);
      offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
      types.push_back(kTetra);
      append(&stress, disc.stress[e]);
      pressures.push_back(static_cast<float>(pressure(disc.stress[e])));
      mises.push_back(static_cast<float>(vonMises(disc.stress[e])));
      append(&stretch, disc.fibre_stretch[e]);
      region.push_back(disc.cells[e] < 0 ? 0 : 1);
      disc_index.push_back(index);
    }
    first += static_cast<std::int32_t>(disc.nodes.size());
    names += fmt::format("{}{} {}", index ? ", " : "", index, disc.name);
    index++;
  }
  // XML forbids two hyphens in a comment.
  for (std::size_t i; (i = names.find("--")) != std::string::npos;) names.replace(i, 2, "-");

  Writer out("UnstructuredGrid");
  out.comment(
      fmt::format(" time {:.9g} s; units m and Pa, world frame; discs: {} ", d->time, names));
  out.open("UnstructuredGrid");
  out.open("Piece", {{"NumberOfPoints", std::to_string(points.size() / 3)},
                     {"NumberOfCells", std::to_string(types.size())}});
  out.open("PointData", {{"Vectors", "displacement"}});
  out.array("displacement", 3, displacement);
  out.close();
  out.open("CellData", {{"Scalars", "pressure"}, {"Tensors", "stress"}});
  out.array("stress", 9, stress);
  out.array("pressure", 1, pressures);
  out.array("von_mises", 1, mises);
  out.array("fibre_stretch", 2, stretch);
  out.array("region", 1, region);
  out.array("disc", 1, disc_index);
  out.close();
  out.open("Points");
  out.array("Points", 3, points);
  out.close();
  out.open("Cells");
  out.array("connectivity", 1, connectivity);
  out.array("offsets", 1, offsets);
  out.array("types", 1, types);
  out.close();
  out.close();
  out.close();
  return out.text();
}

std::string pvd(const std::vector<std::pair<double, std::string>>& files) {
  Writer out("Collection");
  out.open("Collection");
  for (const auto& [time, file] : files) {
    out.open("DataSet", {{"timestep", fmt::format("{:.9g}", time)}, {"part", "0"}, {"file", file}});
    out.close();
  }
  out.close();
  return out.text();
}

}  // namespace torso::tools
