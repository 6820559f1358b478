// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/spine_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/median.h"
#include "model/pitch.h"

namespace torso {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kFade = 4;            // levels over which a bone's own size fades into the body's
constexpr double kThinnest = 0.25;  // of a disc's edge, over its middle height
constexpr double kJointGap = 2e-3;  // two cartilages, as in the generated bones

// Sizes over those of the tables.
struct Ratios {
  double width = 1, depth = 1, height = 1;
  double mean() const { return std::cbrt(width * depth * height); }
};

Ratios ratiosOf(const Vertebra& v, const VertebraLandmarks& l) {
  return {(l.upper_endplate.width + l.lower_endplate.width) /
              (v.upper_endplate_width + v.lower_endplate_width),
          (l.upper_endplate.height + l.lower_endplate.height) /
              (v.upper_endplate_depth + v.lower_endplate_depth),
          (l.body_height_anterior + l.body_height_posterior) /
              (v.body_height_anterior + v.body_height_posterior)};
}

Landmark transformed(const Landmark& l, const Isometry3d& X) {
  return {X * l.centre, X.linear() * l.normal, l.width, l.height};
}
Landmark mirroredY(const Landmark& l) {
  return {mirror(l.centre), mirror(l.normal), l.width, l.height};
}
// Mean of a left face and the mirror image of the right one.
Landmark leftOf(const std::array<Landmark, 2>& faces) {
  const Landmark right = mirroredY(faces[1]);
  return {(faces[0].centre + right.centre) / 2, (faces[0].normal + right.normal).normalized(),
          (faces[0].width + right.width) / 2, (faces[0].height + right.height) / 2};
}

class Fitter {
 public:
  Fitter(const Anatomy& anatomy, const SpineLandmarks& found) : base_(anatomy), found_(found) {
    for (const auto& [level, landmarks] : found) base_.vertebra(level);
  }

  SpineFit run() {
    a_ = base_;
    resizeVertebrae();
    checkCommonFrame();
    stack();
    faces();
    moveAlong();
    SpineFit out;
    for (const auto& [level, l] : found_) {
      out.placement[level] = a_.vertebra(level).frame() * l.frame.inverse();
    }
    out.anatomy = a_;
    out.common_frame = common_;
    out.remarks = remarks_;
    return out;
  }

 private:
  int count() const { return static_cast<int>(a_.vertebrae.size()); }
  const VertebraLandmarks* landmarksOf(int i) const {
    const auto it = found_.find(a_.vertebrae[i].name);
    return it == found_.end() ? nullptr : &it->second;
  }

  // Of the nearest vertebrae found below and above; fading to 1 where there is none further on.
  Ratios ratiosAt(int i) const {
    const auto nearest = [&](int step, int* distance) -> const VertebraLandmarks* {
      for (int k = i; k >= 0 && k < count(); k += step) {
        *distance = std::abs(k - i);
        if (const VertebraLandmarks* l = landmarksOf(k)) return l;
      }
      return nullptr;
    };
    int down = 0, up = 0;
    const VertebraLandmarks *below = nearest(-1, &down), *above = nearest(1, &up);
    const auto ratios = [&](int distance, const VertebraLandmarks& l) {
      return ratiosOf(base_.vertebrae[i + distance], l);
    };
    const auto blend = [](const Ratios& p, const Ratios& q, double t) {
      return Ratios{p.width + t * (q.width - p.width), p.depth + t * (q.depth - p.depth),
                    p.height + t * (q.height - p.height)};
    };
    if (below && above) {
      const double t = down + up > 0 ? static_cast<double>(down) / (down + up) : 0;
      return blend(ratios(-down, *below), ratios(up, *above), t);
    }
    if (!below && !above) return {};
    const Ratios known = below ? ratios(-down, *below) : ratios(up, *above);
    return blend(known, Ratios(), std::min(1.0, static_cast<double>(below ? down : up) / kFade));
  }

  void resizeVertebrae() {
    for (int i = 0; i < count(); i++) {
      Vertebra& v = a_.vertebrae[i];
      const Ratios r = ratiosAt(i);
      ratios_.push_back(r);
      v.upper_endplate_width *= r.width;
      v.lower_endplate_width *= r.width;
      v.upper_endplate_depth *= r.depth;
      v.lower_endplate_depth *= r.depth;
      v.body_height_anterior *= r.height;
      v.body_height_posterior *= r.height;
      for (double* x : {&v.canal_width, &v.canal_depth, &v.pedicle_width, &v.pedicle_height,
                        &v.pedicle_length, &v.transverse_process_span, &v.spinous_tip_distance}) {
        *x *= r.mean();
      }
      for (ArticularFacet& f : a_.facets) {
        if (f.level != v.name) continue;
        f.width *= r.mean();
        f.height *= r.mean();
        f.position = f.position.cwiseProduct(Vector3d(r.depth, r.width, r.height));
      }
      for (CostalJoint& joint : a_.costal_joints) {
        if (joint.level != v.name) continue;
        joint.position = joint.position.cwiseProduct(Vector3d(r.depth, r.width, r.height));
      }
      upper_tilt_.push_back(v.upper_endplate_pitch - v.pitch);
      lower_tilt_.push_back(v.lower_endplate_pitch - v.pitch);
      const double half = (v.body_height_anterior + v.body_height_posterior) / 4;
      upper_centre_.push_back({0, 0, half});
      lower_centre_.push_back({0, 0, -half});
      if (const VertebraLandmarks* l = landmarksOf(i)) measure(i, *l);
    }
  }

