// Settings of --config, for a subcommand with an option of each kind that validate has.
#include <optional>

#include "cli/command.h"
#include "cli/configuration.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  const std::string path = fuzz::in_file(fuzz::text_of(data, size), ".toml");
  CLI::App app;
  CLI::App& sub = *app.add_subcommand("validate");
  std::vector<std::string> files, codes, patterns;
  std::string surface = "auto", only;
  double max_angle = 5;
  std::optional<double> budget;
  bool strict = false, refused = true;
  Common common;
  sub.add_option("FILES", files);
  sub.add_option("--surface", surface)->capture_default_str();
  sub.add_option("--max-angle", max_angle)->check(finite_number("a number", [](double) { return true; }));
  sub.add_option("--budget", budget);
  sub.add_option("--fail-on", codes)->delimiter(',');
  sub.add_option("--exclude", patterns);
  sub.add_option("--only", only)->check(CLI::IsMember({"needed"}));
  sub.add_flag("--strict", strict);
  add_read_options(sub, common);
  add_common(sub, common, "");
  sub.callback([&] {
    fuzz::may_refuse([&] {
      read_configuration(sub, path);
      refused = false;
    });
  });
  // As on the command line, which goes before the file.
  app.parse(std::vector<std::string>{"7", "--budget", "a.glb", "validate"});
  fuzz::expect(budget == 7 && files == std::vector<std::string>{"a.glb"}, "what the command line says stays");
  fuzz::expect(refused || only.empty() || only == "needed", "no option takes what its check refuses");
  return 0;
}
