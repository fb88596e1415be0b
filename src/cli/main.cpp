#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <new>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/keep_freed_memory.h"
#include "base/nearest_name.h"
#include "command.h"
#include "io/input.h"
#include "io/unfinished.h"

namespace darboux {
namespace {

// If a standard stream is closed, the next file opened gets its descriptor, and so what is printed. Here the
// stream gets a descriptor that can be neither read nor written, so that using it is an error.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
      std::abort();
}

// An empty value comes from an unset variable in a script; it names neither a choice nor a file.
void refuse_empty_values(CLI::App& app) {
  const auto check = [](const std::string& text) {
    return text.empty() ? expected_got("a value", "an empty one") : std::string();
  };
  for (CLI::App* sub : app.get_subcommands({}))
    for (CLI::Option* option : sub->get_options())
      if (!option->get_positional() && option->get_items_expected_max() > 0) option->check(check);
}

// The arguments that the parser left over, in order, and what misspelt options among them may mean.
std::string unexpected(const CLI::App& sub) {
  std::string got;
  std::vector<std::string> known;
  for (const CLI::Option* option : sub.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string& text : sub.remaining()) {
    const std::string name = text.substr(0, text.find('='));
    got += (got.empty() ? "'" : ", '") + text + "'";
    if (text.starts_with('-') && std::find(known.begin(), known.end(), name) == known.end())
      got += did_you_mean(name, known);
    else if (io::parse_number(text) && std::find(known.begin(), known.end(), "--at") != known.end())
      got += " (the numbers of one value are joined by commas, as 0.3,0.7)";
  }
  const auto positional = sub.get_options([](const CLI::Option* o) { return o->get_positional(); });
  if (positional.size() == 1 && positional[0]->get_items_expected_max() == 1 && positional[0]->count() > 0)
    got += " after its " + positional[0]->get_name();
  return expected_got("options and arguments of " + sub.get_name(), got);
}

// The parser's message about an option, in the form "expected, got".
std::string in_own_words(const CLI::App* sub, const std::string& text) {
  // The text before and after a mark.
  const auto split = [&](std::string_view mark, std::size_t from = 0) {
    const std::size_t at = text.find(mark, from);
    return at == std::string::npos ? std::pair<std::string, std::string>()
                                   : std::pair(text.substr(from, at - from), text.substr(at + mark.size()));
  };
  constexpr std::string_view no_conversion = "Could not convert: ";
  if (text.starts_with(no_conversion)) {
    const auto [name, value] = split(" = ", no_conversion.size());
    const CLI::Option* option = sub == nullptr ? nullptr : sub->get_option_no_throw(name);
    const bool is_flag = option != nullptr && option->get_items_expected_max() == 0;
    return name + ": " + expected_got(is_flag ? "no value" : "a number", "'" + value + "'");
  }
  if (const auto [name_and_value, known] = split(" not in {"); known.ends_with('}')) {
    const std::size_t at = name_and_value.find(": ");
    std::string list;
    for (const char c : known.substr(0, known.size() - 1))
      list += c == ',' ? std::string(", ") : std::string(1, c);
    if (at != std::string::npos)
      return name_and_value.substr(0, at) + ": " +
             expected_got("one of " + list, "'" + name_and_value.substr(at + 2) + "'");
  }
  if (const auto [name, rest] = split(": 1 required "); rest.ends_with(" missing"))
    return name + ": " + expected_got("a value", "none");
  if (const auto [least, got] = split(" required but received "); !got.empty())
    if (const auto [name, count] = split(": At least "); !count.empty())
      return name + ": " + expected_got("at least " + least.substr(name.size() + 11) + " values", got);
  if (text.ends_with(" is required")) return expected_got(text.substr(0, text.size() - 12), "none");
  return text;
}

// What the library says of an argument, by the name of the option that was given for it: "--methods: expected
// ..." for "method: expected ...".
std::string by_option(const std::vector<CLI::App*>& parsed, const std::string& text) {
  const std::string name = text.substr(0, text.find(": "));
  for (const CLI::App* sub : parsed)
    for (const std::string& known : {"--" + name, "--" + name + 's'})
      if (const CLI::Option* option = sub->get_option_no_throw(known);
          option != nullptr && option->count() > 0)
        return known + text.substr(name.size());
  return text;
}

int report(const std::string& message, int status) {
  print_error(message);
  return status;
}

}  // namespace
}  // namespace darboux