  void measure(int i, const VertebraLandmarks& l) {
    Vertebra& v = a_.vertebrae[i];
    const Isometry3d I = l.frame.inverse();
    v.upper_endplate_width = l.upper_endplate.width;
    v.lower_endplate_width = l.lower_endplate.width;
    v.upper_endplate_depth = l.upper_endplate.height;
    v.lower_endplate_depth = l.lower_endplate.height;
    v.body_height_anterior = l.body_height_anterior;
    v.body_height_posterior = l.body_height_posterior;
    v.canal_width = l.canal_width;
    v.canal_depth = l.canal_depth;
    const Vector3d left = I * l.transverse_tip[0], right = I * l.transverse_tip[1];
    v.transverse_process_span = left.y() - right.y();
    const Vector3d tip = I * l.spinous_tip;
    v.spinous_tip_distance = std::hypot(tip.x(), tip.z());
    v.spinous_declination = std::atan2(-tip.z(), -tip.x());
    const Vector3d up = I.linear() * l.upper_endplate.normal;
    const Vector3d down = -(I.linear() * l.lower_endplate.normal);
    upper_tilt_[i] = std::atan2(up.x(), up.z());
    lower_tilt_[i] = std::atan2(down.x(), down.z());
    upper_centre_[i] = I * l.upper_endplate.centre;
    lower_centre_[i] = I * l.lower_endplate.centre;
    upper_centre_[i].y() = lower_centre_[i].y() = 0;
    for (ArticularFacet& f : a_.facets) {
      if (f.level != v.name) continue;
      const Landmark face =
          leftOf({transformed(l.superior_face[0], I), transformed(l.superior_face[1], I)});
      f.position = face.centre;
      f.normal = face.normal;
      f.width = face.width;
      f.height = face.height;
    }
    // The rib's tubercle lies before the tip of the transverse process.
    const Vector3d transverse = (left + mirror(right)) / 2;
    const double before = 0.004 * a_.length_scale;
    for (CostalJoint& joint : a_.costal_joints) {
      if (joint.level != v.name || !joint.costotransverse) continue;
      joint.position = {transverse.x() + before,
                        std::min(joint.position.y(), transverse.y() - before), transverse.z()};
    }
  }

  // True if the meshes lie to each other about as the vertebrae of the tables do.
  void checkCommonFrame() {
    common_ = found_.size() > 1;
    const VertebraLandmarks* last = nullptr;
    int last_index = 0;
    for (int i = 0; i < count(); i++) {
      const VertebraLandmarks* l = landmarksOf(i);
      if (!l) continue;
      if (last) {
        const Vector3d r = last->frame.inverse() * l->frame.translation();
        const double expected =
            (base_.vertebrae[i].position - base_.vertebrae[last_index].position).norm();
        const Matrix3d turn = last->frame.linear().transpose() * l->frame.linear();
        const double angle = AngleAxisd(turn).angle();
        const bool fits = r.z() > 0.7 * expected && r.norm() < 1.6 * expected &&
                          std::abs(r.y()) < 0.3 * expected && angle < 0.35 * (1 + i - last_index);
        common_ = common_ && fits;
      }
      last = l;
      last_index = i;
    }
  }

  double basePitch(int i) const { return base_.vertebrae[i].pitch; }

