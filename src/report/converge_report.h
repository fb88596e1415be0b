/// \file converge_report.h
/// The results of `darboux converge` as JSON, CSV and a page for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/converge.h>

namespace darboux {

/// The studies as `darboux converge --json` prints them; numbers that do not exist are null.
nlohmann::ordered_json studies_json(const std::vector<Study>& studies);

/// One row per study and resolution, with a header; RFC 4180 quoting, numbers read back to the same bits, an
/// order that does not exist is an empty field.
std::string studies_csv(const std::vector<Study>& studies);

/// "405 studies: 269 as expected, 3 faster, 91 at the floor, 42 not converging, as expected".
std::string verdict_summary(const std::vector<Study>& studies);

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

/// A self-contained HTML page: error against mesh width and against run time as pictures, all studies as a
/// table. Opens from a file, without a network; without scripts the table remains.
std::string converge_page(const std::vector<Study>& studies, const Provenance& provenance);

}  // namespace darboux
