#include "work_precision_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <darboux/error.h>

#include "base/counted.h"
#include "base/text.h"
#include "csv.h"
#include "finite_or_null.h"

namespace darboux {
namespace {

using Json = nlohmann::ordered_json;

std::string kind_of(const std::string& specification) {
  return specification.substr(0, specification.find(':'));
}

constexpr std::string_view evaluation_name = "evaluation", meshes_name = "meshes";

// By time, the fastest first.
std::vector<const WorkSample*> by_time(const WorkGroup& group, const WorkAxes& axes) {
  std::vector<const WorkSample*> best;
  for (const WorkSample* s : group.samples)
    if (s->best_of_family) best.push_back(s);
  const std::size_t x = find_work_metric(axes.x_of(group.domain));
  std::stable_sort(best.begin(), best.end(),
                   [&](const WorkSample* a, const WorkSample* b) { return a->metric[x] < b->metric[x]; });
  return best;
}

bool is_time(std::string_view metric) {
  return metric == "time_ns" || metric == "seconds";
}

// "2.31 to 2.4 ns": the quartiles of a time, in the metric's unit.
std::string spread(const WorkSample& s, std::string_view metric) {
  const double unit = metric == "seconds" ? 1e-9 * static_cast<double>(s.points) : 1;
  return rounded(s.time_low * unit, 3) + " to " + rounded(s.time_high * unit, 3);
}

std::vector<std::string> failures(const std::vector<WorkSample>& samples) {
  std::vector<std::string> lines;
  for (const WorkGroup& group : work_groups(samples))
    for (const WorkSample* s : group.samples)
      if (!s->failure.empty())
        lines.push_back(work_method_name(*s) + ", " + group.title() + ": " + one_line(s->failure));
  return lines;
}

}  // namespace

nlohmann::ordered_json work_json(const std::vector<WorkSample>& samples) {
  Json list = Json::array();
  for (const WorkSample& s : samples) {
    Json sample{{"surface", s.surface},
                {"method", s.method},
                {"family", s.family},
                {"domain", s.domain == WorkDomain::evaluation ? evaluation_name : meshes_name},
                {"mesh", s.mesh.empty() ? Json(nullptr) : Json(s.mesh)},
                {"resolution", s.mesh.empty() ? Json(nullptr) : Json(s.resolution)},
                {"points", s.points},
                {"failure", s.failure.empty() ? Json(nullptr) : Json(s.failure)},
                {"rounds_ns", s.rounds},
                {"time_low_ns", s.rounds.empty() ? Json(nullptr) : finite_or_null(s.time_low)},
                {"time_high_ns", s.rounds.empty() ? Json(nullptr) : finite_or_null(s.time_high)}};
    // Only the metrics that it has; null if one is infinite.
    sample["metrics"] = Json::object();
    for (std::size_t k = 0; k < work_metrics.size(); ++k)
      if (!std::isnan(s.metric[k]))
        sample["metrics"][std::string(work_metrics[k])] = finite_or_null(s.metric[k]);
    sample["on_front"] = s.on_front;
    sample["best_of_family"] = s.best_of_family;
    list.push_back(sample);
  }
  return list;
}

WorkSample work_sample_of(const nlohmann::ordered_json& json) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto number_or_nan = [&](const char* key) {
    const Json& value = json.at(key);
    return value.is_null() ? nan : value.get<double>();
  };
  const auto text_or_empty = [&](const char* key) {
    const Json& value = json.at(key);
    return value.is_null() ? std::string() : value.get<std::string>();
  };
  WorkSample s;
  s.surface = json.at("surface").get<std::string>();
  s.method = json.at("method").get<std::string>();
  s.family = json.at("family").get<std::string>();
  const std::string domain = json.at("domain").get<std::string>();
  if (domain != evaluation_name && domain != meshes_name)
    throw ParameterError("domain", expected_got("evaluation or meshes", "'" + domain + "'"));
  s.domain = domain == evaluation_name ? WorkDomain::evaluation : WorkDomain::meshes;
  s.mesh = text_or_empty("mesh");
  if (!s.mesh.empty()) s.resolution = json.at("resolution").get<int>();
  s.points = json.at("points").get<std::size_t>();
  s.failure = text_or_empty("failure");
  s.rounds = json.at("rounds_ns").get<std::vector<double>>();
  for (const double ns : s.rounds)
    if (!(std::isfinite(ns) && ns > 0))
      throw ParameterError("rounds_ns", expected_got("finite numbers above 0", shortest(ns)));
  s.time_low = number_or_nan("time_low_ns");
  s.time_high = number_or_nan("time_high_ns");
  s.metric.fill(nan);
  for (const auto& [name, value] : json.at("metrics").items())
    s.metric[find_work_metric(name)] =
        value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
  s.on_front = json.at("on_front").get<bool>();
  s.best_of_family = json.at("best_of_family").get<bool>();
  return s;
}

