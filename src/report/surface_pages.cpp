#include "surface_pages.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include <darboux/any_surface.h>
#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "surface_picture.h"

namespace darboux {

// Embedded by the build: the headers of the surfaces by their names without folder and extension,
// docs/references.bib.
extern const std::span<const std::pair<std::string_view, std::string_view>> surface_headers;
extern const std::string_view references_bib;

namespace {

using Lines = std::vector<std::string_view>;

constexpr double example_u = 0.3, example_v = 0.7;

Lines split_lines(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string_view without_indent(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line;
}

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string_view leading_word(std::string_view text) {
  return text.substr(
      0, static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_word) - text.begin()));
}

// ---- what a header says -----------------------------------------------------------------------------------

// The lines of the comment that ends above line k and the template heads there, without slashes and the blank
// after.
Lines comment_above(const Lines& lines, std::size_t k) {
  while (k > 0 && without_indent(lines[k - 1]).starts_with("template")) --k;
  Lines comment;
  for (; k > 0 && without_indent(lines[k - 1]).starts_with("///"); --k) {
    std::string_view line = without_indent(lines[k - 1]).substr(3);
    if (line.starts_with(' ')) line.remove_prefix(1);
    comment.insert(comment.begin(), line);
  }
  return comment;
}

struct Header {
  std::string stem;
  std::string type;        // the surface's, e.g. "Torus"
  Lines comment;           // above the type
  std::size_t guided = 0;  // number of doubles that construct one, e.g. Torus{1.0, 0.25}; 0 if none
  std::map<std::string_view, Lines> facts;  // the comment above each
};

[[noreturn]] void throw_undocumented(const std::string& name) {
  throw Error(name, "header: expected a comment above the type, as in torus.h, got none");
}

Header read_header(const AnySurface& surface) {
  const std::string name(surface.info().name);
  Header header;
  header.stem = name;
  std::replace(header.stem.begin(), header.stem.end(), '-', '_');
  const auto found = std::find_if(surface_headers.begin(), surface_headers.end(),
                                  [&](const auto& h) { return h.first == header.stem; });
  if (found == surface_headers.end()) throw_undocumented(name);
  const Lines lines = split_lines(found->second);

  std::size_t k = 0;
  while (k < lines.size() && lines[k].find("SurfaceInfo info") == std::string_view::npos) ++k;
  if (k == lines.size()) throw_undocumented(name);
  while (k > 0 && !lines[k].starts_with("struct ") && !lines[k].starts_with("class ")) --k;
  header.type = leading_word(lines[k].substr(std::min(lines[k].find(' ') + 1, lines[k].size())));
  header.comment = comment_above(lines, k);
  if (header.comment.empty()) throw_undocumented(name);

  const std::string guide = header.type + "(double";
  for (const std::string_view line : lines) {
    if (!line.starts_with(guide)) continue;
    const std::string_view arguments = line.substr(0, line.find(')'));
    header.guided = 1 + static_cast<std::size_t>(std::count(arguments.begin(), arguments.end(), ','));
  }
  for (const std::string_view fact : surface.facts()) {
    const std::string declared = " " + std::string(fact) + "(";
    for (k = 0; k < lines.size(); ++k)
      if (lines[k].starts_with("  ") && is_word(lines[k].substr(2, 1)[0]) &&
          lines[k].find("return ") == std::string_view::npos &&
          lines[k].find(declared) != std::string_view::npos) {
        header.facts[fact] = comment_above(lines, k);
        break;
      }
  }
  return header;
}

// ---- Markdown ---------------------------------------------------------------------------------------------

// Prose of a comment as Markdown: status bits and parameters as code, special characters escaped.
std::string prose(std::string_view line, const std::vector<std::string_view>& code) {
  std::string result;
  if (line.starts_with("+ ") || line.starts_with("- ") || line.starts_with("# ")) result += '\\';
  while (!line.empty()) {
    const std::string_view word = leading_word(line);
    if (!word.empty()) {
      const bool is_code =
          word.find('_') != std::string_view::npos && std::find(code.begin(), code.end(), word) != code.end();
      result += is_code ? "`" + std::string(word) + "`" : std::string(word);
      line.remove_prefix(word.size());
      continue;
    }
    const char next = line.size() > 1 ? line[1] : ' ';
    if (line[0] == '*' || line[0] == '`' || line[0] == '\\' ||
        (line[0] == '<' && (is_word(next) || next == '/' || next == '!')))
      result += '\\';
    result += line[0];
    line.remove_prefix(1);
  }
  return result;
}

// A comment as Markdown, indented lines as blocks of code. `indent` goes before each line.
std::string markdown(const Lines& comment, const std::vector<std::string_view>& code,
                     const std::string& indent = "") {
  std::string result;
  bool in_code = false;
  for (const std::string_view line : comment) {
    const bool formula = line.starts_with("  ");
    if (formula != in_code) {
      if (formula && !result.empty()) result += "\n";
      result += indent + (formula ? "```\n" : "```\n\n");
    }
    in_code = formula;
    result += indent + (formula ? std::string(line.substr(2)) : prose(line, code)) + "\n";
  }
  return in_code ? result + indent + "```\n" : result;
}

std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '|' ? "\\|" : std::string(1, c);
  return result;
}

