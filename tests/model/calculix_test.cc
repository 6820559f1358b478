// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0

// The disc against an independent finite-element program, CalculiX (Debian: calculix-ccx): the same
// mesh, Hooke's law, rigid motions of the upper endplate.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>

#include "model/disc_elasticity.h"
#include "model/disc_reference.h"
#include "tests/model/disc_test_util.h"

namespace torso {
namespace {

using Eigen::Vector3d;

constexpr DiscShape kShape = {0.0484, 0.0343, 0.0144, 0.0066};  // wedged: all couplings show
constexpr double kModulus = 4e6;                                // [Pa]
constexpr const char* kMotions[] = {"shear, anterior", "shear, lateral", "compression",
                                    "lateral bending", "flexion",        "torsion"};

// Nodes and elements as CalculiX takes them: tets of 4 nodes, or of 10 with straight edges.
struct Solid {
  std::vector<Vector3d> nodes;
  std::vector<std::vector<int>> elements;
  std::vector<int> lower, upper;
};

Solid linearTets(const DiscMesh& mesh) {
  Solid solid = {mesh.rest_positions, {}, mesh.lower_nodes, mesh.upper_nodes};
  for (const auto& t : mesh.tets) solid.elements.emplace_back(t.begin(), t.end());
  return solid;
}

// With a node in the middle of each edge; attached if both its ends are.
Solid quadraticTets(const DiscMesh& mesh) {
  Solid solid = linearTets(mesh);
  std::vector<char> lower(solid.nodes.size(), false), upper = lower;
  for (int i : mesh.lower_nodes) lower[i] = true;
  for (int i : mesh.upper_nodes) upper[i] = true;
  std::map<std::pair<int, int>, int> middle;
  for (auto& element : solid.elements) {
    const std::vector<int> t = element;
    for (const auto& [i, j] : {std::pair(0, 1), {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) {
      const int a = std::min(t[i], t[j]), b = std::max(t[i], t[j]);
      const auto [edge, is_new] = middle.try_emplace({a, b}, static_cast<int>(solid.nodes.size()));
      if (is_new) {
        solid.nodes.push_back((solid.nodes[a] + solid.nodes[b]) / 2);
        if (lower[a] && lower[b]) solid.lower.push_back(edge->second);
        if (upper[a] && upper[b]) solid.upper.push_back(edge->second);
      }
      element.push_back(edge->second);
    }
  }
  return solid;
}

// Displacement of a point under unit motion k: translations, then rotations about the origin.
Vector3d motionOf(const Vector3d& x, int k) {
  return k < 3 ? Vector3d(Vector3d::Unit(k)) : Vector3d(Vector3d::Unit(k - 3).cross(x));
}

// One linear static step per motion of the upper nodes, the lower ones held.
void writeDeck(const std::filesystem::path& path, const Solid& solid, double nu) {
  std::ofstream file(path);
  file.precision(12);  // CalculiX reads fields of at most 20 characters
  file << std::scientific << "*NODE, NSET=ALL\n";
  for (size_t i = 0; i < solid.nodes.size(); ++i) {
    const Vector3d& x = solid.nodes[i];
    file << i + 1 << ", " << x.x() << ", " << x.y() << ", " << x.z() << '\n';
  }
  file << "*ELEMENT, TYPE=C3D" << solid.elements[0].size() << ", ELSET=DISC\n";
  for (size_t e = 0; e < solid.elements.size(); ++e) {
    file << e + 1;
    for (int i : solid.elements[e]) file << ", " << i + 1;
    file << '\n';
  }
  file << "*NSET, NSET=LOWER\n";
  for (int i : solid.lower) file << i + 1 << ",\n";
  file << "*NSET, NSET=UPPER\n";
  for (int i : solid.upper) file << i + 1 << ",\n";
  file << "*MATERIAL, NAME=HOOKE\n*ELASTIC\n"
       << kModulus << ", " << nu << "\n*SOLID SECTION, ELSET=DISC, MATERIAL=HOOKE\n"
       << "*BOUNDARY\nLOWER, 1, 3\n";
  for (int k = 0; k < 6; ++k) {
    file << "*STEP\n*STATIC\n*BOUNDARY\n";
    for (int i : solid.upper) {
      const Vector3d u = motionOf(solid.nodes[i], k);
      for (int axis = 0; axis < 3; ++axis) {
        file << i + 1 << ", " << axis + 1 << ", " << axis + 1 << ", " << u[axis] << '\n';
      }
    }
    file << "*NODE PRINT, NSET=UPPER\nRF\n*END STEP\n";
  }
}

// Sums CalculiX's table of the nodes' forces for each step: (6 x 6) force and moment about the
// origin per motion. False if the tables are not complete.
bool readStiffness(const std::filesystem::path& path, const Solid& solid, Matrix6d* K) {
  std::ifstream file(path);
  K->setZero();
  int step = -1;
  size_t rows = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    int node;
    Vector3d force;
    if (line.find("forces (fx,fy,fz) for set UPPER") != std::string::npos) {
      ++step;
    } else if (step >= 0 && step < 6 && fields >> node >> force.x() >> force.y() >> force.z()) {
      K->block<3, 1>(0, step) += force;
      K->block<3, 1>(3, step) += solid.nodes[node - 1].cross(force);
      ++rows;
    }
  }
  return step == 5 && rows == 6 * solid.upper.size();
}

class CalculiX : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v ccx > /dev/null") != 0) {
      GTEST_SKIP() << "CalculiX's ccx is not installed (Debian package calculix-ccx)";
    }
    std::string folder = testing::TempDir() + "calculix_XXXXXX";
    ASSERT_TRUE(mkdtemp(folder.data()));
    folder_ = folder;
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  Matrix6d stiffness(const Solid& solid, double nu) {
    writeDeck(folder_ / "disc.inp", solid, nu);
    std::filesystem::remove(folder_ / "disc.dat");
    const std::string command =
        "cd '" + folder_.string() + "' && OMP_NUM_THREADS=1 ccx disc > log.txt 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0);
    Matrix6d K;
    EXPECT_TRUE(readStiffness(folder_ / "disc.dat", solid, &K)) << "no forces in disc.dat";
    return K;
  }

