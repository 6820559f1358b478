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

// How many times the wanted faces the heap begins with, and how far the sweeps before it go.
constexpr int kHeapShare = 8, kSweeps = 40;

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
    for (std::size_t i = 0; i < f_.size(); i++) {
      const auto& f = f_[i];
      const Vector3d cross = (v_[f[1]] - v_[f[0]]).cross(v_[f[2]] - v_[f[0]]);
      const double twice_area = cross.norm();
      for (int k = 0; k < 3; k++) {
        faces_of_[f[k]].push_back(static_cast<int>(i));
        if (twice_area > 0) {
          quadric_[f[k]].addPlane(cross / twice_area, v_[f[0]], twice_area / 6);
        }
      }
    }
    for (const auto& f : f_) {
      for (int k = 0; k < 3; k++) {
        const int a = f[k], b = f[(k + 1) % 3];
        if (v_[a].y() != 0 || v_[b].y() != 0) continue;
        int faces = 0;
        for (int i : faces_of_[a]) faces += contains(i, b);
        if (faces == 1) border_[a] = border_[b] = true;
      }
    }
  }

  TriMesh run(int max_faces) {
    thin(kHeapShare * max_faces);
    std::vector<int> around;
    for (std::size_t a = 0; a < v_.size(); a++) {
      neighbours(static_cast<int>(a), around);
      for (int b : around) {
        if (b > static_cast<int>(a)) push(static_cast<int>(a), b);
      }
    }
    while (count_ > max_faces && !heap_.empty()) {
      const Candidate c = heap_.top();
      heap_.pop();
      if (c.version != version_[c.a] + version_[c.b]) continue;
      const Outcome outcome = collapse(c.a, c.b);
      if (outcome == Outcome::kDone) {
        neighbours(c.a, around);
        for (int i : around) push(c.a, i);
      } else if (outcome == Outcome::kNotNow && c.tries < 3) {
        heap_.push({30 * c.cost, c.a, c.b, c.version, c.tries + 1});
      }
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
  // Sweeps over all edges, cheap ones first, until so many faces are left: where faces are many
  // more than wanted, the order of their going matters little, and a heap takes most of the time.
  void thin(int faces) {
    double bound = 0;
    for (std::size_t i = 0; i < f_.size(); i++)
      bound += merge(f_[i][0], f_[i][1]).cost / (8 * f_.size());
    std::vector<int> around;
    for (int sweep = 0; count_ > faces && sweep < kSweeps; sweep++, bound *= 2) {
      for (int a = 0; a < static_cast<int>(v_.size()) && count_ > faces; a++) {
        if (faces_of_[a].empty()) continue;
        neighbours(a, around);
        for (int b : around) {
          if (b > a && merge(a, b).cost < bound && collapse(a, b) == Outcome::kDone) break;
        }
      }
    }
  }

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

  enum class Outcome {
    kDone,
    kNever,   // it would not stay a surface
    kNotNow,  // faces would fold or be slivers; another day perhaps, when the neighbours have
              // changed
  };
  // Joins the ends of an edge in `a`.
  Outcome collapse(int a, int b) {
    // The surface stays a surface if the two ends share just the neighbours opposite the edge.
    std::vector<int>&na = neighbours_a_, &nb = neighbours_b_;
    neighbours(a, na);
    neighbours(b, nb);
    int shared_faces = 0, shared = 0;
    for (int i : faces_of_[a]) shared_faces += contains(i, b);
    for (int i : na) shared += std::binary_search(nb.begin(), nb.end(), i);
    if (shared_faces == 0 || shared != shared_faces) return Outcome::kNever;
    if (border_[a] && border_[b] && shared_faces != 1) return Outcome::kNever;
    if (na.size() + nb.size() < 8) return Outcome::kNever;
    // Two vertices on the open edge may only be joined along it: the mirror image has them, too.
    if (border_[a] != border_[b]) {
      const std::vector<int>&inner = border_[a] ? nb : na, &outer = border_[a] ? na : nb;
      for (int i : inner) {
        if (border_[i] && i != a && i != b && !std::binary_search(outer.begin(), outer.end(), i)) {
          return Outcome::kNever;
        }
      }
    }
    const Vector3d place = merge(a, b).place;
    for (int end : {a, b}) {
      for (int i : faces_of_[end]) {
        if (contains(i, a) && contains(i, b)) continue;
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
        if (sliver || fold) return Outcome::kNotNow;
      }
    }
    v_[a] = place;
    quadric_[a].A += quadric_[b].A;
    quadric_[a].b += quadric_[b].b;
    quadric_[a].c += quadric_[b].c;
    border_[a] = border_[a] || border_[b];
    for (int i : faces_of_[b]) {
      if (contains(i, a)) {
        alive_[i] = false;
        count_--;
        continue;
      }
      for (int& k : f_[i]) {
        if (k == b) k = a;
      }
      faces_of_[a].push_back(i);
    }
    removeDead(a);
    neighbours(a, na);
    for (int i : na) removeDead(i);
    faces_of_[b].clear();
    version_[b]++;
    version_[a]++;
    return Outcome::kDone;
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
