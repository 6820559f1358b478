// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/mesh_repair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <sstream>
#include <stdexcept>

namespace torso {
namespace {

using Eigen::Vector3d;
using Face = std::array<int, 3>;

constexpr double kWeld = 1e-6;       // of the size
constexpr double kStrayArea = 0.02;  // of the surface
constexpr double kHole = 0.8;        // length of its border, of the size

std::string place(const Vector3d& p) {
  std::ostringstream text;
  text.precision(4);
  text << "(" << p.x() << ", " << p.y() << ", " << p.z() << ")";
  return text.str();
}

double area(const TriMesh& m, const Face& f) {
  const Vector3d &a = m.vertices[f[0]], &b = m.vertices[f[1]], &c = m.vertices[f[2]];
  return (b - a).cross(c - a).norm() / 2;
}

// Vertices joined that fall into one cell of a fine grid, or into neighbouring ones.
TriMesh welded(const TriMesh& mesh, double distance) {
  using Cell = std::array<long, 3>;
  std::map<Cell, std::vector<int>> cells;
  TriMesh out;
  std::vector<int> renamed;
  for (const Vector3d& v : mesh.vertices) {
    Cell c;
    for (int k = 0; k < 3; k++) c[k] = std::lround(v[k] / distance);
    int found = -1;
    for (long x = c[0] - 1; x <= c[0] + 1; x++) {
      for (long y = c[1] - 1; y <= c[1] + 1; y++) {
        for (long z = c[2] - 1; z <= c[2] + 1; z++) {
          const auto it = cells.find({x, y, z});
          if (it == cells.end()) continue;
          for (int i : it->second) {
            if ((out.vertices[i] - v).norm() <= distance) found = i;
          }
        }
      }
    }
    if (found < 0) {
      found = static_cast<int>(out.vertices.size());
      out.vertices.push_back(v);
      cells[c].push_back(found);
    }
    renamed.push_back(found);
  }
  for (const Face& f : mesh.faces) {
    out.faces.push_back({renamed[f[0]], renamed[f[1]], renamed[f[2]]});
  }
  return out;
}

class Repairer {
 public:
  Repairer(const TriMesh& mesh, MeshRepair* done) : done_(*done) {
    size_ = bounds(mesh).diagonal().norm();
    m_ = welded(mesh, kWeld * size_);
  }

  TriMesh run() {
    dropDegenerate();
    double total = 0;
    for (const Face& f : m_.faces) total += area(m_, f);
    dropFins(kStrayArea * total);
    turnFaces();
    cutApart();
    fillHoles();
    dropStrayParts(kStrayArea * total);
    dropUnused();
    lookOutwards();
    return m_;
  }

 private:
  using Edge = std::pair<int, int>;
  static Edge edge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  std::map<Edge, std::vector<int>> edges() const {  // faces at each edge
    std::map<Edge, std::vector<int>> out;
    for (std::size_t i = 0; i < m_.faces.size(); i++) {
      for (int k = 0; k < 3; k++) {
        out[edge(m_.faces[i][k], m_.faces[i][(k + 1) % 3])].push_back(static_cast<int>(i));
      }
    }
    return out;
  }

  template <typename Predicate>
  void dropIf(Predicate drop) {
    std::vector<Face> kept;
    for (std::size_t i = 0; i < m_.faces.size(); i++) {
      if (!drop(static_cast<int>(i))) kept.push_back(m_.faces[i]);
    }
    m_.faces = kept;
  }

  void dropDegenerate() {
    std::set<std::set<int>> seen;
    const std::size_t before = m_.faces.size();
    dropIf([&](int i) {
      const std::set<int> corners(m_.faces[i].begin(), m_.faces[i].end());
      return corners.size() < 3 || !seen.insert(corners).second;
    });
    done_.dropped_faces += static_cast<int>(before - m_.faces.size());
  }

