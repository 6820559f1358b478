// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/simplify.h"

#include <Eigen/LU>
#include <algorithm>
#include <queue>

namespace torso {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Sum of squared distances to planes: x^T A x + 2 b^T x + c.
struct Quadric {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;
  void addPlane(const Vector3d& normal, const Vector3d& point, double weight) {
    const double d = -normal.dot(point);
    A += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  double operator()(const Vector3d& x) const { return x.dot(A * x) + 2 * b.dot(x) + c; }
};

class Simplifier {
 public:
  explicit Simplifier(const TriMesh& mesh) : v_(mesh.vertices), f_(mesh.faces) {
    const std::size_t n = v_.size();
    faces_of_.resize(n);
    quadric_.resize(n);
    version_.assign(n, 0);
    border_.assign(n, false);
    alive_.assign(f_.size(), true);
    count_ = static_cast<int>(f_.size());
    std::vector<std::pair<int, int>> edges;
    for (std::size_t i = 0; i < f_.size(); i++) {
      const auto& f = f_[i];
      const Vector3d cross = (v_[f[1]] - v_[f[0]]).cross(v_[f[2]] - v_[f[0]]);
      for (int k = 0; k < 3; k++) {
        faces_of_[f[k]].push_back(static_cast<int>(i));
        edges.push_back({f[k], f[(k + 1) % 3]});
        if (cross.norm() > 0) {
          quadric_[f[k]].addPlane(cross.normalized(), v_[f[0]], cross.norm() / 6);
        }
      }
    }
    std::sort(edges.begin(), edges.end());
    const auto open = [&](int a, int b) {
      return !std::binary_search(edges.begin(), edges.end(), std::make_pair(b, a));
    };
    for (const auto& [a, b] : edges) {
      if (open(a, b)) border_[a] = border_[b] = true;
    }
    for (const auto& [a, b] : edges) {
      if (a < b || open(a, b)) push(a, b);
    }
  }

  TriMesh run(int max_faces) {
    while (count_ > max_faces && !heap_.empty()) {
      const Candidate c = heap_.top();
      heap_.pop();
      if (c.version == version_[c.a] + version_[c.b]) collapse(c);
    }
    TriMesh out;
    std::vector<int> renamed(v_.size(), -1);
    for (std::size_t i = 0; i < f_.size(); i++) {
      if (!alive_[i]) continue;
      std::array<int, 3> f;
      for (int k = 0; k < 3; k++) {
        int& name = renamed[f_[i][k]];
        if (name < 0) {
          name = static_cast<int>(out.vertices.size());
          out.vertices.push_back(v_[f_[i][k]]);
        }
        f[k] = name;
      }
      out.faces.push_back(f);
    }
    return out;
  }

 private:
  struct Candidate {  // small: most of the time goes into moving these
    double cost;
    int a, b;
    int version;  // sum of both ends', which only grow
    int tries;
    bool operator<(const Candidate& other) const { return cost > other.cost; }
  };

  struct Merge {
    Vector3d place;
    double cost;
  };
  Merge merge(int a, int b) const {
    Quadric q = quadric_[a];
    q.A += quadric_[b].A;
    q.b += quadric_[b].b;
    q.c += quadric_[b].c;
    const Vector3d edge = v_[b] - v_[a], middle = 0.5 * (v_[a] + v_[b]);
    // Towards the middle a little: flat places would leave the best place open.
    const double area = std::max(q.A.trace(), 1e-18), keep = 2e-3 * area;
    Matrix3d A = q.A + keep * Matrix3d::Identity();
    Vector3d rhs = -q.b + keep * middle;
    const bool border = border_[a] || border_[b];
    if (border) {
      A(1, 1) += 1e3 * area;
      A(1, 0) = A(0, 1) = A(1, 2) = A(2, 1) = 0;
      rhs.y() = 0;
    }
    Vector3d place = A.inverse() * rhs;
    if (border) place.y() = 0;
    if (!((place - middle).norm() < edge.norm())) {
      place = middle;
      if (border) place.y() = 0;
    }
    // Among flat places short edges go first, for even faces.
    return {place, std::max(q(place), 0.0) + 3e-4 * area * edge.squaredNorm()};
  }

  void push(int a, int b) { heap_.push({merge(a, b).cost, a, b, version_[a] + version_[b], 0}); }

