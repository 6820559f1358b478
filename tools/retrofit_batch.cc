// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/retrofit_batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "tools/clip.h"
#include "tools/clock.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/forget_models.h"
#include "tools/paths.h"
#include "tools/progress_bar.h"
#include "tools/retrofit_clip.h"
#include "tools/role.h"

namespace torso::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Stopped {};  // by a signal

// Ctrl-C and the like are held back, in threads begun meanwhile too, until they are asked for.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&signals_);
    for (int s : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, s);
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  }
  ~HeldSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  // Waits a moment for one; 0: none came.
  int wait() const {
    const timespec moment = {0, 50'000'000};
    return std::max(0, sigtimedwait(&signals_, nullptr, &moment));
  }

 private:
  sigset_t signals_, before_;
};

std::string quoted(std::string text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  for (size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2) text.insert(i, 1, '"');
  return '"' + text + '"';
}

std::string summaryCsv(const std::vector<Json>& files) {
  std::string text =
      "clip,file,frames,rate_hz,seconds,core_seconds,core_s_per_s,held_median_mm,held_p95_mm,"
      "held_median_deg,held_p95_deg,reached_median_mm,reached_p95_mm,reached_median_deg,"
      "reached_p95_deg,skeleton_median_mm,skeleton_p95_mm,skeleton_median_deg,"
      "skeleton_p95_deg,frames_flagged,frames_within_3mm_1deg,frames_within_10mm_3deg,"
      "reached_within_3mm_1deg,reached_within_10mm_3deg,power_above_band_over_input,"
      "largest_jump_deg,largest_own_jump_deg,flags,error\n";
  for (const Json& rows : files) {
    for (const Json& row : rows) {
      const std::string file = quoted(row["file"]);
      if (row.contains("error")) {
        text += fmt::format(",{},,,,,,,,,,,,,,,,,,,,,,,,,,,{}\n", file, quoted(row["error"]));
        continue;
      }
      text += fmt::format("{},{}", quoted(row["clip"]), file);
      for (const char* key : {"frames", "rate_hz", "seconds", "core_seconds", "core_s_per_s"}) {
        text += "," + row[key].dump();
      }
      for (const char* key : {"held_error_mm", "held_error_deg", "reached_error_mm",
                              "reached_error_deg", "skeleton_error_mm", "skeleton_error_deg"}) {
        for (const char* of : {"median", "p95"}) {
          const Json& value = row[key][of];
          text += "," + (value.is_null() ? "" : value.dump());
        }
      }
      for (const char* key : {"frames_flagged", "frames_within_3mm_1deg", "frames_within_10mm_3deg",
                              "reached_within_3mm_1deg", "reached_within_10mm_3deg"}) {
        text += "," + row[key].dump();
      }
      for (const char* key :
           {"power_above_band_over_input", "largest_jump_deg", "largest_own_jump_deg"}) {
        text += "," + (row.contains(key) ? row[key].dump() : "");  // not of clips of a few frames
      }
      text += fmt::format(",{},\n", quoted(row["flags"]));
    }
  }
  return text;
}

class Batch {
 public:
  Batch(const Anatomy& tables, const RetrofitBatch& batch, const Processes& processes)
      : tables_(tables),
        batch_(batch),
        processes_(processes),
        settings_({{"rate_hz", batch.rate}, {"map", writePartMap(batch.map, roleMapParts())}}),
        files_(clipFiles(batch.inputs)),
        rows_(files_.size(), Json::array()),
        shares_(files_.size(), 0) {
    // Files of one name in several folders, or of several formats, are told apart by numbers.
    for (const std::string& file : files_) {
      std::string stem = fs::path(file).stem().string();
      for (int k = 2; stems_.count(stem); k++)
        stem = fmt::format("{}-{}", fs::path(file).stem().string(), k);
      stems_.insert(stem);
      stem_of_.push_back(stem);
    }
  }

