#include "study.h"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>

#include "base/parallel_jobs.h"
#include "base/text.h"
#include "io/files.h"
#include "io/json_cursor.h"

namespace darboux {
namespace {

using Json = nlohmann::ordered_json;

constexpr int format = 1;  // of results files; another is refused

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string shard_text(const Shard& shard) {
  return std::to_string(shard.index) + '/' + std::to_string(shard.count);
}

// The first line of a results file.
struct Header {
  std::string command, version;
  Json study;
  Shard shard;
  std::size_t jobs = 0;

  Json json() const {
    return {{"darboux_results", format},
            {"command", command},
            {"version", version},
            {"study", study},
            {"hash", hash()},
            {"shard", shard_text(shard)},
            {"jobs", jobs}};
  }
  std::string hash() const { return hash_text(command + '\n' + dump(study)); }
};

// A results file as it was read.
struct Results {
  Header header;
  std::vector<Json> runs;
  std::map<std::size_t, std::pair<std::string, Json>> of_job;  // key and result
  std::size_t complete = 0;                                    // bytes of whole lines
};

[[noreturn]] void broken(const std::string& file, std::size_t line, const std::string& what) {
  throw FileError(file, "line " + std::to_string(line) + ": " + what);
}

Header read_header(const std::string& file, const Json& line, const std::string& version) {
  if (!line.is_object() || !line.contains("darboux_results"))
    broken(file, 1, expected_got("the header of a results file", shortened(dump(line), 60)));
  if (line["darboux_results"] != format)
    broken(file, 1,
           expected_got("results of format " + std::to_string(format), dump(line["darboux_results"])));
  Header header;
  try {
    header.command = line.at("command").get<std::string>();
    header.version = line.at("version").get<std::string>();
    header.study = line.at("study");
    header.shard = parse_shard(line.at("shard").get<std::string>());
    if (const Json& jobs = line.at("jobs"); !jobs.is_number_unsigned())
      broken(file, 1, expected_got("jobs to be a whole number", shortened(dump(jobs), 60)));
    header.jobs = line["jobs"].get<std::size_t>();
    if (header.version != version)
      throw FileError(file,
                      expected_got("results of darboux " + version, "those of darboux " + header.version));
    if (line.at("hash") != header.hash())
      broken(file, 1, expected_got("hash " + header.hash() + " of its study", dump(line["hash"])));
  } catch (const Json::exception&) {
    broken(file, 1,
           "expected command, version, study, hash, shard and jobs, got a header without one of them");
  } catch (const ParameterError& e) {
    broken(file, 1, e.what());
  }
  return header;
}

void read_job(const std::string& file, std::size_t number, const Json& line, Results& results) {
  const auto index = line.find("job"), key = line.find("key"), result = line.find("result");
  if (index == line.end() || !index->is_number_unsigned() || key == line.end() || !key->is_string() ||
      result == line.end())
    broken(file, number, "expected job, key and result, got a line without one of them");
  const std::size_t job = index->get<std::size_t>();
  if (job >= results.header.jobs || !results.header.shard.has(job))
    broken(file, number,
           expected_got("a job of shard " + shard_text(results.header.shard) + " of " +
                            std::to_string(results.header.jobs) + " jobs",
                        std::to_string(job)));
  if (!results.of_job.try_emplace(job, key->get<std::string>(), *result).second)
    broken(file, number, expected_got("every job once", "job " + std::to_string(job) + " again"));
}

// Complete lines; text after the last line feed was cut short and is ignored.
std::optional<Results> parse_results(const std::string& file, const std::string& text,
                                     const std::string& version) {
  Results results;
  std::size_t number = 0;
  for (std::size_t end; (end = text.find('\n', results.complete)) != std::string::npos;
       results.complete = end + 1) {
    ++number;
    const Json line = io::parse_json(file + ": line " + std::to_string(number),
                                     std::string_view(text).substr(results.complete, end - results.complete));
    if (!line.is_object()) broken(file, number, expected_got("a JSON object", "a line that is none"));
    if (number == 1)
      results.header = read_header(file, line, version);
    else if (line.contains("run"))
      results.runs.push_back(line["run"]);
    else
      read_job(file, number, line, results);
  }
  if (number > 0) return results;
  // Not even the header is complete. If it is the beginning of one, nothing is lost; otherwise this is
  // another kind of file.
  constexpr std::string_view start = "{\"darboux_results\":";
  if (!text.starts_with(start) && !start.starts_with(text))
    broken(file, 1, "expected the header of a results file, got another text");
  return std::nullopt;
}

// A results file to which one process appends line by line.
class ResultsFile {
 public:
  explicit ResultsFile(const std::string& path) : path_(path) {
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw FileError(path, expected_got("a file to write to", std::strerror(errno)));
    struct stat status {};
    regular_ = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    if (regular_ && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor_);
      throw FileError(path, "expected results that no other process is writing, got a locked file");
    }
  }
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;
  ~ResultsFile() { ::close(descriptor_); }

  bool regular() const { return regular_; }

