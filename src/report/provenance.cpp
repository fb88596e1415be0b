#include "provenance.h"

#include <chrono>
#include <ctime>
#include <fstream>
#include <string_view>
#include <thread>
#include <utility>

#include "base/counted.h"
#include "html.h"

namespace darboux {

Provenance provenance(std::string version, std::string command) {
  std::string processor = "unknown processor";
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  const unsigned cores = std::thread::hardware_concurrency();
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", &utc);
#ifdef __clang__
  const std::string compiler = __VERSION__;
#else
  const std::string compiler = std::string("g++ ") + __VERSION__;
#endif
  return {
      processor + ", " + counted(cores, "core"), compiler, date, std::move(version), std::move(command), {}};
}

std::string provenance_html(const Provenance& p) {
  std::string text = "<section class=card>\n<h2>Where these numbers come from</h2>\n<dl>\n";
  for (const auto& [name, value] : {std::pair<std::string_view, const std::string&>{"Machine", p.machine},
                                    {"Compiler", p.compiler},
                                    {"Date", p.date},
                                    {"Darboux", p.version},
                                    {"Seed", p.seeds}})
    text += "<dt>" + std::string(name) + "<dd>" + escape(value) + "\n";
  return text + "<dt>Again<dd><code>" + escape(p.command) +
         "</code>\n<dt>Cite<dd>The Darboux authors. <cite>Darboux: exact tangent frames of parametric "
         "surfaces, "
         "and a ruler for those of meshes</cite>. Version " +
         escape(p.version) + ", " + escape(p.date.substr(0, p.date.find(' '))) +
         ". CITATION.cff is beside the sources; the date and the command tell this report from others.\n"
         "</dl>\n</section>\n";
}

}  // namespace darboux
