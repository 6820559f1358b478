// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/muscle_moments.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "model/muscle.h"
#include "tools/error.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr const char* kCutDiscs[] = {"L5/S1", "L4/L5", "L3/L4", "L2/L3", "L1/L2", "T12/L1"};
constexpr const char* kUpperBones[] = {"L5", "L4", "L3", "L2", "L1", "T12"};

Vector3d sitePosition(const mjData* d, int site) { return Vector3d(d->site_xpos + 3 * site); }

}  // namespace

MuscleMoments::MuscleMoments(const mjModel* m) : m_(m), rank_(m->nbody, 0) {
  int count = 0;
  std::vector<int> uppers;
  for (const char* disc : kCutDiscs) {
    Cut cut;
    cut.disc = disc;
    cut.site = mj_name2id(m, mjOBJ_SITE, (cut.disc + "_lower").c_str());
    uppers.push_back(mj_name2id(m, mjOBJ_BODY, kUpperBones[count++]));
    for (const char* motion : {"_flexion", "_lateral_bending", "_axial_rotation"}) {
      cut.servos.push_back(mj_name2id(m, mjOBJ_ACTUATOR, (cut.disc + motion).c_str()));
    }
    if (cut.site < 0 || uppers.back() < 0 ||
        std::count(cut.servos.begin(), cut.servos.end(), -1) > 0) {
      throw Error(std::string("the model has no disc ") + disc + " with servos");
    }
    cuts_.push_back(cut);
  }
  for (int a = 0; a < m->nu; a++) {
    if (m->actuator_trntype[a] == mjTRN_TENDON) muscles_.push_back(a);
  }
  if (muscles_.empty()) throw Error("the model has no muscles");
  // Legs belong to the pelvis, below all cuts; what hangs on none of the lower vertebrae is above.
  const int pelvis = mj_name2id(m, mjOBJ_BODY, "pelvis");
  for (int body = 1; body < m->nbody; body++) {
    const int root = m->body_rootid[body];
    const auto upper = std::find(uppers.begin(), uppers.end(), root);
    rank_[body] = root == pelvis          ? 0
                  : upper == uppers.end() ? static_cast<int>(cuts_.size())
                                          : static_cast<int>(upper - uppers.begin()) + 1;
  }
}

VectorXd MuscleMoments::sections() const {
  VectorXd s(muscles_.size());
  for (std::size_t i = 0; i < muscles_.size(); i++) {
    s[i] = -m_->actuator_gainprm[mjNGAIN * muscles_[i]] / kLargestMuscleStress;
  }
  return s;
}

template <class At>
void MuscleMoments::forCrossings(const mjData* d, const At& at) const {
  for (std::size_t i = 0; i < muscles_.size(); i++) {
    const int tendon = m_->actuator_trnid[2 * muscles_[i]];
    const int* sites = m_->wrap_objid + m_->tendon_adr[tendon];
    for (int k = 0; k + 1 < m_->tendon_num[tendon]; k++) {
      int low = sites[k], high = sites[k + 1];
      if (rank_[m_->site_bodyid[low]] > rank_[m_->site_bodyid[high]]) std::swap(low, high);
      const Vector3d p = sitePosition(d, high);
      const Vector3d direction = (sitePosition(d, low) - p).normalized();
      for (int c = rank_[m_->site_bodyid[low]]; c < rank_[m_->site_bodyid[high]]; c++) {
        at(c, i, p, direction);
      }
    }
  }
}

MatrixXd MuscleMoments::arms(const mjData* d) const {
  MatrixXd A = MatrixXd::Zero(3 * cuts_.size(), muscles_.size());
  forCrossings(d, [&](int c, int i, const Vector3d& p, const Vector3d& direction) {
    A.block<3, 1>(3 * c, i) += (p - sitePosition(d, cuts_[c].site)).cross(direction);
  });
  return A;
}

MatrixXd MuscleMoments::pulls(const mjData* d) const {
  MatrixXd P = MatrixXd::Zero(cuts_.size(), muscles_.size());
  forCrossings(d, [&](int c, int i, const Vector3d&, const Vector3d& direction) {
    const mjtNum* axes = d->site_xmat + 9 * cuts_[c].site;
    P(c, i) -= direction.dot(Vector3d(axes[2], axes[5], axes[8]));
  });
  return P;
}

VectorXd MuscleMoments::externalMoments(const mjData* d) const {
  VectorXd result = VectorXd::Zero(3 * cuts_.size());
  const Vector3d gravity(m_->opt.gravity);
  for (int body = 1; body < m_->nbody; body++) {
    const Vector3d com(d->xipos + 3 * body), torque(d->xfrc_applied + 6 * body + 3);
    const Vector3d force = m_->body_mass[body] * gravity + Vector3d(d->xfrc_applied + 6 * body);
    for (int c = 0; c < rank_[body]; c++) {
      result.segment<3>(3 * c) += (com - sitePosition(d, cuts_[c].site)).cross(force) + torque;
    }
  }
  return result;
}

VectorXd MuscleMoments::servoMoments(const mjData* d) const {
  VectorXd b = VectorXd::Zero(3 * cuts_.size());
  for (std::size_t c = 0; c < cuts_.size(); c++) {
    for (const int servo : cuts_[c].servos) {
      const int refsite = m_->actuator_trnid[2 * servo + 1];
      Vector3d axis;
      mju_rotVecMat(axis.data(), m_->actuator_gear + 6 * servo + 3, d->site_xmat + 9 * refsite);
      b.segment<3>(3 * c) += d->actuator_force[servo] * axis;
    }
  }
  return b;
}

VectorXd MuscleMoments::tensions(const mjData* d) const {
  VectorXd f(muscles_.size());
  for (std::size_t i = 0; i < muscles_.size(); i++) f[i] = -d->actuator_force[muscles_[i]];
  return f;
}

void MuscleMoments::setTensions(mjData* d, const VectorXd& tensions) const {
  for (std::size_t i = 0; i < muscles_.size(); i++) {
    d->ctrl[muscles_[i]] = -tensions[i] / m_->actuator_gainprm[mjNGAIN * muscles_[i]];
  }
}

}  // namespace torso::tools