std::string code_block(std::string_view marker, std::string_view language, const std::string& text) {
  return "<!-- " + std::string(marker) + " -->\n```" + std::string(language) + "\n" + text + "```\n";
}

// ---- references -------------------------------------------------------------------------------------------

// A field of a BibTeX entry without its braces; empty if there is none.
std::string field(std::string_view entry, std::string_view name) {
  for (const std::string_view line : split_lines(entry)) {
    const std::string_view text = without_indent(line);
    if (leading_word(text) != name) continue;
    std::string value;
    for (const char c : text.substr(std::min(text.find('=') + 1, text.size())))
      if (c != '{' && c != '}') value += c;
    while (value.ends_with(' ') || value.ends_with(',')) value.pop_back();
    return std::string(without_indent(value));
  }
  return {};
}

// "do Carmo, Manfredo P. and Some, One" to "Manfredo P. do Carmo, One Some"
std::string people(std::string_view authors) {
  std::string result;
  while (!authors.empty()) {
    const std::size_t end = std::min(authors.find(" and "), authors.size());
    const std::string_view one = authors.substr(0, end);
    authors.remove_prefix(std::min(end + 5, authors.size()));
    const std::size_t comma = one.find(", ");
    result += (result.empty() ? "" : ", ") +
              (comma == std::string_view::npos
                   ? std::string(one)
                   : std::string(one.substr(comma + 2)) + " " + std::string(one.substr(0, comma)));
  }
  return result;
}

std::string described(const std::string& key) {
  const std::size_t begin = references_bib.find("{" + key + ",");
  if (begin == std::string_view::npos) throw Error(key, "is cited but has no entry in docs/references.bib");
  const std::string_view entry = references_bib.substr(begin, references_bib.find("\n}", begin) - begin);
  std::string result = people(field(entry, "author")) + ": *" + field(entry, "title") + "*";
  for (const char* name : {"edition", "journal", "publisher", "school", "year"})
    if (const std::string value = field(entry, name); !value.empty()) result += ", " + value;
  return result;
}

// The sources that a text cites as [doCarmo2016] or [doCarmo2016, sec. 2-2], with the section, in the order
// of citation.
std::vector<std::pair<std::string, std::vector<std::string>>> citations(const std::string& text) {
  std::vector<std::pair<std::string, std::vector<std::string>>> result;
  for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
    const std::string_view inside = std::string_view(text).substr(at + 1, text.find(']', at) - at - 1);
    const std::string key(leading_word(inside));
    const bool named = key.size() > 4 && !(key[0] >= '0' && key[0] <= '9') &&
                       std::all_of(key.end() - 4, key.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
                       (key.size() == inside.size() || inside[key.size()] == ',');
    if (!named) continue;
    auto known = std::find_if(result.begin(), result.end(), [&](const auto& c) { return c.first == key; });
    if (known == result.end()) known = result.insert(result.end(), {key, {}});
    // With single spaces, as it may span two lines.
    std::istringstream words{std::string(inside.substr(std::min(key.size() + 1, inside.size())))};
    std::string place;
    for (std::string word; words >> word;) place += (place.empty() ? "" : " ") + word;
    if (!place.empty() && std::find(known->second.begin(), known->second.end(), place) == known->second.end())
      known->second.push_back(place);
  }
  return result;
}

// ---- the parts of a page ----------------------------------------------------------------------------------

