/// \file provenance.h
/// The provenance of the numbers in a report.
#pragma once

#include <string>

namespace darboux {

/// Where and how the numbers were obtained.
struct Provenance {
  std::string machine;   ///< processor and its cores
  std::string compiler;  ///< name and version
  std::string date;      ///< UTC
  std::string version;   ///< of the tool
  std::string command;   ///< the command line that reproduces the run
  std::string seeds;     ///< of random numbers: "1", "1 to 3"
};
/// Of this process, now, without seeds. The processor is read from /proc/cpuinfo; "unknown processor" if that
/// fails.
Provenance provenance(std::string version, std::string command);
/// The last section of a page, with how to cite.
std::string provenance_html(const Provenance& provenance);

}  // namespace darboux
