#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <span>

#include "validate_files.h"

namespace darboux {
namespace {

constexpr std::size_t most_tables = 12;

void print_finding(Severity severity, std::string_view code, const std::string& count,
                   std::string_view message) {
  std::cout << "    " << severity_names[static_cast<std::size_t>(severity)] << ' ' << code << " (" << count
            << "): " << message << '\n';
}

void print_local(const LocalReport& local) {
  const auto interior = std::find_if(local.classes.begin(), local.classes.end(), [](const ClassReport& c) {
    return c.vertex_class == VertexClass::interior && (c.normal_deg || c.tangent_deg);
  });
  if (interior == local.classes.end()) {
    std::cout << "    local: nothing is known of interior corners, their neighbours do not tell\n";
    return;
  }
  std::string text;
  const auto add = [&](const char* what, const std::optional<Statistics>& s, const Spread& uncertainty) {
    if (!s) return;
    text += (text.empty() ? "local: interior " : "; ") + std::string(what) + " differ by " +
            rounded(s->rms, 2) + " deg rms, uncertain by " + deviation_text(uncertainty.rms(), 2);
  };
  add("normals", interior->normal_deg, interior->normal_uncertainty_deg);
  add("tangents", interior->tangent_deg, interior->tangent_uncertainty_deg);
  std::cout << "    " << text << '\n';
  if (local.compared > 0)
    std::cout << "    local and analytic agree at " << rounded(100 * local.agreement, 3)
              << " % of interior corners\n";
}

void print_mikktspace(const MikkReport& mikktspace) {
  double max = 0, squares = 0, corners = 0;
  for (const ClassReport& c : mikktspace.classes)
    if (c.tangent_deg && c.vertex_class != VertexClass::pole) {
      const auto n = static_cast<double>(c.corners);
      max = std::fmax(max, c.tangent_deg->max);
      squares += n * c.tangent_deg->rms * c.tangent_deg->rms;
      corners += n;
    }
  std::cout << "    mikktspace: " << rounded(100 * mikktspace.equal_bits, 4) << " % of corners to the bit";
  if (mikktspace.variant == "reordered sums") std::cout << " (the rest by rounding)";
  if (corners > 0)
    std::cout << ", tangents differ by " << rounded(std::sqrt(squares / corners), 2) << " deg rms, "
              << rounded(max, 3) << " at most";
  std::cout << '\n';
}

void print_assessment(const JudgedPrimitive& judged, const Assessment& assessment, bool with_baseline) {
  const MeshReport& report = assessment.report;
  std::cout << "  " << place_of(judged.primitive, assessment) << ": " << report.corners << " corners";
  if (assessment.fit && assessment.fit->fits)
    std::cout << ", " << assessment.fit->surface.surface.specification(6) << ", uvs "
              << uv_convention(*assessment.fit);
  std::cout << ", w " << report.handedness.convention << ", judged by " << report.reference << '\n';
  if (!report.classes.empty())
    std::printf("    %-10s %9s  %-23s  %-23s  %-23s\n", "class", "corners", "normal max/rms (deg)",
                "tangent max/rms (deg)", "bitangent max/rms (deg)");
  std::cout.flush();
  for (const ClassReport& c : report.classes) {
    const auto cell = [](const std::optional<Statistics>& s) {
      if (!s) return std::string("-");
      char text[48];
      std::snprintf(text, sizeof text, "%.3g / %.3g", s->max, s->rms);
      return std::string(text);
    };
    std::printf("    %-10s %9zu  %-23s  %-23s  %-23s\n",
                std::string(vertex_class_names[static_cast<std::size_t>(c.vertex_class)]).c_str(), c.corners,
                cell(c.normal_deg).c_str(), cell(c.tangent_deg).c_str(), cell(c.bitangent_deg).c_str());
  }
  std::fflush(stdout);
  if ((report.reference == "analytic" || report.reference == "local") && report.corners > 0)
    std::cout << "    truth uncertain by "
              << deviation_text(report.normal_uncertainty_deg.rms(), 2, " deg rms") << " (normals), "
              << deviation_text(report.tangent_uncertainty_deg.rms(), 2, " deg rms") << " (tangents)\n";
  if (report.local && report.reference != "local") print_local(*report.local);
  if (report.triangles && report.triangles->judged > 0) {
    const TrianglesReport& t = *report.triangles;
    std::cout << "    triangles: " << t.judged - t.outside << " of " << t.judged
              << " corners lie within the cone of their own triangles";
    if (t.outside > 0) std::cout << ", the others up to " << rounded(t.worst_deg, 3) << " deg outside";
    std::cout << '\n';
  }
  if (report.mikktspace) print_mikktspace(*report.mikktspace);
  for (const Finding& f : report.findings) {
    std::string count = std::to_string(f.count);
    if (with_baseline) count += ", " + std::to_string(judged.known_count(f.code)) + " in the baseline";
    print_finding(f.severity, f.code, count, f.message);
  }
}

// "3 pass, 1 fail"
std::string counted(const std::array<std::size_t, verdict_names.size()>& verdicts) {
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < verdicts.size(); ++k)
    if (verdicts[k] > 0) texts.push_back(std::to_string(verdicts[k]) + ' ' + std::string(verdict_names[k]));
  return joined(texts);
}

// What was found in a file, without tables and notes.
void print_summary(const JudgedFile& file, bool with_baseline) {
  struct Total {
    const Finding* first;
    std::size_t count = 0, places = 0, known = 0;
  };
  std::vector<Total> totals;
  std::array<std::size_t, verdict_names.size()> verdicts{};
  std::size_t assessments = 0;
  for (const JudgedPrimitive& p : file.primitives) {
    for (const Assessment& j : p.assessments) {
      ++assessments;
      ++verdicts[static_cast<std::size_t>(j.report.verdict)];
      for (const Finding& f : j.report.findings) {
        if (f.severity == Severity::info) continue;
        auto at = std::find_if(totals.begin(), totals.end(),
                               [&](const Total& t) { return t.first->code == f.code; });
        if (at == totals.end()) at = totals.insert(at, {&f});
        at->count += f.count, ++at->places;
      }
    }
    for (Total& t : totals) t.known += p.known_count(t.first->code);
  }
  if (assessments > 1) std::cout << "  " << assessments << " meshes and parts: " << counted(verdicts) << '\n';
  std::stable_sort(totals.begin(), totals.end(),
                   [](const Total& a, const Total& b) { return a.first->severity > b.first->severity; });
  for (const Total& t : totals) {
    std::string count = std::to_string(t.count);
    if (assessments > 1) count += " in " + std::to_string(t.places) + " of them";
    if (with_baseline) count += ", " + std::to_string(t.known) + " in the baseline";
    print_finding(t.first->severity, t.first->code, count, t.first->message);
  }
}

// What of a code there is over all files.
struct CodeTotal {
  const Finding* first;
  Severity severity;
  std::size_t count = 0, files = 0;
};

std::vector<CodeTotal> totals_of(std::span<const JudgedFile> files) {
  std::vector<CodeTotal> totals;
  for (const JudgedFile& file : files) {
    for (const JudgedPrimitive& p : file.primitives)
      for (const Assessment& j : p.assessments)
        for (const Finding& f : j.report.findings) {
          if (f.severity == Severity::info) continue;
          auto at = std::find_if(totals.begin(), totals.end(), [&](const CodeTotal& t) {
            return t.first->code == f.code && t.severity == f.severity;
          });
          if (at == totals.end()) at = totals.insert(at, {&f, f.severity});
          at->count += f.count;
        }
    for (CodeTotal& t : totals)
      t.files += std::any_of(file.primitives.begin(), file.primitives.end(), [&](const JudgedPrimitive& p) {
        return std::any_of(p.assessments.begin(), p.assessments.end(), [&](const Assessment& j) {
          return std::any_of(j.report.findings.begin(), j.report.findings.end(), [&](const Finding& f) {
            return f.code == t.first->code && f.severity == t.severity;
          });
        });
      });
  }
  std::stable_sort(totals.begin(), totals.end(),
                   [](const CodeTotal& a, const CodeTotal& b) { return a.severity > b.severity; });
  return totals;
}

// What is wrong with a file, a line each code, and what to do.
void print_failure(const JudgedFile& file) {
  std::cout << "  " << one_line(file.path) << '\n';
  if (!file.error.empty()) {
    std::cout << "    cannot be read\n";
    return;
  }
  for (const CodeTotal& t : totals_of(std::span(&file, 1)))
    if (t.severity == Severity::error)
      std::cout << "    " << t.first->code << " (" << t.count << "), to do: " << t.first->to_do << '\n';
  if (file.verdict == Verdict::undetermined)
    std::cout << "    undetermined: nothing could judge its tangents\n";
}

// The end of a report of several files, that reads alone: how many of each verdict, what was found, which
// files failed.
void print_closing(const std::vector<JudgedFile>& files, std::size_t unreadable) {
  constexpr std::size_t most_failures = 12;
  std::array<std::size_t, verdict_names.size()> verdicts{};
  for (const JudgedFile& file : files)
    if (file.error.empty()) ++verdicts[static_cast<std::size_t>(file.verdict)];
  const std::vector<CodeTotal> totals = totals_of(files);
  if (!totals.empty()) std::cout << "found:\n";
  for (const CodeTotal& t : totals)
    std::cout << "  " << severity_names[static_cast<std::size_t>(t.severity)] << ' ' << t.first->code << ": "
              << t.count << " in " << t.files << (t.files == 1 ? " file" : " files") << '\n';
  std::size_t bad = 0;
  for (const JudgedFile& file : files) {
    if (file.verdict <= Verdict::pass && file.error.empty()) continue;
    if (++bad == 1) std::cout << "failed or undetermined:\n";
    if (bad <= most_failures) print_failure(file);
  }
  if (bad > most_failures) std::cout << "  and " << bad - most_failures << " more above\n";
  std::string text = counted(verdicts);
  if (unreadable > 0) text += (text.empty() ? "" : ", ") + std::to_string(unreadable) + " unreadable";
  std::cout << files.size() << " files: " << text << '\n';
}

}  // namespace

