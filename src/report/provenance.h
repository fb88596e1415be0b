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
  std::string seeds;     ///< of random numbers: "1", "1 to 3"
};
/// Of this process, now, without seeds. The processor is read from /proc/cpuinfo, "unknown processor" where
/// there is none.
Provenance provenance(std::string version, std::string command);
/// The section that ends a page, and how to cite.
std::string provenance_html(const Provenance& provenance);

}  // namespace darboux