  // Faces that hang on an edge of two others by one side and are free at another.
  void dropFins(double allowed) {
    for (;;) {
      const auto at = edges();
      std::set<int> fins;
      for (std::size_t i = 0; i < m_.faces.size(); i++) {
        int open = 0, crowded = 0;
        for (int k = 0; k < 3; k++) {
          const std::size_t n = at.at(edge(m_.faces[i][k], m_.faces[i][(k + 1) % 3])).size();
          open += n == 1;
          crowded += n > 2;
        }
        if ((open > 0 && crowded > 0) || open > 1) fins.insert(static_cast<int>(i));
      }
      if (fins.empty()) return;
      for (int i : fins) allowed -= area(m_, m_.faces[i]);
      if (allowed < 0) refuseEdge(at);
      done_.dropped_faces += static_cast<int>(fins.size());
      dropIf([&](int i) { return fins.count(i) > 0; });
    }
  }

  [[noreturn]] void refuseEdge(const std::map<Edge, std::vector<int>>& at) const {
    std::size_t crowded = 0, open = 0;
    const Edge* first = nullptr;
    for (const auto& [e, faces] : at) {
      open += faces.size() == 1;
      if (faces.size() < 3) continue;
      if (crowded++ == 0) first = &e;
    }
    std::ostringstream text;
    if (first) {
      text << "not manifold: " << crowded << " edges belong to more than two faces, the first at "
           << place(m_.vertices[first->first])
           << "; remove inner walls and doubled surfaces, so that the bone is one closed skin";
    } else {
      text << "open: " << open << " edges have a face on one side only; close the holes";
    }
    throw std::runtime_error(text.str());
  }

  // Neighbours must run along their edge in opposite senses.
  void turnFaces() {
    const auto at = edges();
    std::vector<int> state(m_.faces.size(), 0);
    for (std::size_t seed = 0; seed < m_.faces.size(); seed++) {
      if (state[seed]) continue;
      state[seed] = 1;
      std::vector<int> part = {static_cast<int>(seed)};
      std::size_t turned = 0;
      for (std::size_t next = 0; next < part.size(); next++) {
        const Face f = m_.faces[part[next]];
        for (int k = 0; k < 3; k++) {
          const int a = f[k], b = f[(k + 1) % 3];
          const auto& faces = at.at(edge(a, b));
          if (faces.size() != 2) continue;
          const int other = faces[0] == part[next] ? faces[1] : faces[0];
          if (state[other]) continue;
          state[other] = 1;
          part.push_back(other);
          if (runs(m_.faces[other], a, b)) {
            std::swap(m_.faces[other][1], m_.faces[other][2]);
            state[other] = 2;
            turned++;
          }
        }
      }
      if (2 * turned > part.size()) {  // the seed was one of the few
        for (int i : part) std::swap(m_.faces[i][1], m_.faces[i][2]);
        turned = part.size() - turned;
      }
      done_.flipped_faces += static_cast<int>(turned);
    }
  }

  static bool runs(const Face& f, int a, int b) {
    for (int k = 0; k < 3; k++) {
      if (f[k] == a && f[(k + 1) % 3] == b) return true;
    }
    return false;
  }

  Vector3d third(int face, const Edge& e) const {
    for (int v : m_.faces[face]) {
      if (v != e.first && v != e.second) return m_.vertices[v];
    }
    return m_.vertices[e.first];
  }

