// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <thread>

#include "model/disc_batch.h"
#include "plugin/mujoco_torso.h"
#include "tools/files.h"
#include "tools/mujoco_support.h"
#include "tools/validation.h"

namespace torso::tools {
namespace {

constexpr const char* kStyle = R"(
:root { --ink: #1d2530; --grey: #667085; --line: #e3e7ed; --blue: #1b3a6b; --red: #b3392c; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 70rem; padding: 2.5rem 1.5rem 6rem; color: var(--ink);
  font: 16px/1.5 "Source Sans 3", "Noto Sans", "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.9rem; font-weight: 600; margin: 0 0 .3rem; letter-spacing: -.01em; }
h2 { font-size: 1.3rem; font-weight: 600; margin: 3.5rem 0 .4rem; padding-top: 1rem;
  border-top: 1px solid var(--line); }
p { margin: .3rem 0 .8rem; max-width: 46rem; }
a { color: var(--blue); text-decoration: none; }
a:hover { text-decoration: underline; }
.facts { color: var(--grey); font-size: .88rem; }
.note { white-space: pre-wrap; }
.facts span { margin-right: 1.4rem; white-space: nowrap; }
code { font: .85rem/1.5 "JetBrains Mono", "DejaVu Sans Mono", monospace; background: #f4f6f9;
  padding: .1rem .35rem; border-radius: 3px; overflow-wrap: anywhere; }
table { border-collapse: collapse; width: 100%; font-size: .92rem; margin: .8rem 0; }
th { text-align: left; font-weight: 600; font-size: .78rem; color: var(--grey);
  border-bottom: 1px solid #c9d0da; padding: .35rem .8rem .35rem 0; }
td { border-bottom: 1px solid var(--line); padding: .32rem .8rem .32rem 0; vertical-align: top;
  font-variant-numeric: tabular-nums; }
td.ours { color: var(--blue); font-weight: 600; min-width: 7rem; }
td.source { color: var(--grey); font-size: .82rem; }
td.section { font-size: .85rem; white-space: nowrap; }
.yes { color: #2c7a4b; } .no { color: var(--red); font-weight: 600; } .none { color: #b6bdc8; }
.failed { border-left: 3px solid var(--red); background: #fdf3f1; padding: .6rem 1rem;
  white-space: pre-wrap; font-size: .9rem; margin: .8rem 0; }
details { margin: .6rem 0; } summary { cursor: pointer; color: var(--blue); font-size: .9rem; }
details > div { max-height: 34rem; overflow: auto; border: 1px solid var(--line);
  padding: 0 .8rem; margin-top: .4rem; }
pre { font: .75rem/1.45 "DejaVu Sans Mono", monospace; white-space: pre-wrap; }
.pictures { display: flex; flex-wrap: wrap; gap: .8rem; margin: 1rem 0; }
figure { margin: 0; } figure.wide { flex: 1 1 100%; } figure.narrow { flex: 0 1 24rem; }
figure.small { flex: 0 1 11.5rem; }
img { width: 100%; height: auto; border: 1px solid var(--line); display: block; }
figcaption { font-size: .75rem; color: var(--grey); }
@media print { body { max-width: none; padding: 0; } details > div { max-height: none; } }
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&'   ? "&amp;"
           : c == '<' ? "&lt;"
           : c == '>' ? "&gt;"
           : c == '"' ? "&quot;"
                      : std::string(1, c);
  }
  return out;
}

std::string base64(const std::string& bytes) {
  static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned block = 0;
    for (std::size_t k = 0; k < 3; k++) {
      block = block << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    }
    for (std::size_t k = 0; k < 4; k++) {
      out += i + k > bytes.size() ? '=' : kDigits[block >> (18 - 6 * k) & 63];
    }
  }
  return out;
}

// Width of a PNG file [pixels].
int widthOf(const std::string& png) {
  int width = 0;
  for (std::size_t i = 16; i < 20 && i < png.size(); i++) {
    width = width << 8 | static_cast<unsigned char>(png[i]);
  }
  return width;
}

std::string pictures(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, none)) {
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  constexpr int kWide = 900, kMany = 4;  // [pixels]; narrower ones stand side by side
  const auto wide = [](const std::filesystem::path& file) {
    return widthOf(readFile(file.string())) >= kWide;
  };
  const auto narrow = std::stable_partition(files.begin(), files.end(), wide);
  const char* side_by_side = files.end() - narrow >= kMany ? "small" : "narrow";
  std::string html;
  for (auto file = files.begin(); file != files.end(); ++file) {
    const std::string name = escaped(file->stem().string());
    html += fmt::format(
        "<figure class=\"{}\"><img alt=\"{}\" src=\"data:image/png;base64,{}\">"
        "<figcaption>{}</figcaption></figure>\n",
        file < narrow ? "wide" : side_by_side, name, base64(readFile(file->string())), name);
  }
  return html.empty() ? "" : "<div class=\"pictures\">\n" + html + "</div>\n";
}

std::string verdict(const std::optional<bool>& inside) {
  if (!inside) return "<span class=\"none\">&ndash;</span>";
  return *inside ? "<span class=\"yes\">yes</span>" : "<span class=\"no\">no</span>";
}

std::string table(const std::vector<Row>& rows) {
  std::string html =
      "<table><thead><tr><th>what</th><th>ours</th><th>published</th><th>inside</th>"
      "<th>source</th></tr></thead><tbody>\n";
  for (const Row& row : rows) {
    html += fmt::format(
        "<tr><td>{}</td><td class=\"ours\">{}</td><td>{}</td><td>{}</td>"
        "<td class=\"source\">{}</td></tr>\n",
        escaped(row.what), escaped(row.ours), escaped(row.published), verdict(row.inside),
        escaped(row.source));
  }
  return html + "</tbody></table>\n";
}

// Without the curves: arrays of many numbers.
Json withoutCurves(const Json& value) {
  constexpr std::size_t kCurve = 25;
  if (value.is_array()) {
    if (value.size() > kCurve && value[0].is_number()) {
      return fmt::format("({} numbers)", value.size());
    }
    Json out = Json::array();
    for (const Json& part : value) out.push_back(withoutCurves(part));
    return out;
  }
  if (value.is_object()) {
    Json out = Json::object();
    for (const auto& [key, part] : value.items()) out[key] = withoutCurves(part);
    return out;
  }
  return value;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

std::string duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.0f} s", seconds);
  const int whole = static_cast<int>(seconds + 0.5);
  return fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

std::string sectionHtml(const Section& section, const SectionResult& result,
                        const std::string& folder) {
  const std::vector<Row>& rows = result.rows;
  std::string html = fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n", section.id,
                                 escaped(section.title), escaped(section.about));
  html +=
      fmt::format("<p class=\"facts\"><code>{}</code><br><span>{}</span><span>took {}</span></p>\n",
                  escaped(result.command), result.date, duration(result.seconds));
  if (result.failed) {
    html +=
        "<div class=\"failed\"><strong>failed</strong>: " + escaped(result.message) + "</div>\n";
  } else if (!result.message.empty()) {
    html += "<p class=\"facts note\">" + escaped(result.message) + "</p>\n";
  }
  constexpr std::size_t kShown = 30;  // rows; more of them are folded
  std::vector<Row> head;
  for (const Row& row : rows) {
    if (row.headline) head.push_back(row);
  }
  if (rows.size() <= kShown) {
    html += rows.empty() ? "" : table(rows);
  } else {
    if (!head.empty()) html += table(head);
    // What is amiss is never folded away.
    std::vector<Row> outside;
    for (const Row& row : rows) {
      if (!row.headline && row.inside && !*row.inside) outside.push_back(row);
    }
    if (!outside.empty()) {
      html += fmt::format("<details{}><summary>Outside ({})</summary><div>{}</div></details>\n",
                          outside.size() <= kShown ? " open" : "", outside.size(), table(outside));
    }
    html += fmt::format("<details><summary>All {} figures</summary><div>{}</div></details>\n",
                        rows.size(), table(rows));
  }
  html += pictures(folder + "/" + section.id);
  if (!result.output.is_null() && !result.output.is_string()) {
    html += "<details><summary>What the command printed</summary><div><pre>" +
            escaped(withoutCurves(result.output).dump(1)) + "</pre></div></details>\n";
  }
  return html + "</section>\n";
}

}  // namespace

