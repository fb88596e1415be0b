/// \file json_cursor.h
/// A value within a JSON document that knows its path, so that messages state the location:
/// "accessors[3].count: expected an integer not below 1, got -1", or as a JSON pointer "/accessors/3/count".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/error.h>

#include "base/text.h"
#include "files.h"

namespace darboux::io {

/// Keeps the order of keys, so that a rewritten document stays close to the original.
using Json = nlohmann::ordered_json;

/// \param error the error of the parser \throws FileError with the subject `file`, in the format of this tool
[[noreturn]] void refuse_json(const std::string& file, const nlohmann::detail::exception& error);

/// \param text JSON of at most 256 levels \throws FileError with the subject `file`
Json parse_json(const std::string& file, std::string_view text);

/// A value of a document that knows its path. All accessors throw FileError if the value does not have the
/// requested type. It refers to the document and must not outlive it.
class JsonCursor {
 public:
  JsonCursor(const std::string& file, const Json& json, std::string name)
      : file_(&file), json_(&json), name_(std::move(name)) {}
  /// A whole document whose values are named by JSON pointers.
  static JsonCursor with_pointers(const std::string& file, const Json& json) {
    JsonCursor root(file, json, "");
    root.by_pointer_ = true;
    return root;
  }

  const Json& json() const { return *json_; }
  const std::string& name() const { return name_; }

  /// \throws FileError "FILE: NAME: WHY"
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(*file_, (name_.empty() ? "" : name_ + ": ") + why);
  }
  /// \throws FileError "FILE: NAME: expected EXPECTED, got GOT"
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
    refuse(expected_got(expected, got));
  }
  /// The same, with the value itself as the text after "got".
  [[noreturn]] void fail(const std::string& expected) const { fail(expected, shown()); }

  /// The value for a message: numbers in full, texts quoted, otherwise the type.
  std::string shown() const {
    if (json_->is_string()) return in_quotes(json_->get_ref<const std::string&>());
    return json_->is_structured() ? json_->type_name() : json_->dump();
  }

  bool has(const std::string& key) const {
    if (!json_->is_object()) fail("an object");
    return json_->contains(key);
  }
  JsonCursor at(const std::string& key) const {
    if (!has(key)) fail("an object with " + key, "one without");
    const Json& value = *json_->find(key);
    if (by_pointer_) return pointer_to(value, key);
    return {*file_, value, name_ == "the document" ? key : name_ + "." + key};
  }

  /// The object of an extension; empty if the value does not have it.
  std::optional<JsonCursor> extension(const char* key) const {
    if (!has("extensions") || !at("extensions").has(key)) return std::nullopt;
    return at("extensions").at(key);
  }

  /// Rejects an object with other keys than these.
  void expect_keys(std::initializer_list<const char*> known) const {
    if (!json_->is_object()) fail("an object");
    for (const auto& [key, value] : json_->items())
      if (std::find(known.begin(), known.end(), key) == known.end())
        at(key).fail("one of the keys " + joined(std::vector<std::string>(known.begin(), known.end())),
                     "an unknown one");
  }

  bool is_array() const { return json_->is_array(); }
  std::size_t size() const {
    if (!json_->is_array()) fail("an array");
    return json_->size();
  }
  JsonCursor at(std::size_t index) const {
    const std::string number = std::to_string(index);
    if (by_pointer_) return pointer_to((*json_)[index], number);
    return {*file_, (*json_)[index], name_ + "[" + number + "]"};
  }

  std::uint64_t integer(std::uint64_t least = 0,
                        std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) const {
    const std::optional<std::uint64_t> value = whole();
    if (!value || *value < least || *value > most)
      fail("an integer " + (most == std::numeric_limits<std::uint64_t>::max()
                                ? "not below " + std::to_string(least)
                                : "from " + std::to_string(least) + " to " + std::to_string(most)));
    return *value;
  }
  /// The integer of an optional key.
  std::uint64_t integer_or(const char* key, std::uint64_t fallback) const {
    return has(key) ? at(key).integer() : fallback;
  }
  double number() const {
    if (!json_->is_number()) fail("a number");
    return json_->get<double>();
  }
  bool boolean() const {
    if (!json_->is_boolean()) fail("true or false");
    return json_->get<bool>();
  }
  const std::string& text() const {
    if (!json_->is_string()) fail("a text");
    return json_->get_ref<const std::string&>();
  }

 private:
  // 1 may be written 1.0; a double names integers up to 2^53.
  std::optional<std::uint64_t> whole() const {
    if (json_->is_number_unsigned()) return json_->get<std::uint64_t>();
    if (json_->is_number_integer() && json_->get<std::int64_t>() >= 0) return json_->get<std::uint64_t>();
    if (!json_->is_number_float()) return std::nullopt;
    const double x = json_->get<double>();
    if (!(x >= 0 && x <= 0x1p53) || x != std::floor(x)) return std::nullopt;
    return static_cast<std::uint64_t>(x);
  }

  JsonCursor pointer_to(const Json& value, const std::string& key) const {
    std::string name = name_ + '/';
    for (const char c : key) name += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    JsonCursor result(*file_, value, std::move(name));
    result.by_pointer_ = true;
    return result;
  }

  const std::string* file_;
  const Json* json_;
  std::string name_;
  bool by_pointer_ = false;
};

}  // namespace darboux::io