  // Sheets that touch in an edge, and cones that touch in a vertex, each get vertices of their own.
  void cutApart() {
    const int n = static_cast<int>(m_.faces.size());
    std::vector<int> parent(3 * n);  // corner 3 * face + k; corners that share a vertex
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int c) {
      while (parent[c] != c) c = parent[c] = parent[parent[c]];
      return c;
    };
    const auto corner = [&](int face, int vertex) {
      const Face& f = m_.faces[face];
      return 3 * face + static_cast<int>(std::find(f.begin(), f.end(), vertex) - f.begin());
    };
    const auto join = [&](int one, int two, const Edge& e) {
      for (int v : {e.first, e.second}) parent[root(corner(one, v))] = root(corner(two, v));
    };
    for (const auto& [e, faces] : edges()) {
      // Two faces that could not be turned to agree: left apart.
      if (faces.size() == 2 && runs(m_.faces[faces[0]], e.first, e.second) !=
                                   runs(m_.faces[faces[1]], e.first, e.second)) {
        join(faces[0], faces[1], e);
      }
      if (faces.size() < 3) continue;
      done_.cut_edges++;
      // Pair each face with the nearest of the other sense around the edge, on its inner side.
      const Vector3d axis = (m_.vertices[e.second] - m_.vertices[e.first]).normalized();
      const Vector3d zero = (third(faces[0], e) - m_.vertices[e.first]).cross(axis).normalized();
      std::vector<std::pair<double, int>> forward, backward;
      for (int f : faces) {
        const Vector3d r = (third(f, e) - m_.vertices[e.first]).cross(axis);
        const double angle = std::atan2(axis.dot(zero.cross(r)), zero.dot(r));
        (runs(m_.faces[f], e.first, e.second) ? forward : backward).push_back({angle, f});
      }
      // Seen along the edge, the solid lies clockwise or counter-clockwise of a face by its sense.
      for (const auto& [angle, f] : forward) {
        int best = -1;
        double least = 7;
        for (std::size_t k = 0; k < backward.size(); k++) {
          const double gap = std::fmod(backward[k].first - angle + 4 * M_PI, 2 * M_PI);
          if (gap < least) {
            least = gap;
            best = static_cast<int>(k);
          }
        }
        if (best < 0) continue;
        join(f, backward[best].second, e);
        backward.erase(backward.begin() + best);
      }
    }
    std::map<int, int> renamed;
    TriMesh out;
    for (int f = 0; f < n; f++) {
      Face face;
      for (int k = 0; k < 3; k++) {
        const auto [it, fresh] =
            renamed.insert({root(3 * f + k), static_cast<int>(out.vertices.size())});
        if (fresh) out.vertices.push_back(m_.vertices[m_.faces[f][k]]);
        face[k] = it->second;
      }
      out.faces.push_back(face);
    }
    m_ = out;
  }

  // Edges that a face runs along and none runs back, turned round; by their first vertex.
  std::multimap<int, int> borders() const {
    std::map<Edge, int> balance;  // forward runs less backward ones
    for (const Face& f : m_.faces) {
      for (int k = 0; k < 3; k++) {
        const int a = f[k], b = f[(k + 1) % 3];
        balance[edge(a, b)] += a < b ? 1 : -1;
      }
    }
    std::multimap<int, int> out;
    for (const auto& [e, n] : balance) {
      for (int k = 0; k < n; k++) out.insert({e.second, e.first});
      for (int k = 0; k < -n; k++) out.insert({e.first, e.second});
    }
    return out;
  }

  // Borders as loops, each filled with a fan about its middle.
  void fillHoles() {
    std::multimap<int, int> next = borders();
    std::vector<int> path;
    while (!next.empty() || !path.empty()) {
      if (path.empty()) path.push_back(next.begin()->first);
      const auto step = next.find(path.back());
      if (step == next.end()) throw std::runtime_error("open: its border has an end");
      const int to = step->second;
      next.erase(step);
      const auto again = std::find(path.begin(), path.end(), to);
      if (again == path.end()) {
        path.push_back(to);
        continue;
      }
      const std::vector<int> loop(again, path.end());
      path.erase(again, path.end());
      if (!path.empty()) path.push_back(to);
      fill(loop);
    }
  }

  void fill(const std::vector<int>& loop) {
    double length = 0;
    Vector3d middle = Vector3d::Zero();
    for (std::size_t i = 0; i < loop.size(); i++) {
      const Vector3d& p = m_.vertices[loop[i]];
      length += (m_.vertices[loop[(i + 1) % loop.size()]] - p).norm();
      middle += p / static_cast<double>(loop.size());
    }
    if (length > kHole * size_) {
      std::ostringstream text;
      text << "open: a hole with a border of " << loop.size() << " edges and a length of " << length
           << ", at " << place(m_.vertices[loop.front()])
           << "; close it, only small holes are filled here";
      throw std::runtime_error(text.str());
    }
    if (loop.size() < 3) return;  // two faces back to back
    done_.filled_holes++;
    if (loop.size() == 3) {
      m_.faces.push_back({loop[0], loop[1], loop[2]});
      return;
    }
    const int centre = static_cast<int>(m_.vertices.size());
    m_.vertices.push_back(middle);
    for (std::size_t i = 0; i < loop.size(); i++) {
      m_.faces.push_back({loop[i], loop[(i + 1) % loop.size()], centre});
    }
  }