std::string validationPage(const std::vector<Section>& sections,
                           const std::vector<SectionResult>& results, const std::string& folder,
                           bool short_form) {
  std::string body, summary;
  double seconds = 0;
  int failed = 0, inside = 0, compared = 0;
  std::string first, last;
  for (std::size_t i = 0; i < results.size(); i++) {
    const Section& section = sections[i];
    const SectionResult& result = results[i];
    const std::vector<Row>& rows = result.rows;
    body += sectionHtml(section, result, folder);
    seconds += result.seconds;
    if (first.empty() || result.date < first) first = result.date;
    last = std::max(last, result.date);
    const std::string link =
        fmt::format("<a href=\"#{}\">{}</a>", section.id, escaped(section.title));
    if (result.failed) {
      failed++;
      summary += fmt::format(
          "<tr><td class=\"section\">{}</td><td colspan=\"3\" class=\"no\">failed</td>"
          "<td><span class=\"no\">no</span></td></tr>\n",
          link);
    }
    bool named = result.failed;
    for (const Row& row : rows) {
      if (!row.headline) continue;
      compared += row.inside.has_value();
      inside += row.inside.value_or(false);
      summary += fmt::format(
          "<tr><td class=\"section\">{}</td><td>{}</td><td class=\"ours\">{}</td><td>{}</td>"
          "<td>{}</td></tr>\n",
          named ? "" : link, escaped(row.what), escaped(row.ours), escaped(row.published),
          verdict(row.inside));
      named = true;
    }
    if (!named) {
      summary +=
          fmt::format("<tr><td class=\"section\">{}</td><td colspan=\"4\">{} figures</td></tr>\n",
                      link, rows.size());
    }
  }
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>mujoco-torso, validation</title>\n<style>{}</style></head><body>\n"
      "<h1>Validation of mujoco-torso{}</h1>\n",
      kStyle, short_form ? ", short form" : "");
  html += fmt::format(
      "<p class=\"facts\"><span>torso {}</span><span>MuJoCo {}</span><span>{}, {}, {} "
      "core{}</span><span>{}{}</span><span>{} in all</span></p>\n",
      torso_versionString(), mj_versionString(), escaped(processor()), DiscBatch::instructionSet(),
      std::thread::hardware_concurrency(), std::thread::hardware_concurrency() == 1 ? "" : "s",
      first, last == first ? "" : " to " + last, duration(seconds));
  html += fmt::format(
      "<p>Of {} headline figures that have a published range or a limit to be compared with, {} "
      "are inside. {}</p>\n",
      compared, inside,
      failed ? fmt::format("<span class=\"no\">{} of {} sections failed.</span>", failed,
                           results.size())
             : fmt::format("All {} sections ran.", results.size()));
  html +=
      "<table><thead><tr><th>section</th><th>what</th><th>ours</th><th>published</th>"
      "<th>inside</th></tr></thead><tbody>\n" +
      summary + "</tbody></table>\n";
  return html + body + "</body></html>\n";
}

}  // namespace torso::tools
