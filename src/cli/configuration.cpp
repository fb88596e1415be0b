#include "configuration.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <darboux/error.h>

#include "base/text.h"
#include "io/files.h"

namespace darboux {

void read_configuration(CLI::App& sub, const std::string& path) {
  std::vector<std::string> known;
  for (const CLI::Option* option : sub.get_options())
    for (const std::string& name : option->get_lnames())
      if (name != "help" && name != "version" && name != "config" && name != "findings")
        known.push_back(name);
  known.push_back("files");
  std::istringstream text(io::read_file(path));
  try {
    for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(text)) {
      if (!item.parents.empty())
        throw FileError(path, expected_got("options alone", "a section [" + item.parents.front() + "]"));
      const std::string& name = item.name;
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw FileError(path, expected_got("an option of " + sub.get_name() + " (" + joined(known) + ")",
                                           "'" + name + "'"));
      if (item.inputs.empty()) throw FileError(path, expected_got("a value of " + name, "none"));
      CLI::Option& option = *sub.get_option_no_throw(name == "files" ? "FILES" : "--" + name);
      if (option.count() > 0) continue;  // a name that is given twice comes once, with two values
      option.add_result(item.inputs);
      option.run_callback();
    }
  } catch (const CLI::ParseError& e) {
    throw FileError(path, e.what());
  }
}

}  // namespace darboux
