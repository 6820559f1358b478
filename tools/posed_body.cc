// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/posed_body.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tools/error.h"
#include "tools/measured_man.h"
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = EIGEN_PI / 180, kGravity = 9.81;
constexpr double kStep = 1.0 / 200;  // what stands still does not depend on it
constexpr double kLimbStiffness = 40;
constexpr int kLumbarLevels = 6;  // L5/S1 .. T12/L1
// At rest: over a tenth of a second pressures change by less than this, what the discs' floats
// leave, and servos that keep the posture are as near to it as this.
constexpr double kRestPressure = 2e3, kRestShare = 4e-3, kLongest = 8;  // [Pa], -, [s]
constexpr double kPosture = 2e-3;                                       // [rad]
// Of a servo's error that is added to its target every tenth of a second, so that thorax, neck and
// limbs stay in the posture under any load. Without it 20 kg on stretched arms bend the thorax by
// 20 degrees.
constexpr double kCorrection = 0.2;

// Each pair of ribs between rib cage and spine, in place of the models' bushings, which are soft
// for the sake of large steps and let the cage give way by centimetres under what the arms hold: 24
// costovertebral joints of 20 N/mm (28 N for 1.1 - 1.6 mm: J Biomech 163:111923, 2024) at ten
// places. Stiffness and damping [N/m, Ns/m, Nm/rad, Nms/rad].
constexpr const char* kCostalBushing = "4.8e4 960 5 1";

// Area over which pressure in the abdomen pushes on the diaphragm [m^2]: McGill and Norman 1987,
// Ergonomics 30:1565-1588, from scans; recalled. Twice as much was assumed before them.
constexpr double kDiaphragmArea = 243e-4;

// The load as it is drawn: a crate of beer [m].
constexpr const char* kLoad = "load";
const Vector3d kCrate(0.15, 0.2, 0.14);  // half its sizes

constexpr const char* kHeld[] = {"pelvis", "left_foot", "right_foot", "ribcage", "head"};

// A bed holds thorax and head against sinking and turning, but lets them slide along the body: skin
// and mattress resist that with some 10 N/mm (estimated), the lumbar spine with 150. They lie on
// sleds without mass, of this armature [kg] and damping [Ns/m], which come to rest soon.
constexpr double kSledArmature = 10, kSledDamping = 1e3;
bool liesOnSled(const std::string& body) { return body == "ribcage" || body == "head"; }

Isometry3d pitchAbout(const Vector3d& point, double pitch) {
  Isometry3d X = Isometry3d::Identity();
  X.translate(point);
  X.rotate(AngleAxisd(pitch, Vector3d::UnitY()));
  X.translate(-point);
  return X;
}

Vector3d sitePosition(const mjModel* m, const mjData* d, const std::string& site) {
  return Vector3d(d->site_xpos + 3 * mj_name2id(m, mjOBJ_SITE, site.c_str()));
}

int bodyId(const mjModel* m, const std::string& body) {
  return mj_name2id(m, mjOBJ_BODY, body.c_str());
}

// A point of a body whose frame has the standing axes, in the world.
Vector3d bodyPoint(const mjModel* m, const mjData* d, const std::string& body,
                   const Vector3d& local) {
  const int id = bodyId(m, body);
  Vector3d p;
  mju_rotVecMat(p.data(), local.data(), d->xmat + 9 * id);
  return p + Vector3d(d->xpos + 3 * id);
}

void setBall(const mjModel* m, mjData* d, const std::string& joint, double pitch) {
  for (const char* side : {"left_", "right_"}) {
    const int j = mj_name2id(m, mjOBJ_JOINT, (side + joint).c_str());
    mjtNum* q = d->qpos + m->jnt_qposadr[j];
    q[0] = std::cos(pitch / 2);
    q[1] = q[3] = 0;
    q[2] = std::sin(pitch / 2);
  }
}

