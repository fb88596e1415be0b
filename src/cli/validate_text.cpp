#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "base/counted.h"
#include "base/text.h"
#include "report_command.h"
#include "validate_files.h"

namespace darboux {
namespace {

constexpr std::size_t most_tables = 12;
constexpr const char* known_verdict = " (no worse than in the baseline)";

void print_finding(Severity severity, std::string_view code, const std::string& count,
                   std::string_view message) {
  std::cout << "    " << name_of(severity) << ' ' << code << " (" << count << "): " << message << '\n';
}

void print_local(const LocalReport& local) {
  const auto interior = std::find_if(local.classes.begin(), local.classes.end(), [](const ClassReport& c) {
    return c.vertex_class == VertexClass::interior && (c.normal_deg || c.tangent_deg);
  });
  if (interior == local.classes.end()) {
    std::cout << "    local: nothing to compare at interior corners\n";
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
  if (mikktspace.variant == MikkVariant::reordered_sums) std::cout << " (the rest by rounding)";
  if (corners > 0)
    std::cout << ", tangents differ by " << rounded(std::sqrt(squares / corners), 2) << " deg rms, "
              << rounded(max, 3) << " at most";
  std::cout << '\n';
}

void print_assessment(const AssessedPrimitive& assessed, std::size_t number, bool with_baseline) {
  const Assessment& assessment = assessed.assessments[number];
  const MeshReport& report = assessment.report;
  std::cout << "  " << place_of(assessed.primitive, assessment) << ": " << counted(report.corners, "corner");
  if (assessment.fit && assessment.fit->fits)
    std::cout << ", " << assessment.fit->surface.surface.specification(6) << ", uvs "
              << (assessed.primitive.texcoord < 0 ? "none" : uv_convention(*assessment.fit));
  std::cout << ", w " << name_of(report.handedness.convention) << ", judged by " << name_of(report.reference);
  if (const auto& needs = assessed.primitive.needs_tangents)
    std::cout << "; its material reads " << (*needs ? "" : "no ") << "tangents";
  std::cout << '\n';
  const ReferenceKind angles_to = reference_of_classes(assessment);
  const bool other = angles_to != ReferenceKind::none && angles_to != report.reference;
  if (!report.classes.empty())
    std::printf("    %-10s %9s  %-23s  %-23s  %-23s%s\n", "class", "corners", "normal max/rms (deg)",
                "tangent max/rms (deg)", "bitangent max/rms (deg)",
                other ? ("  against " + std::string(name_of(angles_to))).c_str() : "");
  std::cout.flush();
  for (const ClassReport& c : report.classes) {
    const auto cell = [](const std::optional<Statistics>& s) {
      if (!s) return std::string("-");
      char text[48];
      std::snprintf(text, sizeof text, "%.3g / %.3g", s->max, s->rms);
      return std::string(text);
    };
    std::printf("    %-10s %9zu  %-23s  %-23s  %s\n", std::string(name_of(c.vertex_class)).c_str(), c.corners,
                cell(c.normal_deg).c_str(), cell(c.tangent_deg).c_str(), cell(c.bitangent_deg).c_str());
  }
  std::fflush(stdout);
  if (has_uncertainty(report) && report.corners > 0) {
    std::cout << "    uncertainty of the truth: "
              << deviation_text(report.normal_uncertainty_deg.rms(), 2, " deg rms") << " (normals)";
    if (has_tangent_angles(report))
      std::cout << ", " << deviation_text(report.tangent_uncertainty_deg.rms(), 2, " deg rms")
                << " (tangents)";
    std::cout << '\n';
  }
  if (report.local && report.reference != ReferenceKind::local) print_local(*report.local);
  if (report.uncompared_normals > 0)
    std::cout << "    normals: at " << report.uncompared_normals << " of "
              << counted(report.corners, "corner")
              << " no average of their triangles', and nothing else is known of them; up to 80 deg off is no "
                 "error\n";
  if (report.triangles && report.triangles->compared + report.triangles->open > 0) {
    const TrianglesReport& t = *report.triangles;
    std::cout << "    triangles: ";
    if (t.compared > 0)
      std::cout << t.compared - t.outside << " of " << counted(t.compared, "corner")
                << " lie within the cone of their own triangles";
    if (t.outside > 0) std::cout << ", the others up to " << rounded(t.worst_deg, 3) << " deg outside";
    if (t.open > 0)
      std::cout << (t.compared > 0 ? "; " : "") << "they cannot judge "
                << counted(t.open, t.compared > 0 ? "other corner" : "corner");
    std::cout << '\n';
  }
  if (report.mikktspace) print_mikktspace(*report.mikktspace);
  if (!assessed.map_costs.empty()) print_map_cost(assessed.map_costs[number]);
  for (std::size_t k = 0; k < report.findings.size(); ++k) {
    const Finding& f = report.findings[k];
    std::string count = std::to_string(f.count);
    if (with_baseline)
      count += ", " + std::to_string(assessed.known_count(code_of(f), assessed.own_severities[number][k])) +
               " in the baseline";
    print_finding(f.severity, f.code, count, f.message);
  }
}

// "3 pass, 1 fail"
std::string verdicts_text(const std::array<std::size_t, verdict_names.size()>& verdicts) {
  std::vector<std::string> texts;
  for (std::size_t k = 0; k < verdicts.size(); ++k)
    if (verdicts[k] > 0) texts.push_back(std::to_string(verdicts[k]) + ' ' + std::string(verdict_names[k]));
  return joined(texts);
}

// The count of a code with one severity.
struct CodeTotal {
  const Finding* first;  // which was found
  std::size_t count = 0, places = 0, files = 0, known = 0;
  std::vector<std::string> to_do{};  // each once
};

// Errors and warnings of the files, errors first. `known` counts those of the baseline in primitives that
// have none now.
std::vector<CodeTotal> totals_of(std::span<const AssessedFile> files) {
  struct Gathered {
    CodeTotal total;
    std::set<Severity> own{};
    const AssessedFile* last = nullptr;
  };
  std::vector<Gathered> gathered;
  for (const AssessedFile& file : files)
    for (const AssessedPrimitive& p : file.primitives)
      p.each_finding([&](const Assessment&, const Finding& f, Severity own) {
        if (f.severity == Severity::info) return;
        auto at = std::find_if(gathered.begin(), gathered.end(), [&](const Gathered& g) {
          return g.total.first->kind == f.kind && g.total.first->severity == f.severity;
        });
        if (at == gathered.end()) at = gathered.insert(at, Gathered{.total = {.first = &f}});
        at->total.count += f.count, ++at->total.places;
        std::vector<std::string>& to_do = at->total.to_do;
        if (std::find(to_do.begin(), to_do.end(), f.to_do) == to_do.end()) to_do.emplace_back(f.to_do);
        at->total.files += std::exchange(at->last, &file) != &file;
        at->own.insert(own);
      });
  std::stable_sort(gathered.begin(), gathered.end(), [](const Gathered& a, const Gathered& b) {
    return a.total.first->severity > b.total.first->severity;
  });
  std::vector<CodeTotal> totals;
  for (Gathered& g : gathered) {
    for (const AssessedFile& file : files)
      for (const AssessedPrimitive& p : file.primitives)
        for (const Severity own : g.own) g.total.known += p.known_count(code_of(*g.total.first), own);
    totals.push_back(g.total);
  }
  return totals;
}

// "6 parts: 6 fail", of a file with several.
std::string overview(const AssessedFile& file) {
  std::array<std::size_t, verdict_names.size()> verdicts{};
  std::size_t count = 0;
  bool with_parts = false;
  for (const AssessedPrimitive& p : file.primitives) {
    with_parts |= p.assessments.size() > 1;
    for (const Assessment& j : p.assessments) ++count, ++verdicts[static_cast<std::size_t>(j.report.verdict)];
  }
  const char* what = !with_parts ? "meshes" : file.primitives.size() == 1 ? "parts" : "meshes and parts";
  return count < 2 ? "" : std::to_string(count) + ' ' + what + ": " + verdicts_text(verdicts);
}

// The same with all codes: "6 parts: 6 fail; TANGENT_ANGLE 720; warnings: NORMAL_ANGLE 12".
std::string overview_with_codes(const AssessedFile& file) {
  std::string text = overview(file);
  if (text.empty()) return text;
  std::string errors, warnings;
  for (const CodeTotal& t : totals_of(std::span(&file, 1))) {
    std::string& list = t.first->severity == Severity::error ? errors : warnings;
    list += (list.empty() ? "" : ", ") + std::string(t.first->code) + ' ' + std::to_string(t.count);
  }
  if (!errors.empty()) text += "; " + errors;
  if (!warnings.empty()) text += "; warnings: " + warnings;
  return text;
}

// Prints the findings of a file, without tables and notes.
void print_summary(const AssessedFile& file, bool with_baseline) {
  const std::string first = overview(file);
  if (!first.empty()) std::cout << "  " << first << '\n';
  for (const CodeTotal& t : totals_of(std::span(&file, 1))) {
    std::string count = std::to_string(t.count);
    if (!first.empty()) count += " in " + std::to_string(t.places) + " of them";
    if (with_baseline) count += ", " + std::to_string(t.known) + " in the baseline";
    print_finding(t.first->severity, t.first->code, count, t.first->message);
  }
}

// Why there is nothing to assess in a file.
std::string nothing_because(const AssessedFile& file) {
  if (file.primitives.empty() &&
      std::any_of(file.skipped.begin(), file.skipped.end(),
                  [](const SkippedPrimitive& s) { return s.reason == unneeded_reason; }))
    return "nothing that needs tangents (--only needed)";
  const bool triangles = std::any_of(file.primitives.begin(), file.primitives.end(), [](const auto& p) {
    return std::any_of(p.assessments.begin(), p.assessments.end(),
                       [](const Assessment& j) { return j.report.corners > 0; });
  });
  return triangles ? "neither normals nor tangents to judge" : "no triangles to judge";
}

// Whether the file needs attention.
bool has_something(const AssessedFile& file) {
  return file.verdict > Verdict::pass || file.lost || !totals_of(std::span(&file, 1)).empty();
}

// The first sentence of the reason why a file cannot be read, without its path: "is not JSON, expected ...".
std::string first_sentence(const AssessedFile& file) {
  std::string text = file.error;
  const std::string path = message_name(file.path) + ": ";
  if (text.starts_with(path)) text.erase(0, path.size());
  return text.substr(0, std::min(text.find(". "), text.size()));
}

// Files that fail, are undetermined or cannot be read, one line each.
void print_bad(const std::vector<AssessedFile>& files, bool with_baseline) {
  const auto print = [&](const char* title, auto&& is_wanted, auto&& text) {
    bool first = true;
    for (const AssessedFile& file : files) {
      if (!is_wanted(file)) continue;
      if (first) std::cout << title << ":\n";
      first = false;
      std::cout << "  " << one_line(file.path) << ": " << text(file)
                << (with_baseline && !file.worse ? known_verdict : "") << '\n';
    }
  };
  const auto first_code = [](const AssessedFile& file) {
    std::vector<CodeTotal> totals = totals_of(std::span(&file, 1));
    const auto is_reason = [&](const CodeTotal& t) {
      return file.verdict == Verdict::fail ? t.first->severity == Severity::error
                                           : code_of(*t.first) == Code::undetermined;
    };
    std::erase_if(totals, [&](const CodeTotal& t) { return !is_reason(t); });
    if (totals.empty()) return finding(Code::undetermined, 1).message;  // the finding is ignored
    return std::string(totals[0].first->code) + " (" + std::to_string(totals[0].count) + ")" +
           (totals.size() > 1 ? " and " + std::to_string(totals.size() - 1) +
                                    (totals.size() == 2 ? " more code" : " more codes")
                              : std::string());
  };
  const auto is = [](Verdict verdict) {
    return [verdict](const AssessedFile& file) { return file.readable() && file.verdict == verdict; };
  };
  print("failed", is(Verdict::fail), first_code);
  print("undetermined", is(Verdict::undetermined), first_code);
  print(
      "nothing to judge now, and passed in the baseline", [](const AssessedFile& file) { return file.lost; },
      [](const AssessedFile& file) { return "holds " + nothing_because(file); });
  print(
      "cannot be read", [](const AssessedFile& file) { return !file.readable(); }, first_sentence);
}

// Files that neither failed nor need attention, one line per reason.
void print_rest(const std::vector<AssessedFile>& files) {
  std::size_t plain = 0, with_warnings = 0;
  std::map<std::string, std::size_t> nothing, skipped;
  for (const AssessedFile& file : files) {
    for (const SkippedPrimitive& s : file.skipped) ++skipped[s.reason];
    if (!file.readable() || file.verdict > Verdict::pass) continue;
    if (file.verdict == Verdict::nothing)
      ++nothing[nothing_because(file)];
    else
      ++(has_something(file) ? with_warnings : plain);
  }
  if (plain + with_warnings + nothing.size() + skipped.size() > 0) std::cout << "the rest:\n";
  if (plain > 0) std::cout << "  " << counted(plain, "file") << ": pass, nothing found\n";
  if (with_warnings > 0) std::cout << "  " << counted(with_warnings, "file") << ": pass, with warnings\n";
  for (const auto& [reason, count] : nothing)
    std::cout << "  " << counted(count, "file") << ": " << reason << '\n';
  for (const auto& [reason, count] : skipped)
    std::cout << "  " << counted(count, "primitive") << " not judged: " << reason << '\n';
}

// "pass, with warnings"
std::string verdict_text(const AssessedFile& file) {
  const std::vector<CodeTotal> totals = totals_of(std::span(&file, 1));
  const bool with_warnings =
      file.verdict == Verdict::pass && std::any_of(totals.begin(), totals.end(), [](const CodeTotal& t) {
        return t.first->severity == Severity::warning;
      });
  return std::string(name_of(file.verdict)) + (with_warnings ? ", with warnings" : "");
}

// New tangents fix errors of tangents (docs/findings.md) where normals and uvs are sound. Tangents that are
// already MikkTSpace's, yet wrong, would only be written again.
void print_command(const AssessedFile& file, const std::vector<CodeTotal>& totals) {
  const auto any = [&](auto&& is) {
    return std::any_of(totals.begin(), totals.end(), [&](const CodeTotal& t) { return is(*t.first); });
  };
  const auto has = [&](Code code) { return any([code](const Finding& f) { return code_of(f) == code; }); };
  const auto is_error = [](const Finding& f, std::string_view of) {
    return f.severity == Severity::error && f.code.starts_with(of);
  };
  const std::string extension = lower(std::filesystem::path(file.path).extension().string());
  if ((extension == ".glb" || extension == ".gltf") && !has(Code::normal_missing) && !has(Code::uv_missing) &&
      !any([&](const Finding& f) { return is_error(f, "NORMAL"); }) && any([&](const Finding& f) {
        return is_error(f, "TANGENT_") &&
               (code_of(f) != Code::tangent_angle || has(Code::tangent_not_mikktspace));
      }))
    std::cout << "  new tangents: darboux tangents " << shell_quoted(one_line(file.path)) << " -o mended"
              << extension << '\n';
}

// The remedies for the findings, each once; if a code has several, with the severity.
void print_to_do(const std::vector<AssessedFile>& files) {
  const std::vector<CodeTotal> totals = totals_of(files);
  if (totals.empty()) return;
  std::map<std::string_view, std::set<std::string_view>> of_code;
  for (const CodeTotal& t : totals) of_code[t.first->code].insert(t.to_do.begin(), t.to_do.end());
  std::set<std::string> said;
  std::cout << "to do:\n";
  for (const CodeTotal& t : totals)
    for (const std::string& to_do : t.to_do) {
      const std::string severity(of_code[t.first->code].size() > 1 ? name_of(t.first->severity) : "");
      const std::string line =
          std::string(t.first->code) + (severity.empty() ? "" : " (" + severity + ")") + ": " + to_do;
      if (said.insert(line).second) std::cout << "  " << line << '\n';
    }
  if (files.size() == 1) print_command(files[0], totals);
}

// The self-contained summary at the end of a report on several files: findings and remedies, files that
// failed or cannot be read, and the number of others.
void print_closing(const std::vector<AssessedFile>& files, std::size_t unreadable, bool with_baseline) {
  std::array<std::size_t, verdict_names.size()> verdicts{};
  for (const AssessedFile& file : files)
    if (file.readable()) ++verdicts[static_cast<std::size_t>(file.verdict)];
  const std::vector<CodeTotal> totals = totals_of(files);
  if (!totals.empty()) std::cout << "found:\n";
  for (const CodeTotal& t : totals) {
    std::cout << "  " << name_of(t.first->severity) << ' ' << t.first->code << ": " << t.count << " in "
              << counted(t.files, "file") << ". To do: " << joined(t.to_do, "; or: ") << '\n';
  }
  print_bad(files, with_baseline);
  print_rest(files);
  std::string text = verdicts_text(verdicts);
  if (unreadable > 0) text += (text.empty() ? "" : ", ") + std::to_string(unreadable) + " unreadable";
  std::cout << files.size() << " files: " << text << '\n';
}

}  // namespace

void print_text(const std::vector<AssessedFile>& files, bool with_baseline, bool details, bool quiet) {
  std::size_t assessments = 0, unreadable = 0;
  for (const AssessedFile& file : files)
    for (const AssessedPrimitive& p : file.primitives) assessments += p.assessments.size();
  if (quiet) {
    for (const AssessedFile& file : files)
      if (file.readable())
        std::cout << one_line(file.path) << ": " << verdict_text(file)
                  << (with_baseline && file.verdict > Verdict::pass && !file.worse ? known_verdict : "")
                  << '\n';
    return;
  }
  const bool tables = details || (assessments <= most_tables && files.size() <= most_tables);
  for (const AssessedFile& file : files) {
    if (!file.readable()) {
      ++unreadable;
      continue;
    }
    if (!tables && files.size() > 1 && !has_something(file)) continue;
    std::cout << one_line(file.path) << ": " << verdict_text(file) << '\n';
    if (file.verdict == Verdict::nothing)
      std::cout << "  holds " << nothing_because(file) << (file.lost ? "; it passed in the baseline" : "")
                << '\n';
    if (!tables) {
      print_summary(file, with_baseline);
      continue;
    }
    if (const std::string line = overview_with_codes(file); !line.empty()) std::cout << "  " << line << '\n';
    for (const AssessedPrimitive& p : file.primitives)
      for (std::size_t a = 0; a < p.assessments.size(); ++a) print_assessment(p, a, with_baseline);
    for (const SkippedPrimitive& s : file.skipped)
      std::cout << "  " << primitive_text(s.mesh, s.primitive) << " not judged: " << s.reason << '\n';
  }
  if (!tables)
    std::cout << "--details shows a table and the notes of each of the " << assessments << " meshes and parts"
              << (files.size() > 1 ? ", and of files that are not listed here" : "") << '\n';
  if (files.size() > 1)
    print_closing(files, unreadable, with_baseline);
  else
    print_to_do(files);
  std::map<std::string, std::size_t> ignored;
  for (const AssessedFile& file : files)
    for (const auto& [code, count] : file.ignored) ignored[code] += count;
  for (const auto& [code, count] : ignored) std::cout << "ignored: " << code << " (" << count << ")\n";
  if (with_baseline) {
    const auto worse =
        std::count_if(files.begin(), files.end(), [](const AssessedFile& f) { return f.worse; });
    std::cout << (worse == 0 ? "nothing is"
                             : std::to_string(worse) + (files.size() == 1 ? " file " : " files ") +
                                   (worse == 1 ? "is" : "are"))
              << " worse than in the baseline\n";
  }
}

}  // namespace darboux