  void stack() {
    std::vector<double> pitch;
    for (int i = 0; i < count(); i++) pitch.push_back(basePitch(i));
    if (common_) pitchesOfFile(&pitch);
    Vector3d top = Vector3d::Zero();  // upper endplate's centre of the bone below
    double slope = a_.sacral_slope;   // and its pitch
    double depth_below = base_.discs.front().shape.depth * ratios_[0].depth;
    double width_below = base_.discs.front().shape.width * ratios_[0].width;
    int file_anchor = -1;  // last level placed whose mesh is known
    for (int i = 0; i < count(); i++) {
      Vertebra& v = a_.vertebrae[i];
      Disc& disc = a_.discs[i];
      const double base_middle = (disc.shape.height_anterior + disc.shape.height_posterior) / 2;
      const double size =
          i > 0 ? (ratios_[i].mean() + ratios_[i - 1].mean()) / 2 : ratios_[i].mean();
      double middle = base_middle * size;
      disc.shape.depth = (depth_below + v.lower_endplate_depth) / 2;
      disc.shape.width = (width_below + v.lower_endplate_width) / 2;
      const double steepest = std::atan(2 * (1 - kThinnest) * middle / disc.shape.depth);
      double wedge = slope - (pitch[i] + lower_tilt_[i]);
      const bool placed = common_ && landmarksOf(i) && file_anchor == i - 1 && i > 0;
      if (std::abs(wedge) > steepest && !placed) {
        const double limited = std::clamp(wedge, -steepest, steepest);
        pitch[i] += wedge - limited;
        wedge = limited;
      }
      v.pitch = pitch[i];
      v.upper_endplate_pitch = v.pitch + upper_tilt_[i];
      v.lower_endplate_pitch = v.pitch + lower_tilt_[i];
      double disc_pitch = (slope + v.lower_endplate_pitch) / 2;
      Vector3d bottom = top + middle * upAt(disc_pitch);
      v.position = bottom - pitched(Vector3d::Zero(), v.pitch) * lower_centre_[i];
      if (placed) {
        // Straight above the neighbour's mesh, as the file has it.
        const VertebraLandmarks &l = *landmarksOf(i), &below = *landmarksOf(i - 1);
        Vector3d r = below.frame.inverse() * l.frame.translation();
        r.y() = 0;
        const Vector3d position = a_.vertebrae[i - 1].frame() * r;
        const Vector3d at = position + pitched(Vector3d::Zero(), v.pitch) * lower_centre_[i];
        const double height = (at - top).dot(upAt(disc_pitch));
        const double edge = disc.shape.depth / 2 * std::tan(std::abs(wedge));
        const double least = std::max(0.35 * middle, edge / (1 - kThinnest));
        const double given = std::clamp(height, least, 2.5 * middle);
        if (given != height) {
          remarks_.push_back("disc " + disc.name + ": the meshes leave " + mm(height) +
                             " between the endplates; made " + mm(given));
        }
        v.position = position + (given - height) * upAt(disc_pitch);
        bottom = at + (given - height) * upAt(disc_pitch);
        middle = given;
      }
      if (landmarksOf(i)) file_anchor = i;
      setDisc(&disc, top, bottom, slope, v.lower_endplate_pitch, middle);
      top = v.frame() * upper_centre_[i];
      slope = v.upper_endplate_pitch;
      depth_below = v.upper_endplate_depth;
      width_below = v.upper_endplate_width;
    }
    // C2 keeps its place to C3, on a disc of the tables' height.
    const Vertebra &c3 = a_.vertebrae.back(), &old = base_.vertebrae.back();
    Disc& disc = a_.discs.back();
    const Vector3d old_top =
        old.frame() * Vector3d(0, 0, (old.body_height_anterior + old.body_height_posterior) / 4);
    head_shift_ = top - old_top;
    const double turn = c3.upper_endplate_pitch - old.upper_endplate_pitch;
    a_.c2.position = base_.c2.position + head_shift_;
    const double middle = (disc.shape.height_anterior + disc.shape.height_posterior) / 2;
    disc.frame =
        pitched(disc.frame.translation() + head_shift_, pitchOf(disc.frame.linear()) + turn / 2);
    disc.shape.depth = (depth_below + a_.c2.lower_endplate_depth) / 2;
    disc.shape.width = (width_below + a_.c2.lower_endplate_width) / 2;
    const double edge = std::clamp(
        disc.shape.depth / 2 * std::tan(c3.upper_endplate_pitch - a_.c2.lower_endplate_pitch),
        -(1 - kThinnest) * middle, (1 - kThinnest) * middle);
    disc.shape.height_anterior = middle + edge;
    disc.shape.height_posterior = middle - edge;
  }

  static std::string mm(double metres) {
    return std::to_string(std::lround(metres * 1e4) / 10.0).substr(0, 5) + " mm";
  }

  // Pitches that the meshes have to each other; the lowest keeps the standing spine's.
  void pitchesOfFile(std::vector<double>* pitch) const {
    int last = -1;
    for (int i = 0; i < count(); i++) {
      const VertebraLandmarks* l = landmarksOf(i);
      if (!l) continue;
      if (last >= 0) {
        const Matrix3d turn = landmarksOf(last)->frame.linear().transpose() * l->frame.linear();
        const double to = (*pitch)[last] + pitchOf(turn);
        // Levels between share the difference.
        const double from_error = (*pitch)[last] - basePitch(last), to_error = to - basePitch(i);
        for (int k = last + 1; k < i; k++) {
          const double t = static_cast<double>(k - last) / (i - last);
          (*pitch)[k] = basePitch(k) + from_error + t * (to_error - from_error);
        }
        (*pitch)[i] = to;
      }
      last = i;
    }
  }