void moveFree(const mjModel* m, mjData* d, const std::string& body, const Isometry3d& X) {
  mjtNum* q = d->qpos + m->jnt_qposadr[m->body_jntadr[bodyId(m, body)]];
  const Vector3d p = X * Vector3d(q);
  const Quaterniond r = Quaterniond(X.linear()) * Quaterniond(q[3], q[4], q[5], q[6]);
  mju_copy3(q, p.data());
  q[3] = r.w(), q[4] = r.x(), q[5] = r.y(), q[6] = r.z();
}

}  // namespace

double PosedBody::discArea(int disc) const { return outlineArea(anatomy_.discs[disc].shape); }

PosedBody::PosedBody(const Anatomy& anatomy, const Skeleton& skeleton, const std::string& bones)
    : anatomy_(anatomy) {
  MjcfOptions options;
  options.limbs = true;
  options.bones = !bones.empty();
  options.mesh_dir = bones;
  options.muscles = true;
  options.skeleton = &skeleton;
  tinyxml2::XMLDocument document;
  writeMjcf(anatomy, options, document);
  if (options.bones) {
    tinyxml2::XMLDocument scene;
    writeScene(scene);
    for (const tinyxml2::XMLElement* e = scene.RootElement()->FirstChildElement(); e;
         e = e->NextSiblingElement()) {
      document.RootElement()->InsertEndChild(e->DeepClone(&document));
    }
    Element load(document.RootElement()->FirstChildElement("worldbody"), "body");
    load.set("name", kLoad).set("mocap", "true");
    Element(load, "geom")
        .set("type", "box")
        .set("size", kCrate)
        .set("rgba", {0.55, 0.4, 0.2, 1})
        .set("mass", 0);
  }
  tinyxml2::XMLElement* equality = document.RootElement()->FirstChildElement("equality");
  for (const std::string body : kHeld) {
    tinyxml2::XMLElement* weld = document.NewElement("weld");
    weld->SetAttribute("name", ("held_" + body).c_str());
    weld->SetAttribute("body1", body.c_str());
    if (liesOnSled(body)) {
      Element sled(document.RootElement()->FirstChildElement("worldbody"), "body");
      sled.set("name", "bed_" + body);
      Element(sled, "joint")
          .set("type", "slide")
          .set("axis", {0, 0, 1})
          .set("armature", kSledArmature)
          .set("damping", kSledDamping);
      Element(sled, "inertial")
          .set("pos", {0, 0, 0})
          .set("mass", 1e-6)
          .set("diaginertia", {1e-6, 1e-6, 1e-6});
      weld->SetAttribute("body2", ("bed_" + body).c_str());
    }
    weld->SetAttribute("solref", "0.01 1");
    equality->InsertEndChild(weld);
  }
  for (tinyxml2::XMLElement* e =
           document.RootElement()->FirstChildElement("custom")->FirstChildElement("numeric");
       e; e = e->NextSiblingElement("numeric")) {
    if (e->Attribute("name", "bushing:ribcage")) e->SetAttribute("data", kCostalBushing);
  }
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  m_ = compileModel(printer.CStr(), "body");
  torsoOf(m_.get(), "body");
  m_->opt.timestep = kStep;
  // Facets are pairs of their own; what else would touch is posed or held.
  std::fill_n(m_->geom_contype, m_->ngeom, 0);
  std::fill_n(m_->geom_conaffinity, m_->ngeom, 0);
  for (int i = 0; i < m_->nu; i++) {
    if (m_->actuator_trntype[i] == mjTRN_TENDON) continue;
    m_->actuator_ctrllimited[i] = m_->actuator_forcelimited[i] = 0;
    if (m_->actuator_trntype[i] == mjTRN_JOINT) {
      m_->actuator_gainprm[mjNGAIN * i] *= kLimbStiffness;
      m_->actuator_biasprm[mjNBIAS * i + 1] *= kLimbStiffness;
    }
  }
  const auto isLumbar = [&](const std::string& servo) {
    return std::any_of(anatomy.discs.begin(), anatomy.discs.begin() + kLumbarLevels,
                       [&](const Disc& disc) { return servo.rfind(disc.name, 0) == 0; });
  };
  for (int i = 0; i < m_->nu; i++) {
    const bool muscle = m_->actuator_trntype[i] == mjTRN_TENDON;
    if (!muscle && !isLumbar(nameOf(m_.get(), mjOBJ_ACTUATOR, i))) posture_servos_.push_back(i);
  }
  for (int j = 0; j < m_->njnt; j++) {
    if (m_->jnt_type[j] != mjJNT_BALL) continue;
    for (int k = 0; k < 3; k++) m_->dof_damping[m_->jnt_dofadr[j] + k] *= kLimbStiffness;
  }
  d_ = makeData(m_.get());
  double sum = 0;
  for (int i = 0; i < kLumbarLevels; i++) {
    lumbar_shares_.push_back(anatomy.range_of_motion.at(anatomy.discs[i].name)[kFlexion].mean);
    sum += lumbar_shares_.back();
  }
  for (double& share : lumbar_shares_) share /= sum;
  pose({});
  relaxed_balance_ = balance(Activity());
}

