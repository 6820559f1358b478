// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/recorded_rollout.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <sstream>
#include <utility>

#include "tools/error.h"

namespace torso::tools {
namespace {

using Json = nlohmann::ordered_json;
using Seeds = std::set<std::uint64_t>;

// What process 0 decides.
struct Plan {
  Seeds known;      // it has the results of these in its folder
  Seeds remaining;  // nobody has these: they are to be run
};

Plan makePlan(const RolloutOptions& options, const Json& settings, const Seeds& known,
              const std::vector<std::string>& greetings, bool observed) {
  Plan plan = {known, {}};
  for (int i = 0; i < options.seeds; i++) plan.remaining.insert(options.seed0 + i);
  for (std::size_t rank = 0; rank < greetings.size(); rank++) {
    const Json greeting = Json::parse(greetings[rank]);
    checkSettings(settings, greeting.at("settings").dump(), fmt::format("process {}", rank));
    for (const std::uint64_t seed : greeting.at("seeds")) plan.remaining.erase(seed);
  }
  if (observed) {
    plan.known.erase(options.seed0);
    plan.remaining.insert(options.seed0);
  }
  return plan;
}

// Every size-th of the remaining seeds; the first of them is for process 0.
Seeds shareOf(const Plan& plan, const Processes& processes) {
  Seeds share;
  int i = 0;
  for (const std::uint64_t seed : plan.remaining) {
    if (i++ % processes.size() == processes.rank()) share.insert(seed);
  }
  return share;
}

// Results by seed, each once.
class Collection {
 public:
  void add(const std::string& text, const std::string& where) {
    Violations violations;
    const RunResult run = parseRecord(text, where, &violations);
    if (runs_.emplace(run.seed, run).second) violations_.merge(violations);
  }

  RolloutSummary summary(const mjModel* m) const {
    std::vector<RunResult> runs;
    for (const auto& [seed, run] : runs_) runs.push_back(run);
    return summarise(m, std::move(runs), violations_);
  }

 private:
  std::map<std::uint64_t, RunResult> runs_;
  Violations violations_;
};

}  // namespace

std::optional<RolloutSummary> recordedRollout(const mjModel* m, RolloutOptions options,
                                              const Json& settings, const RunFolder* folder,
                                              const Processes& processes,
                                              const std::vector<Observer>& observers,
                                              const std::function<void(double)>& progress,
                                              const std::atomic<bool>& stop) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const Seeds own = folder ? folder->seeds(options.seed0, options.seeds) : Seeds();
  const auto greetings = processes.gather(Json{{"settings", settings}, {"seeds", own}}.dump());
  Plan plan;
  if (processes.rank() == 0) {
    plan = makePlan(options, settings, own, greetings, !observers.empty());
  }
  const Json agreed = Json::parse(
      processes.broadcast(Json{{"known", plan.known}, {"remaining", plan.remaining}}.dump()));
  plan = {agreed.at("known").get<Seeds>(), agreed.at("remaining").get<Seeds>()};

  const Seeds share = shareOf(plan, processes);
  for (int i = 0; i < options.seeds; i++) {
    if (!share.count(options.seed0 + i)) options.skip.insert(options.seed0 + i);
  }
  if (folder) folder->open();
  std::map<std::uint64_t, std::string> records;
  rollout(m, options, observers, progress, stop,
          [&](const RunResult& run, const Violations& violations) {
            std::string& text = records[run.seed];
            text = recordText(run, violations);
            if (folder) folder->save(run.seed, text);
          });

  // One record a line, of what process 0 does not have.
  std::string lines;
  if (processes.rank() > 0) {
    for (const std::uint64_t seed : own) {
      if (!plan.known.count(seed)) lines += folder->load(seed);
    }
    for (const auto& [seed, text] : records) lines += text + "\n";
  }
  const std::vector<std::string> messages = processes.gather(lines);
  if (processes.rank() > 0) return std::nullopt;

  Collection all;
  for (const auto& [seed, text] : records) all.add(text, fmt::format("seed {}", seed));
  for (const std::uint64_t seed : plan.known) all.add(folder->load(seed), folder->file(seed));
  for (std::size_t rank = 1; rank < messages.size(); rank++) {
    std::istringstream stream(messages[rank]);
    for (std::string text; std::getline(stream, text);) {
      all.add(text, fmt::format("process {}", rank));
    }
  }
  RolloutSummary summary = all.summary(m);
  summary.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return summary;
}

}  // namespace torso::tools
