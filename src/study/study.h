/// \file study.h
/// A study: a list of jobs with stable keys, each of which gives one JSON value. Results are appended to a
/// file as they arrive, so that an interrupted study can be resumed, and parts of it can run in several
/// processes. A results file is JSON lines: a header, {"run": ...} for every process that wrote to it, and
/// {"job": i, "key": ..., "result": ...} for every finished job. docs/howto/run-a-study.md describes it.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace darboux {

/// One piece of work. Except for times, its result depends only on its key and the study's identity.
struct Job {
  std::string key;
  std::function<nlohmann::ordered_json()> run;  ///< called on any thread
};

/// The jobs of one process: shard I of N has the jobs I-1, I-1+N, ...
struct Shard {
  std::size_t index = 1, count = 1;
  bool has(std::size_t job) const { return job % count == index - 1; }
  bool operator==(const Shard&) const = default;
};
/// "2/7". \throws ParameterError unless 1 <= I <= N
Shard parse_shard(const std::string& text);

/// What identifies a study.
struct StudyIdentity {
  std::string command;               ///< the report command: "converge"
  std::string version;               ///< of the tool; results of another are refused
  nlohmann::ordered_json study;      ///< all that the results depend on, with a hash of every file read
  nlohmann::ordered_json provenance; /**< of this process: command line, compiler, machine, date; not part of
                                        the identity */
};

/// 64 bits of FNV-1a as hexadecimal digits, only to distinguish studies and input files.
std::string hash_text(std::string_view text);

struct StudyOptions {
  std::string results;  ///< the file, resumed if it exists; empty: none
  Shard shard;
  int threads = 1;
};

/// Runs the jobs of the shard that the results file lacks, and appends each result when it is available, with
/// one write. Returns the results by job, null for those of other shards. A job whose line at the end was cut
/// short is run again. Values pass through JSON text also without a file, so that both give the same bits.
/// \param progress called with the share done, in [0, 1], on the calling thread
/// \throws FileError for results of another study, version or shard, a broken line, a file that another
/// process is writing, and a full disk: results written until then stay, and can be resumed
std::vector<nlohmann::ordered_json> run_study(const StudyIdentity& identity, const std::vector<Job>& jobs,
                                              const StudyOptions& options,
                                              const std::function<void(double)>& progress);

/// The text of the results file that a single process would have written, jobs in order, from those of all
/// shards. \throws FileError for a shard that is missing, duplicated, incomplete, or of another study or
/// version
std::string merge_results(const std::vector<std::string>& files, const std::string& version);

}  // namespace darboux
