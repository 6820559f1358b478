// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/disc_elasticity.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

namespace torso {

using Eigen::Matrix3d;
using Eigen::SparseMatrix;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

// The metric's fibres relative to the material's: where a disc is bent far, its taut fibres have
// stiffened, and a metric that is too soft overshoots.
constexpr double kMetricFibres = 1.25;

Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Sum of 3x3 blocks between nodes that share a cell.
class BlockMatrix {
 public:
  explicit BlockMatrix(const Eigen::MatrixXi& pattern)
      : pattern_(pattern), blocks_(pattern.maxCoeff() + 1, Matrix3d::Zero()) {}

  void add(int i, int j, const Matrix3d& block) { blocks_[pattern_(i, j)] += block; }

  SparseMatrix<double> sparse() const {
    const int n = static_cast<int>(pattern_.rows());
    SparseMatrix<double> matrix(3 * n, 3 * n);
    matrix.reserve(static_cast<int>(9 * blocks_.size()));
    for (int column = 0; column < 3 * n; ++column) {
      matrix.startVec(column);
      for (int i = 0; i < n; ++i) {
        const int k = pattern_(i, column / 3);
        if (k < 0) continue;
        for (int a = 0; a < 3; ++a) {
          matrix.insertBack(3 * i + a, column) = blocks_[k](a, column % 3);
        }
      }
    }
    matrix.finalize();
    return matrix;
  }

 private:
  const Eigen::MatrixXi& pattern_;
  std::vector<Matrix3d> blocks_;
};

// Gradients of a tet's shape functions (4 x 3) [1/m], and its volume [m^3].
Eigen::Matrix<double, 4, 3> gradients(const DiscMesh& mesh, const std::array<int, 4>& t,
                                      double* volume) {
  Matrix3d edges;
  for (int a = 0; a < 3; ++a) {
    edges.col(a) = mesh.rest_positions[t[a + 1]] - mesh.rest_positions[t[0]];
  }
  Eigen::Matrix<double, 4, 3> g;
  g.bottomRows<3>() = edges.inverse();
  g.row(0) = -g.bottomRows<3>().colwise().sum();
  *volume = edges.determinant() / 6;
  return g;
}

// Volume of a cell at node positions x; gradient: with respect to its nodes.
double cellVolume(const DiscElasticity::Cell& cell, const VectorXd& x,
                  std::vector<Vector3d>* gradient) {
  gradient->assign(cell.nodes.size(), Vector3d::Zero());
  const auto position = [&](int i) { return x.segment<3>(3 * cell.nodes[i]); };
  const Vector3d origin = position(0);
  double volume = 0;
  for (const auto& [i, j, k] : cell.faces) {
    const Vector3d a = position(i) - origin, b = position(j) - origin, c = position(k) - origin;
    volume += a.dot(b.cross(c)) / 6;
    (*gradient)[i] += b.cross(c) / 6;
    (*gradient)[j] += c.cross(a) / 6;
    (*gradient)[k] += a.cross(b) / 6;
  }
  Vector3d sum = Vector3d::Zero();
  for (size_t i = 1; i < cell.nodes.size(); ++i) sum += (*gradient)[i];
  (*gradient)[0] = -sum;
  return volume;
}

// The fibre's direction now, F a.
Vector3d fibre(const DiscElasticity::Cell& cell, const VectorXd& x, int family) {
  Vector3d sum = Vector3d::Zero();
  for (size_t i = 0; i < cell.nodes.size(); ++i) {
    sum += cell.fibres[i][family] * x.segment<3>(3 * cell.nodes[i]);
  }
  return sum;
}

// Stress Ef (e + c e^2) of a fibre stretched by e = s - 1 > 0, its slope, and the energy density.
struct FibreLaw {
  FibreLaw(const DiscMaterial& m, double e)
      : energy(m.fibre_modulus * (e * e / 2 + m.fibre_stiffening * e * e * e / 3)),
        stress(m.fibre_modulus * (e + m.fibre_stiffening * e * e)),
        slope(m.fibre_modulus * (1 + 2 * m.fibre_stiffening * e)) {}
  double energy, stress, slope;
};

// Second derivative of the fibres' energy of one cell along one family: stress / s across the
// fibre, slope along it.
void addFibre(const DiscElasticity::Cell& cell, int family, const Vector3d& direction, double along,
              double across, BlockMatrix* sum) {
  const Matrix3d block = cell.volume * (across * Matrix3d::Identity() +
                                        (along - across) * direction * direction.transpose());
  for (size_t i = 0; i < cell.nodes.size(); ++i) {
    for (size_t j = 0; j < cell.nodes.size(); ++j) {
      sum->add(cell.nodes[i], cell.nodes[j],
               cell.fibres[i][family] * cell.fibres[j][family] * block);
    }
  }
}

}  // namespace