PosedBody::Posture PosedBody::leaning(const Activity& a, double lean) const {
  Posture p{};
  p.lumbar = a.lumbar_flexion;
  p.thorax = a.thorax_pitch;
  if (a.held == Held::kFeet) {
    p.shin = lean;
    p.thigh = lean - a.knee;
    if (a.whole_body_leans) p.thorax += lean;
  } else if (a.held == Held::kSeat) {
    p.thigh = -a.knee;
  }
  p.pelvis = p.thorax - p.lumbar;
  p.upper_arm = -a.upper_arm;
  p.forearm = -a.forearm;
  return p;
}

void PosedBody::pose(const Posture& p) {
  mjModel* m = m_.get();
  mjData* d = d_.get();
  mj_resetData(m, d);
  mj_kinematics(m, d);
  const Vector3d foot(d->xpos + 3 * bodyId(m, "left_foot"));
  Vector3d hip(d->xpos + 3 * bodyId(m, "left_thigh"));
  hip.y() = 0;
  Isometry3d X = pitchAbout(hip, p.pelvis);
  std::vector<std::pair<std::string, Isometry3d>> moves = {{"pelvis", X}};
  for (std::size_t i = 0; i < anatomy_.vertebrae.size(); i++) {
    if (i < kLumbarLevels) {
      const Vector3d centre = sitePosition(m, d, anatomy_.discs[i].name + "_lower");
      X = X * pitchAbout(centre, lumbar_shares_[i] * p.lumbar);
    }
    moves.emplace_back(anatomy_.vertebrae[i].name, X);
  }
  moves.emplace_back("ribcage", X);
  for (const auto& [body, move] : moves) moveFree(m, d, body, move);
  setBall(m, d, "hip", p.thigh - p.pelvis);
  setBall(m, d, "knee", p.shin - p.thigh);
  setBall(m, d, "ankle", -p.shin);
  setBall(m, d, "glenohumeral", p.upper_arm - p.thorax);
  setBall(m, d, "elbow", p.forearm - p.upper_arm);
  mj_kinematics(m, d);
  Isometry3d shift = Isometry3d::Identity();
  shift.translate(foot - Vector3d(d->xpos + 3 * bodyId(m, "left_foot")));
  for (const auto& [body, move] : moves) moveFree(m, d, body, shift);
  mj_kinematics(m, d);
  mj_comPos(m, d);
}

Vector3d PosedBody::grip() const {
  const Vector3d middle = 0.5 * (anatomy_.landmark("hand_tip") - anatomy_.landmark("wrist"));
  Vector3d p = bodyPoint(m_.get(), d_.get(), "left_hand", middle);
  p.y() = 0;
  return p;
}

Vector3d PosedBody::loadPoint(const Activity& a) const {
  Vector3d p = grip();
  if (!a.load_in_hands) {
    // Before the sternum at the height of the load, or its end that is nearest.
    const Vector3d top = anatomy_.landmark("suprasternal_notch_IJ");
    const Vector3d upper = bodyPoint(m_.get(), d_.get(), "ribcage", Vector3d::Zero());
    const Vector3d lower =
        bodyPoint(m_.get(), d_.get(), "ribcage", anatomy_.landmark("xiphoid_PX") - top);
    const double share = std::clamp((p.z() - lower.z()) / (upper.z() - lower.z()), 0., 1.);
    p.x() = lower.x() + share * (upper.x() - lower.x()) + a.load_distance;
  }
  return p;
}