namespace {

int run(int argc, char** argv) {
  darboux::open_standard_streams();
  darboux::io::remove_unfinished_on_signals();
  darboux::keep_freed_memory();
  CLI::App app{"Tangent frames of parametric surfaces and meshes, exact and checked.", "darboux"};
  app.set_version_flag("--version", std::string("darboux ") + DARBOUX_VERSION);
  app.require_subcommand(1);
  app.footer(
      "\nExample:\n  darboux eval torus:major_radius=1,minor_radius=0.4 --at 0.3,0.7 --json\n"
      "\nSURFACE is NAME, NAME:PARAMETER=VALUE,... or formula:file=FILE; `darboux surfaces` lists the "
      "names.\n`darboux COMMAND --help` or `darboux help COMMAND` explains a command.\n"
      "Exit status: 0 success; 1 the answer is negative: a check failed, the verdict is fail or "
      "undetermined, files differ,\nno surface was found, there was no result to write; 2 usage error, "
      "unreadable input, or output that cannot be written.");
  darboux::Common common;
  darboux::add_surfaces(app, common);
  darboux::add_eval(app, common);
  darboux::add_check(app, common);
  darboux::add_mesh(app, common);
  darboux::add_tangents(app, common);
  darboux::add_validate(app, common);
  darboux::add_converge(app, common);
  darboux::add_fit(app, common);
  darboux::add_compare(app, common);
  darboux::add_plan(app, common);
  darboux::add_scene(app, common);
  darboux::add_normalmap(app, common);
  darboux::add_bake(app, common);
  darboux::add_stability(app, common);
  darboux::add_work_precision(app, common);
  darboux::add_merge(app, common);
  darboux::refuse_empty_values(app);
  const auto finish = [](int status) {
    std::cout.flush();
    return std::cout ? status
                     : darboux::report(
                           "standard output: expected an open file or pipe, got an error on writing", 2);
  };
  try {
    std::vector<char*> arguments(argv, argv + argc);
    std::string help = "--help";
    if (argc > 1 &&
        std::string_view(argv[1]) == "help") {  // help COMMAND is COMMAND --help, whatever follows
      const bool of_command = argc > 2 && std::string_view(argv[2]) != "help";
      arguments = {argv[0], of_command ? argv[2] : help.data()};
      if (of_command) arguments.push_back(help.data());
    }
    const std::string first = arguments.size() > 1 ? arguments[1] : "-";
    std::vector<std::string> known;
    for (const CLI::App* sub : app.get_subcommands({})) known.push_back(sub->get_name());
    if (!first.starts_with('-') && std::find(known.begin(), known.end(), first) == known.end())
      throw darboux::ParameterError(first, "unknown command" + darboux::did_you_mean(first, known) +
                                               ", known are " + darboux::joined(known));
    app.parse(static_cast<int>(arguments.size()), arguments.data());
    return finish(common.exit_status);
  } catch (const CLI::CallForHelp& e) {
    return finish(app.exit(e));
  } catch (const CLI::CallForVersion& e) {
    return finish(app.exit(e));
  } catch (const CLI::ParseError& e) {
    const std::string command = argc > 1 && argv[1][0] != '-' ? std::string(argv[1]) + ' ' : std::string();
    const auto parsed = app.get_subcommands();
    const bool left_over = !parsed.empty() && parsed[0]->remaining_size() > 0;
    const bool no_command = argc < 2 || argv[1][0] == '-';
    const std::string what =
        no_command  ? darboux::expected_got("a command first, its options after it",
                                           argc < 2 ? "none" : "'" + std::string(argv[1]) + "'")
        : left_over ? darboux::unexpected(*parsed[0])
                    : darboux::in_own_words(parsed.empty() ? nullptr : parsed[0], e.what());
    return darboux::report("command line: " + what + ", see darboux " + command + "--help", 2);
  } catch (const darboux::ParameterError& e) {
    return darboux::report(darboux::by_option(app.get_subcommands(), e.what()), 2);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return darboux::report("memory: expected enough for this input, got less", 2);
  } catch (const std::exception& e) {
    return darboux::report(e.what(), 2);
  }
}