DiscElasticity::DiscElasticity(const DiscMesh& mesh, const DiscMaterial& m) : material(m) {
  for (const std::string& error : {checkDiscMesh(mesh), checkDiscMaterial(material)}) {
    if (!error.empty()) throw std::invalid_argument(error);
  }
  const int n = static_cast<int>(mesh.rest_positions.size());
  rest.resize(3 * n);
  for (int i = 0; i < n; ++i) rest.segment<3>(3 * i) = mesh.rest_positions[i];
  free_index.assign(n, 0);
  Vector3d lower = Vector3d::Zero(), upper = Vector3d::Zero();
  for (int i : mesh.lower_nodes) lower += mesh.rest_positions[i] / mesh.lower_nodes.size();
  for (int i : mesh.upper_nodes) upper += mesh.rest_positions[i] / mesh.upper_nodes.size();
  height = (upper - lower).norm();
  for (int i : mesh.lower_nodes) free_index[i] = -1;
  for (int i : mesh.upper_nodes) free_index[i] = -1;
  size = 0;
  for (int i = 0; i < n; ++i) {
    size = std::max(size, mesh.rest_positions[i].norm());
    if (free_index[i] < 0) continue;
    free_index[i] = static_cast<int>(free_nodes.size());
    free_nodes.push_back(i);
  }
  addCells(mesh);
  addMetric(mesh);
}

