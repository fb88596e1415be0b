// The project's own sources as text: paths relative to its root, with the names they include.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace darboux::test {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The names between <> or "" of every include directive, in order.
inline std::vector<std::string> included_by(const std::string& text) {
  static const std::regex directive("(^|\n)[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"]+)[>\"]");
  std::vector<std::string> names;
  for (std::sregex_iterator i(text.begin(), text.end(), directive), end; i != end; ++i)
    names.push_back((*i)[2]);
  return names;
}

/// path -> what it includes
using Includes = std::map<std::string, std::vector<std::string>>;

/// Of every .h and .cpp below these folders of the project.
inline Includes includes_below(const std::vector<std::string>& folders) {
  const std::filesystem::path root = DARBOUX_SOURCE;
  Includes result;
  for (const std::string& folder : folders)
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder))
      if (const auto extension = entry.path().extension(); extension == ".h" || extension == ".cpp")
        result[entry.path().lexically_relative(root).generic_string()] = included_by(read_text(entry.path()));
  return result;
}

}  // namespace darboux::test
