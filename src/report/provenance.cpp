#include "provenance.h"

#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>

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
  return {processor + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores"), compiler, date,
          std::move(version), std::move(command)};
}

}  // namespace darboux