void DiscElasticity::addCells(const DiscMesh& mesh) {
  const double E = material.annulus_modulus, nu = material.annulus_poisson;
  const int nucleus = static_cast<int>(mesh.hoops.size());
  struct Face {
    int tets = 0;
    std::array<int, 3> nodes;
  };
  std::vector<std::map<std::array<int, 3>, Face>> faces(nucleus + 1);  // by their sorted nodes
  std::vector<std::map<int, Vector3d>> mean(nucleus + 1);  // (node) integral of its gradient
  cells.resize(nucleus + 1);
  for (Cell& cell : cells) {
    cell.nucleus = &cell == &cells[nucleus];
    cell.mu = cell.nucleus ? material.nucleus_modulus / 3 : E / (2 * (1 + nu));
    cell.lambda = cell.nucleus ? material.nucleus_bulk_modulus - 2 * cell.mu / 3
                               : E * nu / ((1 + nu) * (1 - 2 * nu));
    cell.volume = 0;
  }
  Triplets entries;
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto& t = mesh.tets[e];
    const int c = mesh.cells[e] == DiscMesh::kNucleus ? nucleus : mesh.cells[e];
    double V;
    const Eigen::Matrix<double, 4, 3> g = gradients(mesh, t, &V);
    cells[c].volume += V;
    constexpr int kSides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (const auto& side : kSides) {
      const std::array<int, 3> nodes = {t[side[0]], t[side[1]], t[side[2]]};
      std::array<int, 3> key = nodes;
      std::sort(key.begin(), key.end());
      Face& face = faces[c][key];
      ++face.tets;
      face.nodes = nodes;
    }
    for (int a = 0; a < 4; ++a) {
      mean[c].try_emplace(t[a], Vector3d::Zero()).first->second += V * g.row(a).transpose();
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(t[a], t[b], cells[c].mu * V * g.row(a).dot(g.row(b)));
      }
    }
  }
  const int n = static_cast<int>(mesh.rest_positions.size());
  laplacian.resize(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());

  for (int c = 0; c <= nucleus; ++c) {
    Cell& cell = cells[c];
    std::map<int, int> place;
    for (const auto& [node, gradient] : mean[c]) {
      place[node] = static_cast<int>(cell.nodes.size());
      cell.nodes.push_back(node);
    }
    for (const auto& [key, face] : faces[c]) {
      if (face.tets != 1) continue;
      const std::array<int, 3> f = {place[face.nodes[0]], place[face.nodes[1]],
                                    place[face.nodes[2]]};
      if (f[0] != 0 && f[1] != 0 && f[2] != 0) cell.faces.push_back(f);
    }
    if (c == nucleus || material.fibre_modulus == 0) continue;
    Vector3d hoop = mesh.rest_positions[mesh.hoops[c][1]] - mesh.rest_positions[mesh.hoops[c][0]];
    hoop.z() = 0;
    for (int k = 0; k < 2; ++k) {
      cell.at_rest[k] = std::cos(material.fibre_angle) * hoop.normalized() +
                        (k == 0 ? 1 : -1) * std::sin(material.fibre_angle) * Vector3d::UnitZ();
    }
    for (const auto& [node, gradient] : mean[c]) {
      cell.fibres.emplace_back(gradient.dot(cell.at_rest[0]), gradient.dot(cell.at_rest[1]));
      cell.fibres.back() /= cell.volume;
    }
  }
  if (cells[nucleus].nodes.empty()) cells.pop_back();

  block_pattern.setConstant(n, n, -1);
  int blocks = 0;
  const auto couple = [&](int i, int j) {
    if (block_pattern(i, j) < 0) block_pattern(i, j) = blocks++;
  };
  for (int k = 0; k < n; ++k) {
    for (SparseMatrix<double>::InnerIterator it(laplacian, k); it; ++it) {
      couple(static_cast<int>(it.row()), k);
    }
  }
  for (const Cell& cell : cells) {
    for (int i : cell.nodes) {
      couple(i, cell.nodes[0]);
      couple(cell.nodes[0], i);
      for (int j : cell.nodes) {
        if (!cell.nucleus) couple(i, j);
      }
    }
    for (const auto& face : cell.faces) {
      for (int i : face) {
        for (int j : face) couple(cell.nodes[i], cell.nodes[j]);
      }
    }
  }
}

double DiscElasticity::energy(const VectorXd& u, VectorXd* f, int terms) const {
  using Rows = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
  const int n = static_cast<int>(rest.size()) / 3;
  const VectorXd x = rest + u;
  double energy = 0;
  VectorXd gradient = VectorXd::Zero(3 * n);
  if (terms & kShear) {
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> Lx = laplacian * Rows(x.data(), n, 3);
    const Eigen::Map<const VectorXd> flat(Lx.data(), 3 * n);
    gradient += flat;
    // (x L x - X L X) / 2 without its cancellation.
    Lx += laplacian * Rows(rest.data(), n, 3);
    energy += u.dot(flat) / 2;
  }
  std::vector<Vector3d> g;
  for (const Cell& cell : cells) {
    if (terms & kVolume) {
      const double change = cellVolume(cell, x, &g) - cell.volume;
      const double stiffness = (cell.lambda + cell.mu) / cell.volume;
      energy += -cell.mu * change + stiffness / 2 * change * change;
      for (size_t i = 0; i < g.size(); ++i) {
        gradient.segment<3>(3 * cell.nodes[i]) += (stiffness * change - cell.mu) * g[i];
      }
    }
    if (!(terms & kFibres) || cell.fibres.empty()) continue;
    for (int k = 0; k < 2; ++k) {
      const Vector3d d = fibre(cell, x, k);
      const double stretch = d.norm();
      if (stretch <= 1) continue;
      const FibreLaw law(material, stretch - 1);
      energy += cell.volume * law.energy;
      for (size_t i = 0; i < cell.nodes.size(); ++i) {
        gradient.segment<3>(3 * cell.nodes[i]) +=
            cell.volume * law.stress / stretch * cell.fibres[i][k] * d;
      }
    }
  }
  if (f) *f = -gradient;
  return energy;
}

