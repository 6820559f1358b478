// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <thread>

#include "model/fnv1a.h"
#include "plugin/mujoco_torso.h"
#include "tools/error.h"
#include "tools/files.h"
#include "tools/paths.h"
#include "tools/validation.h"

namespace torso::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kTorso = "torso";  // the first word of a command that this executable runs

std::string now() {
  const std::time_t t = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&t));
  return text;
}

// Hash of the executable and the models that come with it: what results depend on beside the
// options.
std::string buildKey() {
  Fnv1a hash;
  const auto add = [&](const std::string& bytes) { hash.add(bytes.data(), bytes.size()); };
  add(readFile("/proc/self/exe"));
  for (const char* model : {"human.xml", "human_fixed.xml", "human_simple.xml", "torso_held.xml"}) {
    const std::string path = mjcfFolder() + "/" + model;
    if (std::filesystem::exists(path)) add(readFile(path));
  }
  return fmt::format("{} {:016x}", torso_versionString(), hash.value());
}

// The command with its output in files of the folder, where it runs.
pid_t start(const std::vector<std::string>& arguments, const std::string& folder,
            const std::string& out, const std::string& err) {
  // Not "/proc/self/exe", which the child would take for itself, but where that leads.
  const std::string program = arguments[0] == kTorso
                                  ? std::filesystem::read_symlink("/proc/self/exe").string()
                                  : arguments[0];
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t child = 0;
  const int failure =
      posix_spawnp(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure) throw Error(fmt::format("{}: {}", program, std::strerror(failure)));
  return child;
}

// Waits for the child; passes an interrupt on to it. Returns its status as waitpid gives it.
int waitFor(pid_t child, const std::function<void(double)>& progress,
            const std::function<bool()>& interrupted) {
  const Clock::time_point begin = Clock::now();
  int status = 0;
  bool told = false;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (interrupted() && !told) {
      told = true;
      kill(child, SIGINT);
    }
    progress(std::chrono::duration<double>(Clock::now() - begin).count());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return status;
}

// As the shell wants it.
std::string commandText(const std::vector<std::string>& arguments) {
  std::string text;
  for (const std::string& word : arguments) {
    const bool plain = word.find_first_of(" |()[]*$&;<>'\"") == std::string::npos;
    text += (text.empty() ? "" : " ") + (plain ? word : "'" + word + "'");
  }
  return text;
}

void judge(SectionResult& result, int status, const std::string& out, const std::string& err,
           bool json) {
  if (WIFSIGNALED(status)) {
    result.failed = true;
    result.message = fmt::format("ended by signal {}", WTERMSIG(status));
    return;
  }
  // A command that says that something is amiss may have printed its figures all the same.
  result.failed = WEXITSTATUS(status) != 0;
  result.message = err.substr(0, err.find_last_not_of('\n') + 1);
  if (result.failed && err.empty()) {
    result.message = fmt::format("exit status {}", WEXITSTATUS(status));
  }
  result.output = Json::parse(out, nullptr, false);
  if (!result.output.is_discarded()) return;
  result.output = out;
  if (json && !result.failed) {
    result.failed = true;
    result.message = "it printed no JSON";
  }
}

void readRows(const Section& section, SectionResult& result) {
  try {
    result.rows = section.rows(result.output);
  } catch (const std::exception& e) {
    if (result.failed) return;  // no wonder
    result.failed = true;
    result.message = fmt::format("its figures could not be read: {}", e.what());
  }
}

Json store(const SectionResult& r, const std::string& build) {
  return {{"build", build},     {"command", r.command}, {"date", r.date},    {"seconds", r.seconds},
          {"failed", r.failed}, {"message", r.message}, {"output", r.output}};
}

// The section as it was done before by the same build with the same command.
std::optional<SectionResult> kept(const std::string& path, const std::string& command,
                                  const std::string& build) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  Json json;
  try {
    json = Json::parse(readFile(path));
    if (json.at("failed") || json.at("command") != command || json.at("build") != build) {
      return std::nullopt;
    }
    SectionResult result;
    result.command = command;
    result.date = json.at("date");
    result.seconds = json.at("seconds");
    result.message = json.at("message");
    result.output = json.at("output");
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;  // somebody else's file: done again
  }
}

// Runs the command and fills in the result; a command that cannot be started has failed.
void perform(const std::vector<std::string>& words, const std::string& folder,
             const std::string& id, const std::function<void(double)>& progress,
             const std::function<bool()>& interrupted, SectionResult& result) {
  const Clock::time_point begin = Clock::now();
  result.date = now();
  const std::string hidden = std::filesystem::absolute(folder + "/." + id).string();
  const std::string out = hidden + ".out", err = hidden + ".err";
  const std::string own = folder + "/" + id;
  std::filesystem::remove_all(own);  // pictures of another time
  // Files of their own, not those that a command of a killed run may still be writing.
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  makeFolder(own);
  try {
    const pid_t child = start(words, folder, out, err);
    const int status = waitFor(child, progress, interrupted);
    judge(result, status, readFile(out), readFile(err), words[0] == kTorso);
  } catch (const Error& e) {
    result.failed = true;
    result.message = e.what();
  }
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  if (std::filesystem::is_empty(own)) std::filesystem::remove(own);
  result.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

std::vector<SectionResult> runSections(const std::vector<Section>& sections,
                                       const std::string& folder, bool short_form,
                                       const std::function<void(double)>& progress,
                                       const std::function<bool()>& interrupted) {
  makeFolder(folder);
  const std::string build = buildKey();
  double all = 1e-9, done = 0;  // [s]
  for (const Section& section : sections) all += section.seconds;
  std::vector<SectionResult> results;
  for (const Section& section : sections) {
    std::vector<std::string> words = short_form ? section.short_arguments : section.arguments;
    if (words[0] == kTorso) words.push_back("--json");
    const std::string path = fmt::format("{}/{}.json", folder, section.id);
    SectionResult result;
    result.command = commandText(words);
    const auto before = kept(path, result.command, build);
    if (before && section.seconds > 0) {
      result = *before;
      readRows(section, result);
    } else {
      const auto show = [&](double seconds) {
        progress((done + std::min(seconds, 0.95 * section.seconds)) / all);
      };
      perform(words, folder, section.id, show, interrupted, result);
      if (interrupted()) return results;
      readRows(section, result);
      writeFile(path, store(result, build).dump(1) + "\n");
    }
    results.push_back(result);
    done += section.seconds;
  }
  return results;
}

}  // namespace torso::tools