std::string work_csv(const std::vector<WorkSample>& samples) {
  std::string text = "surface,method,family,domain,mesh,resolution,points,time_low_ns,time_high_ns";
  for (const std::string_view metric : work_metrics) (text += ',') += metric;
  text += ",on_front,best_of_family,failure\r\n";
  for (const WorkSample& s : samples) {
    text += csv_text(s.surface) + ',' + csv_text(s.method) + ',' + csv_text(s.family) + ',';
    text += s.domain == WorkDomain::evaluation ? evaluation_name : meshes_name;
    text += ',' + csv_text(s.mesh) + ',' + (s.mesh.empty() ? "" : std::to_string(s.resolution)) + ',' +
            std::to_string(s.points);
    for (const double x : {s.time_low, s.time_high}) text += ',' + (s.rounds.empty() ? "" : csv_number(x));
    for (const double x : s.metric) text += ',' + csv_number(x);
    text += s.on_front ? ",true" : ",false";
    text += s.best_of_family ? ",true," : ",false,";
    text += csv_text(s.failure) + "\r\n";
  }
  return text;
}

// ---- groups and names -------------------------------------------------------------------------------------

std::string WorkGroup::title() const {
  return domain == WorkDomain::evaluation ? name + " at points" : name + " on " + mesh + " meshes";
}

std::vector<WorkGroup> work_groups(const std::vector<WorkSample>& samples) {
  std::vector<WorkGroup> groups;
  for (const WorkSample& s : samples) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const WorkGroup& g) {
      return g.surface == s.surface && g.domain == s.domain && g.mesh == s.mesh;
    });
    if (group == groups.end())
      group = groups.insert(groups.end(), WorkGroup{s.surface, "", s.domain, s.mesh, {}});
    group->samples.push_back(&s);
  }
  for (WorkGroup& group : groups) {
    group.name = kind_of(group.surface);
    // Two surfaces of one kind are distinguished by their parameters.
    for (const WorkGroup& other : groups)
      if (other.surface != group.surface && kind_of(other.surface) == kind_of(group.surface))
        group.name = group.surface;
  }
  return groups;
}

std::string work_method_name(const WorkSample& s) {
  return s.method + (s.mesh.empty() ? "" : ", " + std::to_string(s.resolution) + " rows");
}

std::string work_value(std::string_view metric, double value) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return "no number";
  return rounded(value, is_time(metric) ? 3 : 2);
}

std::string work_axis(std::string_view metric, WorkDomain domain) {
  if (metric == "time_ns")
    return domain == WorkDomain::evaluation ? "nanoseconds per point" : "nanoseconds per corner";
  if (metric == "seconds")
    return domain == WorkDomain::evaluation ? "seconds for all points" : "seconds per mesh";
  const std::string name(metric.substr(0, metric.find('_')));
  const std::string which = metric.ends_with("_rms") ? "rms" : "largest";
  if (name == "partials" || name == "position") return which + " relative error of the " + name;
  return which + " error of the " + name + ", radians";
}

std::string work_summary(const std::vector<WorkSample>& samples) {
  const auto failed =
      std::count_if(samples.begin(), samples.end(), [](const WorkSample& s) { return !s.failure.empty(); });
  // An infinite error: the method returned no frame somewhere.
  const auto numberless = std::count_if(samples.begin(), samples.end(), [](const WorkSample& s) {
    return std::any_of(s.metric.begin(), s.metric.end(), [](double x) { return std::isinf(x); });
  });
  std::vector<std::string> surfaces;
  for (const WorkSample& s : samples)
    if (std::find(surfaces.begin(), surfaces.end(), s.surface) == surfaces.end())
      surfaces.push_back(s.surface);
  return counted(samples.size(), "measurement") + " on " + counted(surfaces.size(), "surface") + ", " +
         (failed == 0 ? "none failed" : std::to_string(failed) + " failed") +
         (numberless == 0 ? "" : ", an error of " + std::to_string(numberless) + " is no number");
}

// ---- texts ------------------------------------------------------------------------------------------------

std::string work_text(const std::vector<WorkSample>& samples, const WorkAxes& axes) {
  std::string text =
      "Methods that no other of their family beats in both columns; *: no other of any family does.\n"
      "Times: the median and quartiles of the rounds.\n";
  for (const WorkGroup& group : work_groups(samples)) {
    const std::string_view x = axes.x_of(group.domain), y = axes.y_of(group.domain);
    text += '\n' + padded(group.title(), 34) + padded(std::string(x), 12) +
            (is_time(x) ? padded("quartiles", 26) : "") + std::string(y) + '\n';
    for (const WorkSample* s : by_time(group, axes))
      text += std::string(s->on_front ? "* " : "  ") + padded(work_method_name(*s), 32) +
              padded(work_value(x, (*s)[x]), 12) + (is_time(x) ? padded(spread(*s, x), 26) : "") +
              work_value(y, (*s)[y]) + '\n';
  }
  text += '\n' + work_summary(samples) + '\n';
  for (const std::string& failure : failures(samples)) text += failure + '\n';
  return text;
}

