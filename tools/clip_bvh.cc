// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "tools/clip_formats.h"
#include "tools/error.h"

namespace torso::tools {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// A limit for damaged files: a recursive reader must not run out of stack.
constexpr int kMaxDepth = 200;

struct Channel {
  bool rotation;
  int axis;  // 0 x, 1 y, 2 z
};

class BvhReader {
 public:
  BvhReader(const std::string& text, const std::string& path) : text_(text), path_(path) {}

  Clip read() {
    clip_.path = path_;
    clip_.up = Vector3d::UnitY();  // by custom; BVH declares neither axes nor unit
    if (lower(word()) != "hierarchy") fail("does not begin with HIERARCHY; this is no BVH file");
    std::string next = lower(word());
    if (next != "root") fail("no ROOT after HIERARCHY: no skeleton");
    while (next == "root") {
      readJoint(-1, 0);
      next = lower(word());
    }
    if (next.empty()) fail("the file is cut short: no MOTION after the skeleton");
    if (next != "motion") fail(fmt::format("'{}' instead of MOTION or ROOT", next));
    readMotion();
    return std::move(clip_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: line {}: {}", path_, line_, what));
  }
  static std::string lower(std::string s) {
    for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return s;
  }
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f'; }

  void skipBlanks() {
    while (at_ < text_.size() && blank(text_[at_])) line_ += text_[at_++] == '\n';
  }
  std::string word() {  // "" at the end
    skipBlanks();
    const size_t begin = at_;
    while (at_ < text_.size() && !blank(text_[at_])) at_++;
    return text_.substr(begin, std::min<size_t>(at_ - begin, 200));
  }
  // The rest of the line, without blanks around it and without an opening brace, which is left.
  std::string restOfLine() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) at_++;
    const size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '{') at_++;
    size_t end = at_;
    while (end > begin && blank(text_[end - 1])) end--;
    return text_.substr(begin, std::min<size_t>(end - begin, 200));
  }
  double number(const std::string& what) {
    skipBlanks();
    size_t begin = at_;
    if (begin < text_.size() && text_[begin] == '+') begin++;
    double value;
    const auto [end, error] =
        std::from_chars(text_.data() + begin, text_.data() + text_.size(), value);
    const size_t stop = static_cast<size_t>(end - text_.data());
    if (error != std::errc() || (stop < text_.size() && !blank(text_[stop]))) {
      const std::string found = word();
      if (found.empty()) fail("the file is cut short in " + what);
      fail(fmt::format("{}: '{}' is not a number", what, found));
    }
    at_ = stop;
    if (!std::isfinite(value)) fail(what + " is not a finite number");
    return value;
  }
  void expect(const char* expected, const std::string& where) {
    const std::string found = word();
    if (found.empty()) fail(fmt::format("the file is cut short in {}", where));
    if (found != expected) fail(fmt::format("'{}' instead of '{}' in {}", found, expected, where));
  }

  void readJoint(int parent, int depth) {
    if (depth > kMaxDepth) fail("joints are nested too deeply");
    const int self = static_cast<int>(clip_.joints.size());
    ClipJoint joint;
    joint.parent = parent;
    joint.name = restOfLine();
    if (joint.name.empty()) joint.name = fmt::format("joint{}", self);
    const std::string name = "joint '" + joint.name + "'";
    clip_.joints.push_back(joint);
    channels_.emplace_back();
    offsets_.emplace_back(Vector3d::Zero());
    expect("{", name);
    for (;;) {
      const std::string key = lower(word());
      if (key == "}") return;
      if (key == "offset") {
        for (int k = 0; k < 3; k++) offsets_[self][k] = number("OFFSET of " + name);
      } else if (key == "channels") {
        readChannels(self, name);
      } else if (key == "joint") {
        readJoint(self, depth + 1);
      } else if (key == "end") {
        readEnd(self);
      } else if (key.empty()) {
        fail(fmt::format("the file is cut short in {}", name));
      } else {
        fail(fmt::format("'{}' in {}", key, name));
      }
    }
  }

  void readChannels(int joint, const std::string& name) {
    const double count = number("CHANNELS of " + name);
    if (!(count >= 0 && count <= 12)) fail(fmt::format("{} channels in {}", count, name));
    for (int k = 0; k < count; k++) {
      const std::string channel = lower(word());
      const int axis = channel.empty() ? -1 : channel[0] - 'x';
      const std::string kind = channel.substr(channel.empty() ? 0 : 1);
      if (axis < 0 || axis > 2 || (kind != "rotation" && kind != "position")) {
        fail(fmt::format("'{}' in the channels of {}; known are Xposition ... Zrotation", channel,
                         name));
      }
      channels_[joint].push_back({kind == "rotation", axis});
    }
  }

  void readEnd(int parent) {
    restOfLine();  // "Site"
    const std::string name = "End Site of '" + clip_.joints[parent].name + "'";
    clip_.joints.push_back({clip_.joints[parent].name + "_end", parent, true});
    channels_.emplace_back();
    offsets_.emplace_back(Vector3d::Zero());
    expect("{", name);
    for (std::string key = lower(word()); key != "}"; key = lower(word())) {
      if (key.empty()) fail(fmt::format("the file is cut short in {}", name));
      if (key != "offset") fail(fmt::format("'{}' in {}", key, name));
      for (int k = 0; k < 3; k++) offsets_.back()[k] = number("OFFSET of " + name);
    }
  }

  void readMotion() {
    if (lower(word()) != "frames:") fail("no 'Frames:' after MOTION");
    const double frames = number("Frames");
    if (!(frames >= 1)) fail("no frames: the clip is empty");
    if (lower(word()) != "frame" || lower(word()) != "time:") fail("no 'Frame Time:' after Frames");
    const double step = number("Frame Time");
    if (!(step > 0)) fail(fmt::format("Frame Time: {} must be positive [s]", step));
    clip_.rate = 1 / step;
    clip_.rest = pose(nullptr);
    size_t values = 0;
    for (const auto& joint : channels_) values += joint.size();
    if (values == 0) fail("no joint has channels");
    std::vector<double> row(values);
    for (double frame = 0; frame < frames; frame++) {
      skipBlanks();
      if (at_ == text_.size()) {
        fail(fmt::format("the file is cut short: {} frames of {}", frame, frames));
      }
      for (size_t joint = 0, k = 0; joint < channels_.size(); joint++) {
        for (const Channel& channel : channels_[joint]) {
          row[k++] = readValue(frame, clip_.joints[joint].name, channel);
        }
      }
      const auto poses = pose(row.data());
      clip_.poses.insert(clip_.poses.end(), poses.begin(), poses.end());
    }
    // Some writers add frames that they do not count; other text means that the counts are wrong.
    size_t extra = 0;
    for (skipBlanks(); at_ < text_.size(); skipBlanks(), extra++) number("after the last frame");
    if (extra % values != 0) {
      fail(fmt::format("{} numbers after the last of {} frames; Frames or CHANNELS are wrong",
                       extra, frames));
    }
  }
  double readValue(double frame, const std::string& joint, const Channel& channel) {
    // The text of a message is costly; most values are good.
    const size_t at = at_;
    const long line = line_;
    try {
      return number("");
    } catch (const Error&) {
      at_ = at, line_ = line;
      return number(fmt::format("frame {}, joint '{}', {}{}", frame + 1, joint, "XYZ"[channel.axis],
                                channel.rotation ? "rotation" : "position"));
    }
  }

  // World poses of all joints; null: all channels as the skeleton has them.
  std::vector<Isometry3d> pose(const double* row) const {
    std::vector<Isometry3d> poses(clip_.joints.size());
    for (size_t j = 0; j < poses.size(); j++) {
      Isometry3d X = Isometry3d::Identity();
      X.translation() = offsets_[j];
      for (const Channel& channel : channels_[j]) {
        if (!row) break;
        const double value = *row++;
        if (channel.rotation) {
          X.rotate(AngleAxisd(value * M_PI / 180, Vector3d::Unit(channel.axis)));
        } else {
          X.translation()[channel.axis] = value;
        }
      }
      const int parent = clip_.joints[j].parent;
      poses[j] = parent < 0 ? X : poses[parent] * X;
    }
    return poses;
  }

  const std::string& text_;
  const std::string& path_;
  size_t at_ = 0;
  long line_ = 1;
  Clip clip_;
  std::vector<std::vector<Channel>> channels_;  // by joint
  std::vector<Vector3d> offsets_;
};

}  // namespace

Clip parseBvh(const std::string& content, const std::string& path) {
  return BvhReader(content, path).read();
}

}  // namespace torso::tools