  // Truncates the file to `size` bytes.
  void keep(std::size_t size) {
    size_ = size;
    if (regular_ && ::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail();
  }
  void append(const Json& json) {
    const std::string line = dump(json) + '\n';
    for (std::size_t done = 0; done < line.size();) {
      const ssize_t n = ::write(descriptor_, line.data() + done, line.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        const int error = errno;
        // The next run would cut off an incomplete line anyway.
        if (regular_ && ::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) errno = error;
        errno = error;
        fail();
      }
      done += static_cast<std::size_t>(n);
    }
    size_ += line.size();
  }

 private:
  [[noreturn]] void fail() const {
    throw FileError(path_, expected_got("to write all results", std::strerror(errno)) +
                               "; those written until now can be resumed");
  }
  std::string path_;
  int descriptor_;
  bool regular_ = false;
  std::size_t size_ = 0;
};

// Checks that these are results of this study, and of the same jobs.
void check_same(const std::string& file, const Results& found, const Header& wanted,
                const std::vector<Job>& jobs) {
  if (found.header.command != wanted.command || found.header.hash() != wanted.hash())
    throw FileError(
        file, expected_got("results of " + wanted.command + " with the options given, study " + wanted.hash(),
                           "those of " + found.header.command + ", study " + found.header.hash() +
                               "; take the options that its first line holds, or another file"));
  if (found.header.shard != wanted.shard || found.header.jobs != wanted.jobs)
    throw FileError(file, expected_got("results of shard " + shard_text(wanted.shard) + " of " +
                                           std::to_string(wanted.jobs) + " jobs",
                                       "shard " + shard_text(found.header.shard) + " of " +
                                           std::to_string(found.header.jobs)));
  for (const auto& [job, result] : found.of_job)
    if (result.first != jobs[job].key)
      throw FileError(file,
                      expected_got("job " + std::to_string(job) + " to be " + jobs[job].key, result.first));
}

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  if (first.ec == std::errc{} && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    if (second.ec == std::errc{} && second.ptr == end && shard.index >= 1 && shard.index <= shard.count)
      return shard;
  }
  throw ParameterError("--shard", expected_got("I/N with 1 <= I <= N, as 2/7", "'" + text + "'"));
}

std::string hash_text(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

std::vector<Json> run_study(const StudyIdentity& identity, const std::vector<Job>& jobs,
                            const StudyOptions& options, const std::function<void(double)>& progress) {
  const Header header{identity.command, identity.version, identity.study, options.shard, jobs.size()};
  std::vector<Json> results(jobs.size());
  std::optional<ResultsFile> file;
  if (!options.results.empty()) {
    file.emplace(options.results);
    const auto found = file->regular()
                           ? parse_results(options.results, io::read_file(options.results), identity.version)
                           : std::nullopt;
    if (found) {
      check_same(options.results, *found, header, jobs);
      for (const auto& [job, result] : found->of_job) results[job] = result.second;
    }
    file->keep(found ? found->complete : 0);
    if (!found) file->append(header.json());
  }
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (options.shard.has(i) && results[i].is_null()) left.push_back(i);
  if (left.empty()) return results;
  if (file) file->append({{"run", identity.provenance}});
  std::mutex mutex;
  parallel_for(
      left.size(), options.threads,
      [&](std::size_t k) {
        const std::size_t i = left[k];
        const Json result = Json::parse(dump(jobs[i].run()));
        const std::lock_guard lock(mutex);
        if (file) file->append({{"job", i}, {"key", jobs[i].key}, {"result", result}});
        results[i] = result;
      },
      progress);
  return results;
}

std::string merge_results(const std::vector<std::string>& files, const std::string& version) {
  std::optional<Header> first;
  std::map<std::size_t, std::string> of_shard;
  std::map<std::size_t, std::pair<std::string, Json>> of_job;
  std::string runs;
  for (const std::string& file : files) {
    const std::optional<Results> read = parse_results(file, io::read_file(file), version);
    if (!read) throw FileError(file, "expected results, got none");
    const Header& header = read->header;
    if (!first) first = header;
    if (header.command != first->command || header.hash() != first->hash() || header.jobs != first->jobs)
      throw FileError(file, expected_got("a shard of " + first->command + ", study " + first->hash() +
                                             ", as in " + files.front(),
                                         header.command + ", study " + header.hash()));
    if (header.shard.count != first->shard.count)
      throw FileError(file, expected_got("one of " + std::to_string(first->shard.count) + " shards, as in " +
                                             files.front(),
                                         "shard " + shard_text(header.shard)));
    const auto [at, added] = of_shard.try_emplace(header.shard.index, file);
    if (!added)
      throw FileError(file,
                      expected_got("every shard once", "shard " + shard_text(header.shard) +
                                                           " again, which is in " + at->second + " too"));
    // The number of the next job may overflow.
    const auto next = [&](std::size_t job) {
      return header.shard.count < header.jobs - job ? job + header.shard.count : header.jobs;
    };
    for (std::size_t job = header.shard.index - 1; job < header.jobs; job = next(job))
      if (!read->of_job.contains(job))
        throw FileError(file, expected_got("all jobs of shard " + shard_text(header.shard),
                                           "none of job " + std::to_string(job) + ": resume it"));
    of_job.insert(read->of_job.begin(), read->of_job.end());
    for (const Json& run : read->runs) runs += dump({{"run", run}}) + '\n';
  }
  if (!first) throw ParameterError("RESULTS", "expected results files, got none");
  for (std::size_t i = 1; i <= first->shard.count; ++i)
    if (!of_shard.contains(i))
      throw FileError(files.front(), expected_got("all of " + std::to_string(first->shard.count) + " shards",
                                                  "none that is shard " + std::to_string(i)));
  first->shard = Shard{};
  std::string text = dump(first->json()) + '\n' + runs;
  for (const auto& [job, result] : of_job)
    text += dump({{"job", job}, {"key", result.first}, {"result", result.second}}) + '\n';
  return text;
}

}  // namespace darboux