  std::filesystem::path folder_;
};

// Each tet a cell of its own: plain linear tets, as CalculiX's C3D4.
DiscMesh withoutCells(DiscMesh mesh) {
  mesh.cells.resize(mesh.tets.size());
  std::iota(mesh.cells.begin(), mesh.cells.end(), 0);
  mesh.hoops.clear();
  for (const auto& t : mesh.tets) {
    // Any edge that is not upright will do: there are no fibres.
    double longest = 0;
    std::array<int, 2> hoop = {};
    for (int i : t) {
      for (int j : t) {
        const double length =
            (mesh.rest_positions[j] - mesh.rest_positions[i]).head<2>().squaredNorm();
        if (length <= longest) continue;
        longest = length;
        hoop = {i, j};
      }
    }
    mesh.hoops.push_back(hoop);
  }
  return mesh;
}

double relativeDifference(const Matrix6d& actual, const Matrix6d& expected) {
  double difference = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) {
      difference = std::max(difference, std::abs(actual(i, k) - expected(i, k)) /
                                            std::sqrt(expected(i, i) * expected(k, k)));
    }
  }
  return difference;
}

TEST_F(CalculiX, HasOurStiffnessOnTheSameTets) {
  const DiscMesh mesh = withoutCells(makeDiscMesh(kShape));
  for (double nu : {0.3, 0.45}) {
    const Matrix6d expected = stiffness(linearTets(mesh), nu);
    const DiscMaterial material = homogeneousMaterial(kModulus, nu);
    const double tangent =
        relativeDifference(DiscElasticity(mesh, material).bound_stiffness, expected);
    // And what the solver answers to small motions.
    Matrix6d secant;
    ReferenceDisc disc(mesh, material);
    for (int k = 0; k < 6; ++k) {
      const double size = k < 3 ? 1e-7 : 1e-5;  // [m], [rad]
      DiscPose pose;
      if (k < 3) {
        pose.position[k] = size;
      } else {
        pose.rotation = Eigen::AngleAxisd(size, Vector3d::Unit(k - 3));
      }
      disc.reset();
      disc.solve(pose, 100, 1e-10);
      secant.col(k) = -asVector(disc.wrench(), 1) / size;
    }
    const double solved = relativeDifference(secant, expected);
    printf("nu %.2f: tangent within %.1g of CalculiX's, small motions within %.1g\n", nu, tangent,
           solved);
    EXPECT_LT(tangent, 1e-5);
    EXPECT_LT(solved, 1e-3);  // curvature
  }
}

