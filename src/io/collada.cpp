#include "collada.h"

#include <algorithm>
#include <charconv>

#include <darboux/error.h>

#include "base/text.h"
#include "files.h"
#include "input.h"
#include "mesh_files.h"

namespace darboux::io {
namespace {

struct Ids : pugi::xml_tree_walker {
  std::unordered_map<std::string_view, pugi::xml_node>& ids;
  explicit Ids(std::unordered_map<std::string_view, pugi::xml_node>& into) : ids(into) {}
  bool for_each(pugi::xml_node& node) override {
    if (const pugi::xml_attribute id = node.attribute("id")) ids.try_emplace(id.value(), node);
    return true;
  }
};

// Calls use(word) for each word of its text.
template <class Use>
void for_each_word(const pugi::xml_node& element, Use use) {
  constexpr std::string_view blanks = " \t\r\n";
  for (const pugi::xml_node piece : element.children()) {  // pieces of text, between comments
    std::string_view text = piece.value();
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    while (!text.empty()) {
      const std::string_view word = text.substr(0, text.find_first_of(blanks));
      use(word);
      text.remove_prefix(word.size());
      text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    }
  }
}

}  // namespace

Collada::Collada(const std::string& file, const std::string& bytes) : path_(file) {
  const pugi::xml_parse_result result = document_.load_buffer(bytes.data(), bytes.size());
  if (!result)
    throw FileError(
        path_, expected_got("a COLLADA file", "what is not XML at byte " + std::to_string(result.offset) +
                                                  " (" + result.description() + ")"));
  if (!root())
    throw FileError(path_,
                    expected_got("COLLADA: XML whose first element is COLLADA", "another element first"));
  Ids walker(ids_);
  document_.traverse(walker);
}

void Collada::fail(const pugi::xml_node& at, const std::string& expected, const std::string& got) const {
  const pugi::xml_attribute id = at.attribute("id");
  throw FileError(path_, "<" + std::string(at.name()) + "> at byte " + std::to_string(at.offset_debug()) +
                             (id ? ", id " + in_quotes(id.value()) : "") + ": " +
                             expected_got(expected, got));
}

pugi::xml_node Collada::find(const pugi::xml_node& at, const char* attribute) const {
  const std::string_view uri = at.attribute(attribute).value();
  const auto found = uri.starts_with('#') ? ids_.find(uri.substr(1)) : ids_.end();
  return found == ids_.end() ? pugi::xml_node() : found->second;
}

pugi::xml_node Collada::target(const pugi::xml_node& at, const char* attribute, const char* kind) const {
  const pugi::xml_node found = find(at, attribute);
  if (std::string_view(found.name()) != kind)
    fail(at, std::string("the #ID of a <") + kind + "> of the file as its " + attribute,
         in_quotes(at.attribute(attribute).value()));
  return found;
}

std::uint64_t Collada::count(const pugi::xml_node& at, const char* attribute, std::uint64_t fallback) const {
  const pugi::xml_attribute a = at.attribute(attribute);
  if (!a) return fallback;
  const std::string_view text = trimmed(a.value());
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    fail(at, std::string("a whole number as its ") + attribute, in_quotes(text));
  return value;
}

std::vector<double> Collada::numbers(const pugi::xml_node& at) const {
  std::vector<double> result;
  for_each_word(at, [&](std::string_view word) {
    const auto value = parse_number(word);
    if (!value)
      fail(at, "numbers within the range of double",
           in_quotes(word) + " at place " + std::to_string(result.size()));
    result.push_back(*value);
  });
  return result;
}

std::vector<std::uint64_t> Collada::indices(const pugi::xml_node& at) const {
  std::vector<std::uint64_t> result;
  for_each_word(at, [&](std::string_view word) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size())
      fail(at, "whole numbers from 0", in_quotes(word) + " at place " + std::to_string(result.size()));
    result.push_back(value);
  });
  return result;
}

const std::vector<double>& Collada::array(const pugi::xml_node& at) const {
  const auto [place, is_new] = arrays_.try_emplace(at.internal_object());
  if (is_new) place->second = numbers(at);
  const std::size_t there = place->second.size();
  if (const std::uint64_t stated = count(at, "count", there); stated != there)
    fail(at, "a count of its " + std::to_string(there) + " numbers", std::to_string(stated));
  return place->second;
}

Asset read_collada(const std::string& path, const std::string& bytes, const ReadOptions& options) {
  const Collada file(path, bytes);
  std::vector<pugi::xml_node> geometries;
  for (const pugi::xml_node library : file.root().children("library_geometries"))
    for (const pugi::xml_node geometry : library.children("geometry")) geometries.push_back(geometry);
  auto instances = read_instances(file, geometries);
  Budget budget(options, bytes.size());
  Asset asset;
  for (std::size_t g = 0; g < geometries.size(); ++g)
    read_geometry(file, geometries[g], g, std::move(instances[g]), budget, asset);
  return asset;
}

}  // namespace darboux::io
