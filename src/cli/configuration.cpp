#include "configuration.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <darboux/error.h>

#include "base/text.h"
#include "io/files.h"

namespace darboux {

void read_configuration(CLI::App& sub, const std::string& path) {
  // Not get_option(): it allocates, and must not throw here.
  std::vector<std::string> known;
  std::vector<CLI::Option*> options;
  for (CLI::Option* option : sub.get_options()) {
    std::vector<std::string> names = option->get_lnames();
    if (option->get_name() == "FILES") names.push_back("files");
    for (const std::string& name : names)
      if (name != "help" && name != "version" && name != "config" && name != "findings") {
        known.push_back(name);
        options.push_back(option);
      }
  }
  std::istringstream text(io::read_file(path));
  text.exceptions(std::ios::badbit);  // or lines that have no memory are left out
  try {
    for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(text)) {
      if (!item.parents.empty())
        throw FileError(path, expected_got("options alone", "a section [" + item.parents.front() + "]"));
      const std::string& name = item.name;
      const auto found = std::find(known.begin(), known.end(), name);
      if (found == known.end())
        throw FileError(path, expected_got("an option of " + sub.get_name() + " (" + joined(known) + ")",
                                           "'" + name + "'"));
      if (item.inputs.empty()) throw FileError(path, expected_got("a value of " + name, "none"));
      CLI::Option& option = *options[static_cast<std::size_t>(found - known.begin())];
      if (option.count() > 0) continue;  // a name that is given twice comes once, with two values
      option.add_result(item.inputs);
      option.run_callback();
    }
  } catch (const CLI::ParseError& e) {
    throw FileError(path, e.what());
  }
}

}  // namespace darboux
