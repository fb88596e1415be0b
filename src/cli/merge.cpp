#include <filesystem>
#include <memory>

#include <darboux/io.h>

#include "command.h"
#include "study/study.h"

namespace darboux {

void add_merge(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand("merge", "Merge the results of all shards of a study");
  struct Arguments {
    std::vector<std::string> results;
    std::string output = "-";
  };
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("RESULTS", arguments->results, "results files, one per shard, in any order")->required();
  sub.add_option("-o,--output", arguments->output, "write the merged results to this file")
      ->capture_default_str();
  add_common(sub, common, "darboux merge shard-1.jsonl shard-2.jsonl -o results.jsonl");
  sub.callback([arguments, &common] {
    known_extension("-o", arguments->output, {".jsonl", ".json", ".txt"});
    for (const std::string& results : arguments->results) {
      std::error_code none;
      if (std::filesystem::equivalent(results, arguments->output, none))
        throw ParameterError(arguments->output,
                             expected_got("the name of another file", "that of one to be merged"));
    }
    const std::string text = merge_results(arguments->results, DARBOUX_VERSION);
    if (common.json && is_standard_output(arguments->output))
      throw ParameterError("--json", "expected -o FILE for the results beside it, got none");
    write_file(arguments->output, text);
    if (common.json) print_json({{"results", arguments->output}, {"shards", arguments->results.size()}});
  });
}

}  // namespace darboux