void print_people(const std::vector<JudgedFile>& files, bool with_baseline, bool details) {
  std::size_t assessments = 0, unreadable = 0;
  for (const JudgedFile& file : files)
    for (const JudgedPrimitive& p : file.primitives) assessments += p.assessments.size();
  const bool tables = details || assessments <= most_tables;
  for (const JudgedFile& file : files) {
    if (!file.error.empty()) {
      ++unreadable;
      continue;
    }
    std::cout << one_line(file.path) << ": " << verdict_names[static_cast<std::size_t>(file.verdict)] << '\n';
    if (file.primitives.empty()) std::cout << "  holds no triangles to judge\n";
    if (tables)
      for (const JudgedPrimitive& p : file.primitives)
        for (const Assessment& j : p.assessments) print_assessment(p, j, with_baseline);
    else
      print_summary(file, with_baseline);
    for (const SkippedPrimitive& s : file.skipped)
      std::cout << "  mesh " << s.mesh << " primitive " << s.primitive << " not judged: " << s.reason << '\n';
  }
  if (!tables)
    std::cout << "--details shows a table and the notes of each of the " << assessments
              << " meshes and parts\n";
  if (files.size() > 1) print_closing(files, unreadable);
  std::map<std::string, std::size_t> ignored;
  for (const JudgedFile& file : files)
    for (const auto& [code, count] : file.ignored) ignored[code] += count;
  for (const auto& [code, count] : ignored) std::cout << "ignored: " << code << " (" << count << ")\n";
  if (with_baseline) {
    const auto worse = std::count_if(files.begin(), files.end(), [](const JudgedFile& f) { return f.worse; });
    std::cout << (worse == 0 ? "nothing is"
                             : std::to_string(worse) + (files.size() == 1 ? " file " : " files ") +
                                   (worse == 1 ? "is" : "are"))
              << " worse than in the baseline\n";
  }
}

}  // namespace darboux
