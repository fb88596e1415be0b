/// \file provenance.h
/// Where the numbers of a report come from.
#pragma once

#include <string>

namespace darboux {

/// Where and how the numbers came about.
struct Provenance {
  std::string machine;   ///< processor and its cores
  std::string compiler;  ///< name and version
  std::string date;      ///< UTC
  std::string version;   ///< of the tool
  std::string command;   ///< the line that runs it again
};
/// Of this process, now. The processor is read from /proc/cpuinfo, "unknown processor" where there is none.
Provenance provenance(std::string version, std::string command);
/// The section that ends a page.
std::string provenance_html(const Provenance& provenance);

}  // namespace darboux