// Centre of mass of body and load before the feet, in the pose.
double PosedBody::balance(const Activity& a) {
  const double mass = anatomy_.mass(), load = a.load;
  const Vector3d com(d_->subtree_com);
  const double x = load > 0 ? (mass * com.x() + load * loadPoint(a).x()) / (mass + load) : com.x();
  return x - d_->xpos[3 * bodyId(m_.get(), "left_foot")];
}

void PosedBody::checkSpine(const Activity& a) const {
  const Motion motion = a.lumbar_flexion > 0 ? kFlexion : kExtension;
  for (int i = 0; i < kLumbarLevels; i++) {
    const std::string& disc = anatomy_.discs[i].name;
    const double bend = lumbar_shares_[i] * std::abs(a.lumbar_flexion);
    const double end = anatomy_.range_of_motion.at(disc)[motion].high;
    if (bend > end) {
      throw Error(fmt::format(
          "activities.csv, {}: lumbar_flexion_deg of {:.0f} bends {} by {:.1f} deg, published "
          "ranges end at {:.1f}",
          a.name, a.lumbar_flexion / kDegree, disc, bend / kDegree, end / kDegree));
    }
  }
}

void PosedBody::take(const Activity& a) {
  checkSpine(a);
  double lean = 0;
  if (a.held == Held::kFeet) {
    double low = -0.35, high = 0.6;  // as far as ankles go [rad]
    const auto ahead = [&](double angle) {
      pose(leaning(a, angle));
      return balance(a) - relaxed_balance_;
    };
    if (ahead(low) > 0 || ahead(high) < 0) {
      throw Error(fmt::format(
          "activities.csv, {}: no lean of the ankles from {:.0f} to {:.0f} deg balances "
          "the body with {} kg on its feet: change load_kg, load_mm or the posture",
          a.name, low / kDegree, high / kDegree, a.load));
    }
    for (int i = 0; i < 40; i++) {
      lean = (low + high) / 2;
      (ahead(lean) > 0 ? high : low) = lean;
    }
  }
  pose(leaning(a, lean));
  const double reach = loadPoint(a).x() - grip().x();
  if (a.load > 0 && std::abs(reach) > kCrate.x()) {
    throw Error(fmt::format(
        "activities.csv, {}: the load's centre is {:.0f} mm {} the hands, which hold it "
        "up to {:.0f} mm from there: change load_mm or the arms",
        a.name, 1e3 * std::abs(reach), reach > 0 ? "beyond" : "short of", 1e3 * kCrate.x()));
  }
  mjModel* m = m_.get();
  mjData* d = d_.get();
  activity_ = a;
  abdominal_pressure_ = 0;
  lean_ = lean;
  const Vector3d gravity = kGravity * a.gravity;
  mju_copy3(m->opt.gravity, gravity.data());
  for (const std::string body : kHeld) {
    const int e = mj_name2id(m, mjOBJ_EQUALITY, ("held_" + body).c_str());
    const int b = bodyId(m, body);
    m->eq_active[e] = !liesOnSled(body) || a.held == Held::kBed;
    mjtNum* data = m->eq_data + mjNEQDATA * e;  // anchor in the world; the world in the body
    mju_zero3(data);
    const Vector3d to_world = -Vector3d(d->xpos + 3 * b);
    mju_rotVecMatT(data + 3, to_world.data(), d->xmat + 9 * b);
    mju_negQuat(data + 6, d->xquat + 4 * b);
  }
  mj_forward(m, d);
  for (int i = 0; i < m->nu; i++) {
    if (m->actuator_trntype[i] != mjTRN_TENDON) d->ctrl[i] = d->actuator_length[i];
  }
  aims_.assign(d->actuator_length, d->actuator_length + m->nu);
}