  Json run() {
    makeFolder(batch_.output);
    if (processes_.rank() == 0) copyScene();
    for (size_t i = processes_.rank(); i < files_.size(); i += processes_.size()) {
      if (batch_.again || !isDone(i)) todo_.push_back(i);
    }
    int signal = 0;
    {
      const HeldSignals signals;
      const ProgressBar bar;
      for (size_t begin = 0; begin < todo_.size() && !stop_; begin += round()) {
        next_ = begin;
        end_ = std::min(begin + round(), todo_.size());
        std::vector<std::thread> threads;
        running_ = std::min<int>(batch_.jobs, static_cast<int>(end_ - begin));
        for (int k = running_; k > 0; k--) threads.emplace_back([this] { work(); });
        while (running_ > 0) {
          if (const int caught = signals.wait()) signal = caught, stop_ = true;
          bar.show(share());
        }
        for (std::thread& thread : threads) thread.join();
        forgetModels();
      }
      if (signal) std::raise(signal);  // as soon as it is let through
    }
    if (!failure_.empty()) throw Error(failure_);
    gather();
    writeSummary();
    Json all = Json::array();
    for (const Json& rows : rows_) {
      for (const Json& row : rows) all.push_back(row);
    }
    return all;
  }

 private:
  // What the bodies' files refer to.
  void copyScene() const {
    std::map<std::string, std::string> files = {
        {batch_.output + "/scene.xml", readFile(mjcfFolder() + "/scene.xml")}};
    makeFolder(batch_.output + "/assets");
    for (const auto& mesh : fs::directory_iterator(mjcfFolder() + "/assets")) {
      const std::string name = mesh.path().filename().string();
      files[batch_.output + "/assets/" + name] = readFile(mesh.path().string());
    }
    writeFiles(files);
  }

  std::string mark(size_t i) const { return batch_.output + "/" + stem_of_[i] + ".json"; }

  // Takes the rows from the mark.
  bool isDone(size_t i) {
    std::error_code none;
    const auto input = fs::last_write_time(files_[i], none);
    const auto fresh = [&](const std::string& path) {
      std::error_code error;
      const auto time = fs::last_write_time(path, error);
      return !error && time >= input;
    };
    if (none || !fresh(mark(i))) return false;
    const Json done = Json::parse(readFile(mark(i)), nullptr, false);
    if (!done.is_object() || done.value("settings", Json()) != settings_ ||
        done.value("file", "") != files_[i]) {
      return false;
    }
    for (const Json& row : done["clips"]) {
      if (!row.contains("reached_error_mm")) return false;  // of an older version
      for (const char* end : kRetrofitFiles) {
        if (!fresh(batch_.output + "/" + row["clip"].get<std::string>() + end)) return false;
      }
    }
    rows_[i] = done["clips"];
    return true;
  }

  // So many files, then what the plugin keeps of their bodies is freed.
  size_t round() const { return 16 * static_cast<size_t>(batch_.jobs); }

  void work() {
    for (size_t k; !stop_ && (k = next_++) < end_;) {
      try {
        workOn(todo_[k]);
      } catch (const Stopped&) {
      } catch (const std::exception& e) {  // the folder is full, or gone
        const std::lock_guard<std::mutex> lock(mutex_);
        failure_ = e.what();
        stop_ = true;
      }
    }
    running_--;
  }

