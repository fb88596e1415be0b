#include "histogram.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.h"
#include "colour_map.h"
#include "html.h"

namespace darboux {
namespace {

constexpr int bins_per_decade = 5, least_decade = -7;  // smaller errors count as 1e-7 degrees
constexpr double left = 64, right = 624, top = 12, bottom = 196;

std::string text(double x, double y, const char* anchor, const std::string& content) {
  return "<text x=\"" + rounded(x, 5) + "\" y=\"" + rounded(y, 5) + "\" text-anchor=\"" + anchor + "\">" +
         escape(content) + "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return "<path class=" + std::string(style) + " d=\"M" + rounded(x1, 5) + ' ' + rounded(y1, 5) + 'L' +
         rounded(x2, 5) + ' ' + rounded(y2, 5) + "\"/>\n";
}

std::string power_of_ten(int exponent) {
  return exponent >= -3 && exponent <= 3 ? rounded(std::pow(10.0, exponent), 4)
                                         : "1e" + std::to_string(exponent);
}

}  // namespace

std::string histogram_svg(std::span<const float> errors_deg, double limit_deg, const std::string& what) {
  const auto place = [](double error) { return std::fmax(std::log10(error), least_decade); };
  double least = std::log10(limit_deg), most = least;
  std::vector<double> sorted;
  for (const float e : errors_deg)
    if (!std::isnan(e)) sorted.push_back(e);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  least = std::fmin(least, place(sorted.front()));
  most = std::fmax(most, place(sorted.back()));
  const int first = std::max(static_cast<int>(std::floor(least)), least_decade);
  const int last = std::max(static_cast<int>(std::floor(most)), first) + 1;

  std::vector<std::size_t> counts(static_cast<std::size_t>((last - first) * bins_per_decade), 0);
  for (const double e : sorted) {
    const auto bin = static_cast<std::size_t>(std::fmax((place(e) - first) * bins_per_decade, 0));
    ++counts[std::min(bin, counts.size() - 1)];
  }
  const std::size_t largest = *std::max_element(counts.begin(), counts.end());
  const int height = static_cast<int>(std::floor(std::log10(static_cast<double>(largest)))) + 1;

  const auto x_of = [&](double exponent) {
    return left + (right - left) * (exponent - first) / (last - first);
  };
  // A count of 1 stands above the axis.
  const auto y_of = [&](double count) {
    return count == 0 ? bottom : bottom - (bottom - top) * (std::log10(count) + 0.3) / (height + 0.3);
  };
  const auto at_share = [&](double share) {
    return sorted[static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1];
  };
  const std::string summary = "Histogram of " + std::to_string(sorted.size()) + ' ' + what +
                              ": half are below " + rounded(at_share(0.5), 3) + " degrees, 95 % below " +
                              rounded(at_share(0.95), 3) + ", the largest is " + rounded(sorted.back(), 3) +
                              '.';
  std::string svg =
      "<svg class=histogram viewBox=\"0 0 640 240\" role=img aria-label=\"" + escape(summary) + "\">\n";
  for (int k = 0; k <= height; ++k) {
    const double y = y_of(std::pow(10.0, k));
    svg += line(left, y, right, y, "grid") + text(left - 6, y + 4, "end", power_of_ten(k));
  }
  for (int k = first; k <= last; ++k)
    svg += line(x_of(k), bottom, x_of(k), bottom + 5, "axis") +
           text(x_of(k), bottom + 19, "middle", power_of_ten(k));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const double from = first + static_cast<double>(i) / bins_per_decade, to = from + 1.0 / bins_per_decade;
    const double y = y_of(static_cast<double>(counts[i]));
    svg += "<rect x=\"" + rounded(x_of(from) + 0.5, 5) + "\" y=\"" + rounded(y, 5) + "\" width=\"" +
           rounded(x_of(to) - x_of(from) - 1, 5) + "\" height=\"" + rounded(bottom - y, 5) + "\" fill=\"" +
           css_colour(colour_of(static_cast<float>(std::pow(10.0, (from + to) / 2)), limit_deg)) +
           "\"><title>" + std::to_string(counts[i]) + " from " + rounded(std::pow(10.0, from), 2) + " to " +
           rounded(std::pow(10.0, to), 2) + " degrees</title></rect>\n";
  }
  svg += line(left, bottom, right, bottom, "axis");
  if (const double x = x_of(std::log10(limit_deg)); x >= left)
    svg += line(x, top, x, bottom, "limit") + text(x > right - 90 ? x - 5 : x + 5, top + 10,
                                                   x > right - 90 ? "end" : "start",
                                                   "limit " + rounded(limit_deg, 4) + "°");
  const std::string middle = rounded((top + bottom) / 2, 5);
  svg += "<text transform=\"translate(14 " + middle +
         ") rotate(-90)\" text-anchor=\"middle\">corners</text>\n" +
         text((left + right) / 2, 236, "middle",
              what + " in degrees" + (first == least_decade ? ", 1e-7 and less at the left" : ""));
  return svg + "</svg>\n";
}

}  // namespace darboux
