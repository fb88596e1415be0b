/// \file svg.h
/// Pieces of pictures that are written as SVG.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

namespace darboux::svg {

/// A number with at most one decimal, as pictures need them: the same text on every machine.
inline std::string tenths(double x) {
  const long t = std::lround(10 * x);
  std::string text = std::to_string(t / 10);
  if (t < 0 && t > -10) text = "-0";
  return t % 10 == 0 ? text : text + '.' + std::to_string(std::labs(t % 10));
}

/// \param attributes of the element, as class="t"
inline std::string label(double x, double y, const std::string& text, const std::string& attributes = "") {
  return "<text x=\"" + tenths(x) + "\" y=\"" + tenths(y) + "\"" +
         (attributes.empty() ? "" : " " + attributes) + ">" + text + "</text>\n";
}

inline std::string line(double x1, double y1, double x2, double y2, const std::string& attributes) {
  return "<path d=\"M" + tenths(x1) + ' ' + tenths(y1) + 'L' + tenths(x2) + ' ' + tenths(y2) + "\" " +
         attributes + "/>\n";
}

/// 10^d at an axis: "1", "100", "1e-05" as "1e-5".
inline std::string decade(int d) {
  return d >= 0 && d < 4 ? std::to_string(std::lround(std::pow(10.0, d))) : "1e" + std::to_string(d);
}

}  // namespace darboux::svg