std::string parameters(const AnySurface& surface) {
  std::string text = "## Parameters\n\n";
  if (surface.parameters().empty()) {
    const std::string name(surface.info().name);
    const auto kinds = surface_file_kinds();
    text += "None: its numbers are lists. On the command line `" + name + "` is a built-in example";
    if (std::find(kinds.begin(), kinds.end(), name) != kinds.end())
      text += ", and\n`" + name + ":file=FILE` reads [one of yours](../howto/your-own-surface-in-a-file.md)";
    return text + ". In C++ it is made from the data that its\nheader names.\n\n";
  }
  text += "| name | default | range | meaning | error bounds proven for |\n|---|---|---|---|---|\n";
  for (const ParameterValue& p : surface.parameters())
    text += "| `" + std::string(p.name) + "` | " + shortest(p.default_value) + " | " +
            describe(p.permitted, p.name) + " | " + cell(p.meaning) + " | " + shortest(p.proven.smallest) +
            " to " + shortest(p.proven.largest) + " |\n";
  return text + "\nThe last column is about magnitudes. Every permitted value may be used.\n\n";
}

std::string coordinate(char name, Coordinate kind) {
  constexpr std::string_view kinds[] = {"linear", "turn", "half_turn", "twisted_turn"};
  constexpr std::string_view periods[] = {"no", "yes, period 1", "no", "P(u + 1, v) = P(u, 1 - v), period 2"};
  const auto k = static_cast<std::size_t>(kind);
  return "| " + std::string(1, name) + " | `" + std::string(kinds[k]) + "` | " + std::string(periods[k]) +
         " |\n";
}

std::string properties(const AnySurface& surface) {
  const SurfaceInfo& info = surface.info();
  std::string text =
      "## Chart\n\n| coordinate | [kind](../conventions.md#coordinates) | periodic |\n|---|---|---|\n" +
      coordinate('u', info.u) + coordinate('v', info.v) + "\n";
  std::string singular;
  for (const std::string_view set : info.singular)
    if (!set.empty()) singular += (singular.empty() ? "" : "; ") + std::string(set);
  text += "- Singular: " + (singular.empty() ? "nowhere" : singular) + ".\n";
  text += info.orientable ? "- Orientable.\n" : "- Not orientable: n has two values at each point.\n";
  if (info.euler_characteristic)
    text += "- Closed, of Euler characteristic " + std::to_string(*info.euler_characteristic) + ".\n";
  if (info.own_orientation)
    text += "- n is the surface's own. Where it opposes dpdu × dpdv the handedness is -1.\n";
  if (surface.has_closed_frame())
    text += "- Frame in closed form, components within " + shortest(info.frame_error) +
            " units of roundoff (2^-53 in double) times (1 + condition).\n";
  else
    text += "- Frame from the partials.\n";
  return text + "\n";
}

std::string facts(const AnySurface& surface, const Header& header,
                  const std::vector<std::string_view>& code) {
  constexpr std::pair<std::string_view, std::string_view> meanings[] = {
      {"implicit", "`implicit(p)`, the signed distance to first order"},
      {"gaussian_curvature", "`gaussian_curvature(u, v)`"},
      {"mean_curvature", "`mean_curvature(u, v)`, with the sign that belongs to n"},
      {"second_formula", "`second_formula(u, v)`, the position by another formula"}};
  std::string text =
      "## Facts\n\nKnown from elsewhere than the formula above and its derivatives; `darboux check " +
      std::string(surface.info().name) + "` compares.\n\n";
  for (const auto& [fact, meaning] : meanings) {
    const auto all = surface.facts();
    if (std::find(all.begin(), all.end(), fact) == all.end()) continue;
    const auto comment = header.facts.find(fact);
    text += "- " + std::string(meaning);
    text += comment == header.facts.end() || comment->second.empty()
                ? ".\n"
                : ":\n" + markdown(comment->second, code, "  ");
  }
  return text + "\n";
}

// As `darboux eval` prints it.
std::string evaluated(const AnySurface& surface) {
  const Sample<double> s = surface.sample(example_u, example_v);
  std::string status;
  for (std::size_t k = 0; k < status_names.size(); ++k)
    if (has(s.frame.status, static_cast<Status>(1u << k)))
      status += (status.empty() ? "" : "|") + std::string(status_names[k]);
  std::string text = "u = " + shortest(example_u) + ", v = " + shortest(example_v) + "    " +
                     (status.empty() ? "regular" : status) + "\n";
  const auto row = [&](std::string_view name, std::initializer_list<double> values) {
    char buffer[32];
    text += "    " + std::string(name) + std::string(22 - name.size(), ' ');
    for (const double x : values) {
      std::snprintf(buffer, sizeof buffer, " %12.8g", x);
      text += buffer;
    }
    text += "\n";
  };
  const auto vector = [&](std::string_view name, const Vec3<double>& a) { row(name, {a.x, a.y, a.z}); };
  vector("position", s.jet.position);
  vector("tangent", s.frame.t);
  vector("bitangent", s.frame.b);
  vector("normal", s.frame.n);
  row("handedness", {s.frame.handedness});
  return text;
}