DiscElasticity::Hessian DiscElasticity::hessian(const VectorXd& u, int terms) const {
  const int n = static_cast<int>(rest.size()) / 3;
  const VectorXd x = rest + u;
  Hessian H = {SparseMatrix<double>(3 * n, 3 * n), VectorXd::Zero(3 * n), 0};
  BlockMatrix sum(block_pattern);
  if (terms & kShear) {
    for (int k = 0; k < n; ++k) {
      for (SparseMatrix<double>::InnerIterator it(laplacian, k); it; ++it) {
        sum.add(static_cast<int>(it.row()), k, it.value() * Matrix3d::Identity());
      }
    }
  }
  std::vector<Vector3d> g;
  for (const Cell& cell : cells) {
    if (terms & kVolume) {
      const double change = cellVolume(cell, x, &g) - cell.volume;
      const double stiffness = (cell.lambda + cell.mu) / cell.volume;
      const double slope = stiffness * change - cell.mu;
      if (cell.nucleus) H.nucleus_stiffness = stiffness;
      for (size_t i = 0; i < g.size(); ++i) {
        if (cell.nucleus) {
          H.nucleus_gradient.segment<3>(3 * cell.nodes[i]) = g[i];
          continue;
        }
        for (size_t j = 0; j < g.size(); ++j) {
          sum.add(cell.nodes[i], cell.nodes[j], stiffness * g[i] * g[j].transpose());
        }
      }
      const int origin = cell.nodes[0];
      for (const auto& face : cell.faces) {
        // Of a . (b x c) / 6, positions relative to the origin: d(b x c)/db = -[c]x and cyclic.
        for (int k = 0; k < 3; ++k) {
          const int i = cell.nodes[face[k]];
          for (int step : {1, 2}) {
            const int j = cell.nodes[face[(k + step) % 3]];
            const int other = cell.nodes[face[(k + 3 - step) % 3]];
            const Matrix3d block = (step == 1 ? -slope : slope) / 6 *
                                   skew(x.segment<3>(3 * other) - x.segment<3>(3 * origin));
            sum.add(i, j, block);
            sum.add(i, origin, -block);
            sum.add(origin, j, -block);
            sum.add(origin, origin, block);
          }
        }
      }
    }
    if (!(terms & kFibres) || cell.fibres.empty()) continue;
    for (int k = 0; k < 2; ++k) {
      const Vector3d d = fibre(cell, x, k);
      const double stretch = d.norm();
      if (stretch <= 1) continue;
      const FibreLaw law(material, stretch - 1);
      addFibre(cell, k, d / stretch, law.slope, law.stress / stretch, &sum);
    }
  }
  H.sparse = sum.sparse();
  return H;
}

double DiscElasticity::nucleusPressure(const VectorXd& u) const {
  if (cells.empty() || !cells.back().nucleus) return 0;
  const Cell& cell = cells.back();
  std::vector<Vector3d> g;
  return (cell.lambda + cell.mu) * (1 - cellVolume(cell, rest + u, &g) / cell.volume);
}

