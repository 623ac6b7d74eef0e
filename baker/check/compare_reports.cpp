#include "baker/check/compare_reports.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <array>
#include <fmt/format.h>
#include <set>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

struct ReportedBake {
  std::string name;  // of its folder, or the path where both folders have one name
  std::string page;  // report.html
  Json summary;
};

ReportedBake read_bake(const fs::path& folder) {
  const auto page = read_file(folder / "report.html"),
             summary = read_file(folder / "cert" / "summary.json");
  if (!page || !summary)
    throw Error(
        ErrorCode::command, folder.string(),
        fmt::format("There is no {} in this folder.", page ? "cert/summary.json" : "report.html"),
        "Give the output folder of a bake with --formats cert,report.");
  try {
    return {fs::absolute(folder / ".").parent_path().filename().string(), *page,
            parse_json(*summary)};
  } catch (const Json::exception&) {
    throw Error(ErrorCode::command, folder.string(), "Its cert/summary.json is damaged.",
                "Bake again.");
  }
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text)
    safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return safe;
}

/// A number of the certificate as text; "-" where a bake does not have it.
std::string measured_text(const Json& summary, const std::string& pointer, const char* unit) {
  const Json::json_pointer place(pointer);
  if (!summary.contains(place) || summary[place].is_null()) return "\u2013";
  const Json& value = summary[place];
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return fmt::format("{:.3g}{}", value.get<double>(), unit);
  return json_line(value);
}

struct Row {
  std::string what, a, b;
};

/// What an artist asks first, with the place in the certificate.
std::vector<Row> measured_rows(const Json& a, const Json& b) {
  struct Measured {
    const char *what, *pointer, *unit;
  };
  constexpr std::array<Measured, 10> asked{{
      {"frames", "/frames", ""},
      {"largest stretch of an edge", "/render_stretch_max_pct/max", " %"},
      {"mean error of lengths, worst frame", "/render_stretch_mean_pct/max", " %"},
      {"farthest handle from its key", "/handle_err_max_mm/max", " mm"},
      {"places where paper passes through paper, worst frame", "/render_crossings/max", ""},
      {"depth inside a collider", "/inside_mm/max", " mm"},
      {"singular points", "/singular", ""},
      {"length of creases at the end", "/crease_length_m", " m"},
      {"CPU time of a frame, elastic part", "/elastic_ms/mean", " ms"},
      {"CPU time of a frame, render mesh", "/render_ms/mean", " ms"},
  }};
  std::vector<Row> rows;
  for (const Measured& m : asked)
    rows.push_back(
        {m.what, measured_text(a, m.pointer, m.unit), measured_text(b, m.pointer, m.unit)});
  return rows;
}

std::vector<Row> settings_that_differ(const Json& a, const Json& b) {
  const Json in_a = a.value("settings", Json::object()), in_b = b.value("settings", Json::object());
  std::set<std::string> keys;
  for (const Json& settings : {in_a, in_b})
    for (const auto& [key, value] : settings.items()) keys.insert(key);
  std::vector<Row> rows;
  for (const std::string& key : keys) {
    const auto value = [&](const Json& settings) {
      const auto found = settings.find(key);
      if (found == settings.end()) return std::string("\u2013");
      return found->is_string() ? found->get<std::string>() : json_line(*found);
    };
    if (value(in_a) != value(in_b)) rows.push_back({key, value(in_a), value(in_b)});
  }
  return rows;
}

std::string table(const std::string& title, const ReportedBake& a, const ReportedBake& b,
                  const std::vector<Row>& rows) {
  std::string text = fmt::format("<table><tr><th>{}</th><th>{}</th><th>{}</th></tr>\n", title,
                                 escaped(a.name), escaped(b.name));
  for (const Row& row : rows)
    text += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        row.a == row.b ? "" : " class=\"differs\"", escaped(row.what),
                        escaped(row.a), escaped(row.b));
  return text + "</table>\n";
}

/// "A: good" or the gates that it missed.
std::string verdict(const ReportedBake& bake) {
  const Json missed = bake.summary.value("gates_missed", Json::array());
  if (missed.empty())
    return fmt::format("<p><b>{}</b>: every gate is met.</p>\n", escaped(bake.name));
  std::string text = fmt::format("<p class=\"missed\"><b>{}</b>: not good:", escaped(bake.name));
  for (const Json& sentence : missed)
    text += " " + escaped(sentence.is_string() ? sentence.get<std::string>() : json_line(sentence));
  return text + "</p>\n";
}

std::string framed(const ReportedBake& bake) {
  return fmt::format("<iframe title=\"{}\" srcdoc=\"{}\"></iframe>\n", escaped(bake.name),
                     escaped(bake.page));
}

constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>paperbake: two bakes</title>
<style>
  body { margin: 0; font: 14px/1.45 system-ui, sans-serif; color: #222; background: #f6f5f2; }
  header { padding: 14px 24px 6px; }
  h1 { font-size: 20px; margin: 0; font-weight: 600; }
  .missed { color: #a3261b; }
  header p { margin: 2px 0; max-width: 120ch; }
  table { border-collapse: collapse; margin: 10px 24px; }
  th, td { text-align: left; padding: 1px 18px 1px 0; border-bottom: 1px solid #e2e0da; }
  td { color: #888; }
  .differs td { color: #222; }
  main { display: grid; grid-template-columns: 1fr 1fr; gap: 8px; padding: 8px; }
  iframe { width: 100%; height: 1500px; border: 1px solid #e2e0da; border-radius: 6px; }
</style>
</head>
<body>
)";

// the frame that one page shows is shown by the other
constexpr const char* tail = R"(<script>
"use strict";
const pages = [...document.querySelectorAll("iframe")];
window.addEventListener("message", event => {
  if (!event.data || !Number.isFinite(event.data.frame)) return;
  for (const page of pages)
    if (page.contentWindow !== event.source)
      page.contentWindow.postMessage({show: event.data.frame}, "*");
});
</script>
</body>
</html>
)";

}  // namespace

std::string comparison_page(const fs::path& folder_a, const fs::path& folder_b) {
  ReportedBake a = read_bake(folder_a), b = read_bake(folder_b);
  if (a.name == b.name) {
    a.name = folder_a.string();
    b.name = folder_b.string();
  }
  std::string page = head;
  page += fmt::format("<header><h1>{} and {}</h1>\n", escaped(a.name), escaped(b.name));
  page += verdict(a) + verdict(b) + "</header>\n";
  page += table("measured", a, b, measured_rows(a.summary, b.summary));
  const std::vector<Row> settings = settings_that_differ(a.summary, b.summary);
  if (!settings.empty()) page += table("settings that differ", a, b, settings);
  page += "<main>\n" + framed(a) + framed(b) + "</main>\n";
  return page + tail;
}

}  // namespace paperbake
