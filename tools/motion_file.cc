// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/motion_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "tools/error.h"
#include "tools/files.h"
#include "tools/mujoco_support.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr char kFormat[] = "torso motion 1";
constexpr char kRate[] = "# torso motion 1, rate_hz=";

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

double number(const std::string& text, const std::string& where) {
  double x = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, x);
  if (error != std::errc() || stop != end) throw Error(fmt::format("{}: '{}'", where, text));
  return x;
}

Motion readCsv(const std::string& content, const std::string& path) {
  Motion motion;
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < content.size();) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string line = content.substr(begin, end - begin);
    begin = end + 1;
    const std::string where = fmt::format("{}:{}: not a number", path, ++line_number);
    if (line_number == 1) {
      motion.rate = number(split(line.substr(std::strlen(kRate)))[0], where);
    } else if (motion.columns.empty()) {
      motion.columns = split(line);
      motion.columns.erase(motion.columns.begin());  // time
    } else {
      const std::vector<std::string> cells = split(line);
      if (cells.size() != motion.columns.size() + 1) {
        throw Error(fmt::format("{}:{}: {} cells, the head line has {}", path, line_number,
                                cells.size(), motion.columns.size() + 1));
      }
      for (std::size_t i = 1; i < cells.size(); i++) motion.qpos.push_back(number(cells[i], where));
    }
  }
  return motion;
}

Motion readBinary(const std::string& content, const std::string& path) {
  const std::size_t end = content.find('\n');
  const Json head = Json::parse(content.substr(0, end), nullptr, false);
  Motion motion;
  try {
    if (head.at("format") != kFormat) throw Error("");
    motion.rate = head.at("rate_hz");
    motion.columns = head.at("columns").get<std::vector<std::string>>();
    motion.qpos.resize(head.at("frames").get<std::size_t>() * motion.columns.size());
  } catch (const std::exception&) {
    throw Error(path + ": not a motion as torso retrofit writes it");
  }
  const std::size_t size = motion.qpos.size() * sizeof(double);
  if (content.size() - end - 1 != size) {
    throw Error(
        fmt::format("{}: {} bytes after its first line, there should be {}; is the file "
                    "cut off?",
                    path, content.size() - end - 1, size));
  }
  std::memcpy(motion.qpos.data(), content.data() + end + 1, size);
  return motion;
}

}  // namespace

std::vector<std::string> qposColumns(const mjModel* m) {
  std::vector<std::string> columns;
  for (int j = 0; j < m->njnt; j++) {
    const std::string name = nameOf(m, mjOBJ_JOINT, j);
    const int type = m->jnt_type[j];
    if (type == mjJNT_FREE) {
      for (const char* axis : {":x", ":y", ":z"}) columns.push_back(name + axis);
    }
    if (type == mjJNT_FREE || type == mjJNT_BALL) {
      for (const char* part : {":qw", ":qx", ":qy", ":qz"}) columns.push_back(name + part);
    } else {
      columns.push_back(name);
    }
  }
  return columns;
}

std::string motionCsv(const Motion& motion) {
  std::string text =
      fmt::format("{}{}\ntime_s,{}\n", kRate, motion.rate, fmt::join(motion.columns, ","));
  const std::size_t n = motion.columns.size();
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    text += fmt::format("{:.6f}", frame / motion.rate);
    for (std::size_t i = 0; i < n; i++) text += fmt::format(",{}", motion.qpos[frame * n + i]);
    text += '\n';
  }
  return text;
}

std::string motionBinary(const Motion& motion) {
  std::string text = Json{{"format", kFormat},
                          {"rate_hz", motion.rate},
                          {"frames", motion.frames()},
                          {"columns", motion.columns}}
                         .dump() +
                     "\n";
  text.append(reinterpret_cast<const char*>(motion.qpos.data()),
              motion.qpos.size() * sizeof(double));
  return text;
}

Motion readMotion(const std::string& path) {
  const std::string content = readFile(path);
  Motion motion;
  if (content.rfind(kRate, 0) == 0) {
    motion = readCsv(content, path);
  } else if (content.rfind('{', 0) == 0) {
    motion = readBinary(content, path);
  } else {
    throw Error(path + ": not a motion as torso retrofit writes it");
  }
  if (!(motion.rate > 0) || motion.frames() == 0) throw Error(path + ": the motion is empty");
  for (double x : motion.qpos) {
    if (!std::isfinite(x)) throw Error(path + ": a number is not finite");
  }
  return motion;
}

Motion motionOf(const mjModel* m, const Motion& motion, const std::string& path) {
  Motion result;
  result.rate = motion.rate;
  result.columns = qposColumns(m);
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < result.columns.size(); i++) place[result.columns[i]] = i;
  const std::size_t n = motion.columns.size();
  for (std::size_t frame = 0; frame < motion.frames(); frame++) {
    result.qpos.insert(result.qpos.end(), m->qpos0, m->qpos0 + m->nq);
    for (std::size_t i = 0; i < n; i++) {
      const auto found = place.find(motion.columns[i]);
      if (found == place.end()) {
        throw Error(fmt::format("{}: '{}' is not in the model; it is the motion of another one",
                                path, motion.columns[i]));
      }
      result.qpos[frame * m->nq + found->second] = motion.qpos[frame * n + i];
    }
  }
  return result;
}

double duration(const Motion& motion) { return (motion.frames() - 1) / motion.rate; }

void motionAt(const mjModel* m, const Motion& motion, double time, mjtNum* qpos) {
  const double all = duration(motion);
  const double place = all > 0 ? std::fmod(time, all * (1 + 1e-12)) * motion.rate : 0;
  const std::size_t last = motion.frames() - 1;
  const std::size_t frame = std::min(static_cast<std::size_t>(place), last);
  const double* now = motion.qpos.data() + frame * m->nq;
  const double* next = motion.qpos.data() + std::min(frame + 1, last) * m->nq;
  std::vector<mjtNum> velocity(m->nv);
  mj_differentiatePos(m, velocity.data(), 1, now, next);
  mju_copy(qpos, now, m->nq);
  mj_integratePos(m, qpos, velocity.data(), place - frame);
}

}  // namespace torso::tools