// The nucleus cut into cells like those of the annulus: 12 sectors, two halves.
DiscMesh withCellsInNucleus(DiscMesh mesh) {
  const int first = static_cast<int>(mesh.hoops.size());
  const Vector3d middle = mesh.rest_positions[0];
  for (size_t e = 0; e < mesh.tets.size(); ++e) {
    if (mesh.cells[e] != DiscMesh::kNucleus) continue;
    Vector3d centre = Vector3d::Zero();
    for (int i : mesh.tets[e]) centre += (mesh.rest_positions[i] - middle) / 4;
    const double turn = std::atan2(centre.y(), centre.x()) / (2 * M_PI) + 1;
    mesh.cells[e] = first + static_cast<int>(12 * turn) % 12 * 2 + (centre.z() + middle.z() > 0);
  }
  mesh.hoops.resize(first + 24, mesh.hoops[0]);
  return mesh;
}

// Linear tets lock as the material becomes incompressible. Cells of one dilatation, on the same
// nodes, are nearer to quadratic tets of half the size. What bending lacks is the nucleus' doing,
// which is one cell and has one pressure: a fluid, where the other program has a solid.
TEST_F(CalculiX, ShowsThatCellsDoNotLock) {
  const double nu = 0.45;
  const DiscMesh mesh = makeDiscMesh(kShape), fine = makeDiscMesh(kShape, 2);
  const auto ours = [&](const DiscMesh& cells) {
    return DiscElasticity(cells, homogeneousMaterial(kModulus, nu)).bound_stiffness;
  };
  const Matrix6d cells = ours(mesh), solid = ours(withCellsInNucleus(mesh));
  const Matrix6d tets = stiffness(linearTets(mesh), nu);
  const Matrix6d fine_tets = stiffness(linearTets(fine), nu);
  const Matrix6d converged = stiffness(quadraticTets(fine), nu);
  printf(
      "nu = %.2f         C3D10, half size  C3D4, half size  C3D4      cells     in nucleus too\n",
      nu);
  for (int k = 0; k < 6; ++k) {
    const auto over = [&](const Matrix6d& K) { return 100 * (K(k, k) / converged(k, k) - 1); };
    printf("%-17s %8.4g %s  %+8.1f %%      %+8.1f %%%+8.1f %%%+8.1f %%\n", kMotions[k],
           converged(k, k) * (k < 3 ? 1e-3 : kDegree), k < 3 ? "N/mm  " : "Nm/deg", over(fine_tets),
           over(tets), over(cells), over(solid));
    EXPECT_GT(over(tets), over(fine_tets)) << kMotions[k];
    EXPECT_LT(std::abs(over(cells)), over(tets)) << kMotions[k];
    EXPECT_LT(std::abs(over(solid)), over(tets)) << kMotions[k];
  }
  EXPECT_NEAR(cells(2, 2) / converged(2, 2), 1, 0.02);
}

}  // namespace
}  // namespace torso