std::string literal(double x) {
  const std::string text = shortest(x);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string examples(const AnySurface& surface, const Header& header) {
  const std::string name(surface.info().name), at = shortest(example_u) + "," + shortest(example_v);
  std::string made = header.type + "<> surface{};", comment;
  if (const auto all = surface.parameters(); !all.empty() && all.size() == header.guided) {
    made.clear();
    for (const ParameterValue& p : all) {
      made += (made.empty() ? header.type + " surface{" : ", ") + literal(p.default_value);
      comment += (comment.empty() ? "// " : ", ") + std::string(p.name);
    }
    made += "};";
    comment += "\n";
  }
  return "## Use\n\n" + code_block("runs", "sh", "darboux eval " + name + " --at " + at + "\n") + "\n" +
         code_block("output", "text", evaluated(surface)) + "\nIn C++:\n\n" +
         code_block("not run: tests/docs/surface_snippets.sh makes it a program", "cpp",
                    "#include <darboux/evaluate.h>\n#include <darboux/" + header.stem + ".h>\n\n" + comment +
                        "const darboux::" + made + "\nconst auto f = frame(surface, " + literal(example_u) +
                        ", " + literal(example_v) + ");  // f.t, f.b, f.n, f.handedness, f.status\n") +
         "\n";
}

std::string references(const std::string& page) {
  const auto cited = citations(page);
  if (cited.empty()) return {};
  std::string text = "## References\n\n";
  for (const auto& [key, places] : cited) {
    text += "- [" + key + "](../references.bib)";
    for (const std::string& place : places) text += (place == places.front() ? ", " : "; ") + place;
    text += ". " + described(key) + ".\n";
  }
  return text;
}

std::string page(const AnySurface& surface) {
  const Header header = read_header(surface);
  const std::string name(surface.info().name);
  std::vector<std::string_view> code(status_names.begin(), status_names.end());
  for (const ParameterValue& p : surface.parameters()) code.push_back(p.name);

  std::string text = "<!--\nWritten by `darboux surfaces --pages docs/surfaces` from " + header.stem +
                     ".h: change that, not this.\n-->\n\n# " + name + "\n\n![" +
                     std::string(surface.info().summary) + "](" + name + ".svg)\n\n" +
                     markdown(header.comment, code) + "\nHeader: [" + header.stem +
                     ".h](../../surfaces/darboux/" + header.stem +
                     ".h). Words and signs: [conventions](../conventions.md). " +
                     "About the picture: [all surfaces](README.md).\n\n" + parameters(surface) +
                     properties(surface) + facts(surface, header, code) + examples(surface, header);
  return text + references(text);
}

std::string index() {
  std::string text =
      "<!--\nWritten by `darboux surfaces --pages docs/surfaces`: change src/report/surface_pages.cpp, not "
      "this.\n-->\n\n"
      "# Surfaces\n\n"
      "One page per surface: formula, parameters, singular points, facts, sources. The pages are written by "
      "`darboux "
      "surfaces\n--pages` from the headers in [surfaces/darboux](../../surfaces/darboux). How to [add a "
      "surface](../howto/add-a-surface.md).\n\n"
      "In the pictures z is up. The surface is blue where n points to the viewer and orange where it points "
      "away. Thin "
      "lines\nhave constant u or v; thick ones are u and v = 0 and 1. The arrows are tangent frames: t red, "
      "b green, n "
      "blue, paler\nwhere it points behind the surface.\n\n| | name | |\n|---|---|---|\n";
  for (const AnySurface& surface : all_surfaces()) {
    const std::string name(surface.info().name);
    text += "| [<img src=\"" + name + ".svg\" width=\"160\" alt=\"\">](" + name + ".md) | [" + name + "](" +
            name + ".md) | " + cell(surface.info().summary) + " |\n";
  }
  return text;
}

}  // namespace

std::vector<PageFile> surface_pages() {
  std::vector<PageFile> files{{"README.md", index()}};
  for (const AnySurface& surface : all_surfaces()) {
    const std::string name(surface.info().name);
    files.push_back({name + ".md", page(surface)});
    files.push_back({name + ".svg", surface_picture(surface)});
  }
  return files;
}

}  // namespace darboux