  void workOn(size_t i) {
    const std::string& file = files_[i];
    Json rows = Json::array();
    std::vector<std::string> errors;
    const double start = threadSeconds();
    std::error_code error;
    fs::remove(mark(i), error);
    std::vector<Person> persons;
    attempt(&errors,
            [&] { persons = readPersons(file, stem_of_[i], batch_.rate, batch_.map, &errors); });
    const double reading = (threadSeconds() - start) / std::max<size_t>(1, persons.size());
    for (size_t k = 0; k < persons.size(); k++) {
      attempt(&errors, [&] {
        claim(persons[k].name, file);
        const auto progress = [&](double share) {
          if (stop_) throw Stopped();
          const std::lock_guard<std::mutex> lock(mutex_);
          shares_[i] = (static_cast<double>(k) + share) / static_cast<double>(persons.size());
        };
        rows.push_back(
            retrofitPerson(tables_, persons[k], batch_.output, batch_.temporary, progress));
        Json& row = rows.back();
        row["core_seconds"] = row["core_seconds"].get<double>() + reading;
        row["core_s_per_s"] = row["core_seconds"].get<double>() / row["seconds"].get<double>();
      });
    }
    if (errors.empty()) {
      const Json done = {{"file", file}, {"settings", settings_}, {"clips", rows}};
      writeFile(mark(i), done.dump(2) + "\n");
    }
    for (const std::string& e : errors) rows.push_back({{"file", file}, {"error", e}});
    const std::lock_guard<std::mutex> lock(mutex_);
    shares_[i] = 1;
    rows_[i] = rows;
    writeSummary();
  }

  // A clip that fails in any way, MuJoCo's and lack of memory included, is none of the others'.
  template <typename Work>
  static void attempt(std::vector<std::string>* errors, const Work& work) {
    try {
      work();
    } catch (const std::exception& e) {
      errors->push_back(e.what());
    }
  }

  void claim(const std::string& name, const std::string& file) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto [at, is_new] = claimed_.insert({name, file});
    if (!is_new) {
      throw Error(
          fmt::format("{}: files of the name {} are made for {} already; give it another "
                      "folder",
                      file, name, at->second));
    }
  }

  double share() {
    const std::lock_guard<std::mutex> lock(mutex_);
    double sum = 0;
    for (size_t i : todo_) sum += shares_[i];
    return sum / static_cast<double>(std::max<size_t>(1, todo_.size()));
  }

  // The rows of the other processes.
  void gather() {
    const std::vector<std::string> texts = processes_.gather(Json(rows_).dump());
    for (size_t rank = 0; rank < texts.size(); rank++) {
      const Json rows = Json::parse(texts[rank]);
      for (size_t i = rank; i < files_.size(); i += texts.size()) rows_[i] = rows[i];
    }
  }

  void writeSummary() const {
    if (processes_.rank() == 0) writeFile(batch_.output + "/summary.csv", summaryCsv(rows_));
  }

  const Anatomy& tables_;
  const RetrofitBatch& batch_;
  const Processes& processes_;
  const Json settings_;
  const std::vector<std::string> files_;
  std::set<std::string> stems_;
  std::vector<std::string> stem_of_;  // by files_
  std::vector<size_t> todo_;          // of files_
  size_t end_ = 0;                    // of the round at hand
  std::atomic<size_t> next_{0};
  std::atomic<int> running_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  // of what follows, while threads run
  std::vector<Json> rows_;
  std::vector<double> shares_;  // done, by files_
  std::map<std::string, std::string> claimed_;
  std::string failure_;
};

}  // namespace

std::vector<std::string> clipFiles(const std::vector<std::string>& inputs) {
  std::vector<std::string> files;
  const auto add = [&](const std::string& file) {
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  for (const std::string& input : inputs) {
    if (!fs::is_directory(input)) {
      add(input);
      continue;
    }
    std::set<std::string> inside;
    for (const auto& entry :
         fs::recursive_directory_iterator(input, fs::directory_options::skip_permission_denied)) {
      if (entry.is_regular_file() && isClipFile(entry.path().string())) {
        inside.insert(entry.path().lexically_normal().string());
      }
    }
    for (const std::string& file : inside) add(file);
  }
  return files;
}

Json retrofitBatch(const Anatomy& tables, const RetrofitBatch& batch, const Processes& processes) {
  return Batch(tables, batch, processes).run();
}

}  // namespace torso::tools