  void setDisc(Disc* disc, const Vector3d& top, const Vector3d& bottom, double lower_pitch,
               double upper_pitch, double middle) const {
    const double wedge = lower_pitch - upper_pitch;
    const double edge = std::clamp(disc->shape.depth / 2 * std::tan(wedge),
                                   -(1 - kThinnest) * middle, (1 - kThinnest) * middle);
    disc->shape.height_anterior = middle + edge;
    disc->shape.height_posterior = middle - edge;
    disc->frame = pitched((top + bottom) / 2, (lower_pitch + upper_pitch) / 2);
  }

  // Superior faces of bones that are not known, from the inferior face above them.
  void faces() {
    for (int i = 0; i < count(); i++) {
      const VertebraLandmarks* l = landmarksOf(i);
      if (!l || (i > 0 && landmarksOf(i - 1))) continue;
      const std::string below = i > 0 ? a_.vertebrae[i - 1].name : "S1";
      const Isometry3d I = l->frame.inverse();
      Landmark face =
          leftOf({transformed(l->inferior_face[0], I), transformed(l->inferior_face[1], I)});
      face = transformed(face, a_.boneFrame(below).inverse() * a_.vertebrae[i].frame());
      for (ArticularFacet& f : a_.facets) {
        if (f.level != below) continue;
        f.position = face.centre + kJointGap * face.normal;
        f.normal = -face.normal;
        f.width = face.width;
        f.height = face.height;
      }
    }
  }

  // How far the spine at a height of the old body has moved.
  Vector3d shiftAt(double z) const {
    double below = 0;
    Vector3d shift = Vector3d::Zero();
    for (int i = 0; i <= count(); i++) {
      const Vertebra &old = i < count() ? base_.vertebrae[i] : base_.c2,
                     &now = i < count() ? a_.vertebrae[i] : a_.c2;
      const Vector3d next = now.position - old.position;
      if (z < old.position.z()) {
        const double t = std::max(0.0, (z - below) / (old.position.z() - below));
        return shift + t * (next - shift);
      }
      below = old.position.z();
      shift = next;
    }
    return shift;
  }

  // What hangs on the spine goes with it: head, shoulder girdle and arms as a whole, the rib cage
  // level by level.
  void moveAlong() {
    const Vector3d girdle = shiftAt(base_.landmark("sternoclavicular_joint_SC").z());
    const auto shiftOf = [&](const std::string& name, const Vector3d& p) -> Vector3d {
      const auto any = [&](std::initializer_list<const char*> starts) {
        return std::any_of(starts.begin(), starts.end(),
                           [&](const char* start) { return name.rfind(start, 0) == 0; });
      };
      if (any({"head", "external_auditory_meatus"})) return head_shift_;
      if (any({"sternoclavicular", "suprasternal", "acromio", "glenohumeral", "clavicle", "scapula",
               "upper_arm", "lower_arm", "elbow", "wrist", "hand"})) {
        return girdle;
      }
      if (any({"xiphoid", "rib_cage", "C7", "T8"})) return shiftAt(p.z());
      return Vector3d::Zero();  // pelvis and legs
    };
    for (auto& [name, p] : a_.landmarks) p += shiftOf(name, p);
    for (Segment& s : a_.segments) s.com += shiftOf(s.name, s.com);
    for (BallJoint& j : a_.joints) j.position += shiftOf(j.name, j.position);
  }

  const Anatomy& base_;
  const SpineLandmarks& found_;
  Anatomy a_;
  bool common_ = false;
  std::vector<Ratios> ratios_;
  std::vector<double> upper_tilt_, lower_tilt_;        // of the endplates in the vertebra [rad]
  std::vector<Vector3d> upper_centre_, lower_centre_;  // of the endplates, vertebra frame [m]
  Vector3d head_shift_ = Vector3d::Zero();
  std::vector<std::string> remarks_;
};

}  // namespace

double spineScale(const Anatomy& anatomy, const SpineLandmarks& found) {
  std::vector<double> sizes;
  for (const auto& [level, l] : found) {
    sizes.push_back(ratiosOf(anatomy.vertebra(level), l).mean());
  }
  return sizes.empty() ? 1 : median(sizes);
}

SpineFit fitSpine(const Anatomy& anatomy, const SpineLandmarks& found) {
  return Fitter(anatomy, found).run();
}

}  // namespace torso