SparseMatrix<double> DiscElasticity::freePart(const SparseMatrix<double>& matrix) const {
  const int nfree = static_cast<int>(free_nodes.size());
  Triplets entries;
  for (int k = 0; k < matrix.outerSize(); ++k) {
    const int j = free_index[k / 3];
    if (j < 0) continue;
    for (SparseMatrix<double>::InnerIterator it(matrix, k); it; ++it) {
      const int i = free_index[it.row() / 3];
      if (i >= 0) entries.emplace_back(3 * i + it.row() % 3, 3 * j + k % 3, it.value());
    }
  }
  SparseMatrix<double> part(3 * nfree, 3 * nfree);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

VectorXd DiscElasticity::freePart(const VectorXd& vector) const {
  VectorXd part(3 * free_nodes.size());
  for (size_t i = 0; i < free_nodes.size(); ++i) {
    part.segment<3>(3 * i) = vector.segment<3>(3 * free_nodes[i]);
  }
  return part;
}

void DiscElasticity::addMetric(const DiscMesh& mesh) {
  const int n = static_cast<int>(mesh.rest_positions.size());
  Hessian H = hessian(VectorXd::Zero(3 * n), kShear | kVolume);
  BlockMatrix fibres(block_pattern);
  for (const Cell& cell : cells) {
    for (int k = 0; k < 2 && !cell.fibres.empty(); ++k) {
      addFibre(cell, k, cell.at_rest[k], kMetricFibres * material.fibre_modulus, 0, &fibres);
    }
  }
  H.sparse += fibres.sparse();
  metric = freePart(H.sparse);
  nucleus_gradient = H.nucleus_gradient;
  nucleus_stiffness = H.nucleus_stiffness;

  // Half the rigid motions of the two bones.
  Eigen::Matrix<double, Eigen::Dynamic, 6> motion(3 * n, 6);
  motion.setZero();
  const auto move = [&](int i, double factor) {
    for (int k = 0; k < 3; ++k) {
      motion(3 * i + k, k) = factor;
      motion.block<3, 1>(3 * i, 3 + k) = factor * Vector3d::Unit(k).cross(mesh.rest_positions[i]);
    }
  };
  for (int i : mesh.lower_nodes) move(i, -0.5);
  for (int i : mesh.upper_nodes) move(i, 0.5);

  const int nfree = static_cast<int>(free_nodes.size());
  const VectorXd& g = nucleus_gradient;
  const Vector6d swept = motion.transpose() * g;  // volume that the attached nodes sweep
  const Eigen::Matrix<double, Eigen::Dynamic, 6> load = H.sparse * motion;
  Eigen::Matrix<double, Eigen::Dynamic, 6> free_load(3 * nfree, 6);
  for (int k = 0; k < 6; ++k) free_load.col(k) = freePart(VectorXd(load.col(k)));
  const VectorXd free_g = freePart(g);
  response_without_nucleus.resize(3 * nfree, 6);
  response.resize(3 * nfree, 6);
  nucleus_response.resize(3 * nfree);
  nucleus_wrench = swept;
  Vector6d pressure = nucleus_stiffness * swept;  // fall of the nucleus' pressure
  if (nfree > 0) {
    const Eigen::SimplicialLLT<SparseMatrix<double>> factor(metric);
    if (factor.info() == Eigen::Success) {
      response_without_nucleus = -factor.solve(free_load);
      nucleus_response = factor.solve(free_g);
    }
    if (factor.info() != Eigen::Success || !response_without_nucleus.allFinite()) {
      throw std::invalid_argument(
          "the stiffness at rest is singular: a part of the mesh can move freely (does it hang on "
          "one node or edge?)");
    }
    nucleus_wrench += response_without_nucleus.transpose() * free_g;
    pressure =
        nucleus_stiffness / (1 + nucleus_stiffness * free_g.dot(nucleus_response)) * nucleus_wrench;
    response = response_without_nucleus - nucleus_response * pressure.transpose();
  }
  bound_stiffness =
      motion.transpose() * load + free_load.transpose() * response + swept * pressure.transpose();
  bound_stiffness = (bound_stiffness + bound_stiffness.transpose()).eval() / 2;
}

HalfwayFrame::HalfwayFrame(const DiscPose& pose) {
  // Of the two quaternions of a rotation, the one with the smaller angle.
  Eigen::Quaterniond q = pose.rotation;
  const double largest = q.coeffs().cwiseAbs().maxCoeff();
  if (!(largest > 0)) {
    q.setIdentity();
  } else {
    q.coeffs() /= q.w() < 0 ? -largest : largest;
    q.normalize();
  }
  Eigen::Quaterniond h = q;
  h.w() += 1;
  h.normalize();
  half = h.toRotationMatrix();
  full = q.toRotationMatrix();
  rotation = q.vec();
  origin = pose.position / 2;
  offset = half.transpose() * origin;
}

DiscWrench HalfwayFrame::wrench(const Vector6d& in_m, const Vector3d& normal) const {
  DiscWrench w;
  w.force = half * in_m.head<3>();
  w.moment = half * in_m.tail<3>() + origin.cross(w.force);
  const double area_squared = normal.squaredNorm();
  if (area_squared > 0) w.pressure = w.force.dot(full * normal) / area_squared;
  return w;
}

}  // namespace torso