Vector3d PosedBody::diaphragm() const {
  return bodyPoint(m_.get(), d_.get(), "ribcage",
                   anatomy_.landmark("diaphragm") - anatomy_.landmark("suprasternal_notch_IJ"));
}

Vector3d PosedBody::abdominalForce() const {
  const Vector3d floor = bodyPoint(m_.get(), d_.get(), "pelvis", anatomy_.landmark("pelvic_floor"));
  return abdominal_pressure_ * kDiaphragmArea * (diaphragm() - floor).normalized();
}

// Half of the load on each hand, as if the hands held it at its centre, and pressure in the
// abdomen.
void PosedBody::applyForces() {
  const int ribcage = bodyId(m_.get(), "ribcage"), pelvis = bodyId(m_.get(), "pelvis");
  const Vector3d force = abdominalForce();
  const auto apply = [&](int body, const Vector3d& f, const Vector3d& point) {
    const Vector3d torque = (point - Vector3d(d_->xipos + 3 * body)).cross(f);
    mju_copy3(d_->xfrc_applied + 6 * body, f.data());
    mju_copy3(d_->xfrc_applied + 6 * body + 3, torque.data());
  };
  apply(ribcage, force, diaphragm());
  apply(pelvis, -force, diaphragm());
  if (activity_.load == 0) return;
  const Vector3d point = loadPoint(activity_);
  for (const char* body : {"left_hand", "right_hand"}) {
    const int id = bodyId(m_.get(), body);
    const Vector3d force = activity_.load / 2 * kGravity * activity_.gravity;
    Vector3d arm = point - Vector3d(d_->xipos + 3 * id);
    arm.y() = 0;
    const Vector3d torque = arm.cross(force);
    mju_copy3(d_->xfrc_applied + 6 * id, force.data());
    mju_copy3(d_->xfrc_applied + 6 * id + 3, torque.data());
  }
}

void PosedBody::showLoad() {
  const int load = bodyId(m_.get(), kLoad);
  if (load < 0) return;
  const bool carried = activity_.load > 0;
  Vector3d p(d_->xpos + 3 * bodyId(m_.get(), "pelvis"));
  if (carried) p = loadPoint(activity_);
  if (activity_.load_in_hands) p.z() -= kCrate.z();
  mju_copy3(d_->mocap_pos + 3 * m_->body_mocapid[load], p.data());
  m_->geom_rgba[4 * m_->body_geomadr[load] + 3] = carried;
}

void PosedBody::settle() {
  mjModel* m = m_.get();
  mjData* d = d_.get();
  const int ndisc = static_cast<int>(anatomy_.discs.size());
  std::vector<double> before(ndisc, 0);
  const int chunk = static_cast<int>(std::lround(0.1 / kStep));
  const double start = d->time;
  for (bool rest = false; !rest;) {
    if (d->time - start > kLongest) {
      throw Error(fmt::format(
          "activities.csv, {}: not at rest in this posture after {} s: its joints may be "
          "too far bent",
          activity_.name, kLongest));
    }
    std::vector<double> mean(ndisc, 0);
    for (int k = 0; k < chunk; k++) {
      applyForces();
      mj_step(m, d);
      for (int i = 0; i < ndisc; i++) mean[i] += torso_discNucleusPressure(m, d, i) / chunk;
    }
    double worst = 0;
    for (const int i : posture_servos_) {
      const double error = aims_[i] - d->actuator_length[i];
      d->ctrl[i] += kCorrection * error;
      worst = std::max(worst, std::abs(error));
    }
    const std::string warning = firstWarning(d);
    if (!warning.empty()) throw Error(fmt::format("{}: {}", activity_.name, warning));
    rest = worst < kPosture;
    for (int i = 0; i < ndisc; i++) {
      rest &= std::abs(mean[i] - before[i]) < kRestPressure + kRestShare * std::abs(mean[i]);
    }
    before = mean;
  }
  showLoad();
  mj_forward(m, d);
}

}  // namespace torso::tools
