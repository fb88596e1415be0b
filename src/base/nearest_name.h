// Suggestions for an unknown name.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace darboux {

/// The number of letters to insert, delete, replace or swap with a neighbour to turn a into b. Case is
/// ignored, and '_' equals '-'.
inline std::size_t name_distance(std::string_view a, std::string_view b) {
  const auto plain = [](char c) { return c == '_' ? '-' : c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  const auto same = [&](std::size_t i, std::size_t j) { return plain(a[i]) == plain(b[j]); };
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    next[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      next[j + 1] = std::min({row[j] + (same(i, j) ? 0 : 1), row[j + 1] + 1, next[j] + 1});
      if (i > 0 && j > 0 && same(i, j - 1) && same(i - 1, j))
        next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
    }
    before.swap(row);
    row.swap(next);
  }
  return row[b.size()];
}

/// " (did you mean torus?)" if known names are similar, else empty: one letter in four may differ, of a name
/// or of one of its words ("klein" of klein-bottle).
inline std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 100;  // of a typed name
  if (name.empty() || name.size() > longest) return {};
  std::vector<std::string> nearest;
  std::size_t least = name.size() / 4 + 1;
  const auto look = [&](std::string_view candidate, const std::string& of) {
    const std::size_t distance = name_distance(name, candidate);
    if (distance < least)
      nearest = {of}, least = distance;
    else if (distance == least && !nearest.empty() && nearest.back() != of)
      nearest.push_back(of);
  };
  for (const std::string& other : known) look(other, other);
  if (nearest.empty() && name.size() > 2)
    for (const std::string& other : known)
      for (std::size_t begin = 0; begin < other.size();) {
        const std::size_t end = std::min(other.find_first_of("-_", begin), other.size());
        look(std::string_view(other).substr(begin, end - begin), other);
        begin = end + 1;
      }
  std::string text;
  for (std::size_t k = 0; k < nearest.size(); ++k)
    text += (k == 0 ? "" : k + 1 < nearest.size() ? ", " : " or ") + nearest[k];
  return text.empty() ? text : " (did you mean " + text + "?)";
}

}  // namespace darboux