  std::vector<std::vector<int>> parts() const {
    const auto at = edges();
    std::vector<char> seen(m_.faces.size(), 0);
    std::vector<std::vector<int>> out;
    for (std::size_t seed = 0; seed < m_.faces.size(); seed++) {
      if (seen[seed]) continue;
      seen[seed] = 1;
      std::vector<int> part = {static_cast<int>(seed)};
      for (std::size_t next = 0; next < part.size(); next++) {
        const Face& f = m_.faces[part[next]];
        for (int k = 0; k < 3; k++) {
          for (int other : at.at(edge(f[k], f[(k + 1) % 3]))) {
            if (!seen[other]) part.push_back(other);
            seen[other] = 1;
          }
        }
      }
      out.push_back(part);
    }
    return out;
  }

  // Flakes of no volume: a double face that the cut has left alone.
  void dropStrayParts(double allowed) {
    std::set<int> strays;
    for (const auto& part : parts()) {
      double volume = 0, surface = 0;
      for (int i : part) {
        const Face& f = m_.faces[i];
        volume += m_.vertices[f[0]].dot(m_.vertices[f[1]].cross(m_.vertices[f[2]])) / 6;
        surface += area(m_, f);
      }
      if (std::abs(volume) < 1e-3 * std::pow(surface, 1.5) && surface < allowed) {
        strays.insert(part.begin(), part.end());
      }
    }
    done_.dropped_faces += static_cast<int>(strays.size());
    dropIf([&](int i) { return strays.count(i) > 0; });
  }

  void dropUnused() {
    std::vector<int> renamed(m_.vertices.size(), -1);
    std::vector<Vector3d> vertices;
    for (Face& f : m_.faces) {
      for (int& v : f) {
        if (renamed[v] < 0) {
          renamed[v] = static_cast<int>(vertices.size());
          vertices.push_back(m_.vertices[v]);
        }
        v = renamed[v];
      }
    }
    m_.vertices = vertices;
  }

  void lookOutwards() {
    if (m_.faces.empty()) throw std::runtime_error("nothing is left of the surface");
    if (signedVolume(m_) < 0) {
      throw std::runtime_error(
          "inside out: its faces look inwards, as after a mirroring; if the coordinates are right, "
          "flip the faces, if they are mirrored, mirror them back");
    }
  }

  MeshRepair& done_;
  TriMesh m_;
  double size_;
};

}  // namespace

std::string MeshRepair::text() const {
  std::string out;
  const auto say = [&](int n, const char* one, const char* many) {
    if (n == 0) return;
    out += (out.empty() ? "" : ", ") + std::to_string(n) + " " + (n == 1 ? one : many);
  };
  say(filled_holes, "hole filled", "holes filled");
  say(dropped_faces, "stray face dropped", "stray faces dropped");
  say(flipped_faces, "face turned", "faces turned");
  say(cut_edges, "edge of several sheets cut apart", "edges of several sheets cut apart");
  return out;
}

TriMesh repaired(const TriMesh& mesh, MeshRepair* done) { return Repairer(mesh, done).run(); }

double signedVolume(const TriMesh& mesh) {
  double volume = 0;
  if (mesh.vertices.empty()) return 0;
  const Vector3d o = mesh.vertices.front();
  for (const Face& f : mesh.faces) {
    volume +=
        (mesh.vertices[f[0]] - o).dot((mesh.vertices[f[1]] - o).cross(mesh.vertices[f[2]] - o)) / 6;
  }
  return volume;
}

Eigen::AlignedBox3d bounds(const TriMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  return box;
}

}  // namespace torso