std::string work_markdown(const std::vector<WorkSample>& samples, const WorkAxes& axes, const Provenance& p) {
  std::string text = "# Work against precision\n\n" + work_summary(samples) +
                     ". Per surface and mesh: the methods that no other of their family beats in both "
                     "columns, in the order of "
                     "the first. **Bold**: no method of any family does.\n";
  for (const WorkGroup& group : work_groups(samples)) {
    const std::string_view x = axes.x_of(group.domain), y = axes.y_of(group.domain);
    text += "\n## " + group.title() + "\n\n| method | " + work_axis(x, group.domain) +
            (is_time(x) ? " | quartiles | " : " | ") + work_axis(y, group.domain) + " |\n|---|---:|" +
            (is_time(x) ? "---:|" : "") + "---:|\n";
    for (const WorkSample* s : by_time(group, axes)) {
      const std::string bold = s->on_front ? "**" : "";
      text += "| " + bold + work_method_name(*s) + bold + " | " + work_value(x, (*s)[x]) + " | " +
              (is_time(x) ? spread(*s, x) + " | " : "") + work_value(y, (*s)[y]) + " |\n";
    }
  }
  if (const auto lines = failures(samples); !lines.empty()) {
    text += "\n## What failed\n\n";
    for (const std::string& failure : lines) text += "- " + failure + "\n";
  }
  return text + "\nMade by `" + p.command + "`: Darboux " + p.version + ", " + p.compiler + ", " + p.machine +
         ", " + p.date + ".\n";
}

// ---- two runs ---------------------------------------------------------------------------------------------

nlohmann::ordered_json comparisons_json(const std::vector<WorkComparison>& comparisons) {
  Json list = Json::array();
  for (const WorkComparison& c : comparisons)
    list.push_back({{"surface", c.after.surface},
                    {"method", c.after.method},
                    {"mesh", c.after.mesh.empty() ? Json(nullptr) : Json(c.after.mesh)},
                    {"resolution", c.after.mesh.empty() ? Json(nullptr) : Json(c.after.resolution)},
                    {"before_ns", finite_or_null(c.before["time_ns"])},
                    {"after_ns", finite_or_null(c.after["time_ns"])},
                    {"time_ratio", finite_or_null(c.time.ratio)},
                    {"time_ratio_ci", {finite_or_null(c.time.low), finite_or_null(c.time.high)}},
                    {"error_metric", c.worst_metric.empty() ? Json(nullptr) : Json(c.worst_metric)},
                    {"error_ratio", finite_or_null(c.error_ratio)},
                    {"verdict", c.verdict}});
  return list;
}

std::string comparisons_text(const std::vector<WorkComparison>& comparisons, double tolerance) {
  std::string text;
  std::size_t same = 0, faster = 0, worse = 0, undetermined = 0;
  for (const WorkComparison& c : comparisons) {
    (c.verdict == "same"           ? same
     : c.verdict == "undetermined" ? undetermined
     : c.holds()                   ? faster
                                   : worse) += 1;
    if (c.verdict == "same" || c.verdict == "undetermined") continue;
    const WorkGroup group{c.after.surface, c.after.surface, c.after.domain, c.after.mesh, {}};
    text += std::string(c.verdict) + ": " + work_method_name(c.after) + ", " + group.title() + ": ";
    if (c.verdict == "failed")
      text += one_line(c.after.failure) + '\n';
    else if (c.verdict == "less exact")
      text += std::string(c.worst_metric) + " " + work_value(c.worst_metric, c.before[c.worst_metric]) +
              " -> " +
              (std::isnan(c.after[c.worst_metric]) ? "none"
                                                   : work_value(c.worst_metric, c.after[c.worst_metric])) +
              '\n';
    else
      text += rounded(c.before["time_ns"], 3) + " -> " + rounded(c.after["time_ns"], 3) + " ns, times " +
              rounded(c.time.ratio, 3) + " [" + rounded(c.time.low, 3) + ", " + rounded(c.time.high, 3) +
              "]\n";
  }
  return text + counted(comparisons.size(), "measurement") + " in both: " + std::to_string(same) +
         " the same within " + rounded(100 * tolerance, 3) + " %, " + std::to_string(faster) + " faster, " +
         std::to_string(worse) + " worse" +
         (undetermined == 0 ? ""
                            : ", " + std::to_string(undetermined) +
                                  " undetermined: expected at least 4 rounds in both, got fewer") +
         '\n';
}

}  // namespace darboux