  void neighbours(int a, std::vector<int>& out) const {  // ascending
    out.clear();
    for (int i : faces_of_[a]) {
      for (int k : f_[i]) {
        if (k != a) out.push_back(k);
      }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }

  void collapse(const Candidate& c) {
    // The surface stays a surface if the two ends share just the neighbours opposite the edge.
    std::vector<int>&na = neighbours_a_, &nb = neighbours_b_;
    neighbours(c.a, na);
    neighbours(c.b, nb);
    int shared_faces = 0, shared = 0;
    for (int i : faces_of_[c.a]) shared_faces += contains(i, c.b);
    for (int i : na) shared += std::binary_search(nb.begin(), nb.end(), i);
    if (shared_faces == 0 || shared != shared_faces) return;
    if (border_[c.a] && border_[c.b] && shared_faces != 1) return;
    if (na.size() + nb.size() < 8) return;
    // Two vertices on the open edge may only be joined along it: the mirror image has them, too.
    if (border_[c.a] != border_[c.b]) {
      const std::vector<int>&inner = border_[c.a] ? nb : na, &outer = border_[c.a] ? na : nb;
      for (int i : inner) {
        if (border_[i] && i != c.a && i != c.b &&
            !std::binary_search(outer.begin(), outer.end(), i)) {
          return;
        }
      }
    }
    const Vector3d place = merge(c.a, c.b).place;
    for (int end : {c.a, c.b}) {
      for (int i : faces_of_[end]) {
        if (contains(i, c.a) && contains(i, c.b)) continue;
        Vector3d p[3];
        for (int k = 0; k < 3; k++) p[k] = v_[f_[i][k]];
        const double was = quality(p);
        const Vector3d before = (p[1] - p[0]).cross(p[2] - p[0]);
        for (int k = 0; k < 3; k++) {
          if (f_[i][k] == end) p[k] = place;
        }
        const double is = quality(p);
        const Vector3d after = (p[1] - p[0]).cross(p[2] - p[0]);
        const bool sliver = is < 0.15 && is < was;
        const bool fold = was > 0.05 && before.dot(after) < 0.3 * before.norm() * after.norm();
        if (sliver || fold) {
          // Later perhaps, when the neighbours have changed.
          if (c.tries < 3) {
            Candidate again = c;
            again.cost *= 30;
            again.tries++;
            heap_.push(again);
          }
          return;
        }
      }
    }
    v_[c.a] = place;
    quadric_[c.a].A += quadric_[c.b].A;
    quadric_[c.a].b += quadric_[c.b].b;
    quadric_[c.a].c += quadric_[c.b].c;
    border_[c.a] = border_[c.a] || border_[c.b];
    for (int i : faces_of_[c.b]) {
      if (contains(i, c.a)) {
        alive_[i] = false;
        count_--;
        continue;
      }
      for (int& k : f_[i]) {
        if (k == c.b) k = c.a;
      }
      faces_of_[c.a].push_back(i);
    }
    removeDead(c.a);
    neighbours(c.a, na);
    for (int i : na) removeDead(i);
    faces_of_[c.b].clear();
    version_[c.b]++;
    version_[c.a]++;
    for (int i : na) push(c.a, i);
  }

  // Height over the longest edge, about: 0 for a sliver, 0.87 for an equilateral triangle.
  static double quality(const Vector3d p[3]) {
    const double longest = std::max(
        {(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    return (p[1] - p[0]).cross(p[2] - p[0]).norm() / longest;
  }

  bool contains(int face, int vertex) const {
    const auto& f = f_[face];
    return f[0] == vertex || f[1] == vertex || f[2] == vertex;
  }
  void removeDead(int vertex) {
    auto& faces = faces_of_[vertex];
    faces.erase(std::remove_if(faces.begin(), faces.end(), [&](int i) { return !alive_[i]; }),
                faces.end());
  }

  std::vector<Vector3d> v_;
  std::vector<std::array<int, 3>> f_;
  std::vector<std::vector<int>> faces_of_;
  std::vector<Quadric> quadric_;
  std::vector<int> version_;
  std::vector<bool> border_, alive_;
  std::priority_queue<Candidate> heap_;
  std::vector<int> neighbours_a_, neighbours_b_;  // of collapse(), to spare their making
  int count_;
};

}  // namespace

TriMesh simplified(const TriMesh& mesh, int max_faces) { return Simplifier(mesh).run(max_faces); }

}  // namespace torso
