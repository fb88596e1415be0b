#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <darboux/check_normal_map.h>
#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/mesh_classes.h>

#include "base/degrees.h"
#include "base/text.h"
#include "normal_map/covered.h"
#include "normal_map/flat.h"
#include "normal_map/texels.h"

namespace darboux {
namespace {

void check_image(const Image& map) {
  const std::size_t samples = std::visit([](const auto& s) { return s.size(); }, map.samples);
  if (map.width < 1 || map.height < 1 || map.channels < 3 ||
      samples != map.texels() * static_cast<std::size_t>(map.channels))
    throw ParameterError("map", expected_got("an image of 3 or 4 channels",
                                             std::to_string(map.width) + " x " + std::to_string(map.height) +
                                                 " of " + std::to_string(map.channels)));
}

// ---- slopes -----------------------------------------------------------------------------------------------

// -x/z and -y/z, averaged over squares of texels, with the largest error by rounding; NaN where z is too
// small.
struct Slopes {
  struct Cell {
    float p, q, p_error, q_error;
  };
  int width = 0, height = 0;
  std::vector<Cell> cells;
  const Cell& at(int x, int y) const {
    return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

Slopes::Cell slope_of(const Vec3<double>& n, double half_code) {
  constexpr double least_z = 0.05;
  if (!(n.z > least_z)) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  const double p = -n.x / n.z, q = -n.y / n.z, share = half_code / (n.z - half_code);
  return {static_cast<float>(p), static_cast<float>(q), static_cast<float>(share * (1 + std::fabs(p))),
          static_cast<float>(share * (1 + std::fabs(q)))};
}

Slopes halved(const Slopes& fine) {
  Slopes coarse{fine.width / 2, fine.height / 2, {}};
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      Slopes::Cell sum{0, 0, 0, 0};
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const Slopes::Cell& c = fine.at(2 * x + dx, 2 * y + dy);
        sum = {sum.p + c.p / 4, sum.q + c.q / 4, sum.p_error + c.p_error / 4, sum.q_error + c.q_error / 4};
      }
      coarse.cells.push_back(sum);
    }
  return coarse;
}

// The agreement between the derivative of one slope down the image and that of the other along it.
struct Agreement {
  std::size_t alike = 0, opposite = 0;                       // cells where both are beyond rounding
  double sum_square = 0, difference_square = 0, square = 0;  // over cells where one is

  // \param a, b and their errors by rounding
  void add(double a, double a_error, double b, double b_error) {
    const bool a_counts = std::fabs(a) > a_error, b_counts = std::fabs(b) > b_error;
    if (a_counts && b_counts) ++(a * b > 0 ? alike : opposite);
    if (!a_counts && !b_counts) return;
    sum_square += (a + b) * (a + b);
    difference_square += (a - b) * (a - b);
    square += a * a + b * b;
  }
  std::size_t votes() const { return alike + opposite; }
  double share() const {
    return static_cast<double>(std::max(alike, opposite)) / static_cast<double>(votes());
  }
  // For the better of the two signs. Vanishing derivatives agree.
  double residual() const { return square > 0 ? std::min(sum_square, difference_square) / square : 0; }
};

constexpr std::size_t least_votes = 16;
constexpr double least_share = 0.8;
// Most reliefs, including compressed and noisy ones, have a residual below it. Maps baked for details that
// triangles lack are no reliefs and stay above: the least of 150 was 0.28.
constexpr double relief = 0.2;

struct ScaleAgreement {
  Agreement as_named, swapped;
};

ScaleAgreement agreement_of(const Slopes& slopes) {
  ScaleAgreement result;
  for (int y = 1; y + 1 < slopes.height; ++y)
    for (int x = 1; x + 1 < slopes.width; ++x) {
      const Slopes::Cell &above = slopes.at(x, y - 1), &below = slopes.at(x, y + 1),
                         &left = slopes.at(x - 1, y), &right = slopes.at(x + 1, y);
      const double sum = above.p + below.p + left.p + right.p;
      if (std::isnan(sum)) continue;
      result.as_named.add(below.p - above.p, below.p_error + above.p_error, right.q - left.q,
                          right.q_error + left.q_error);
      result.swapped.add(below.q - above.q, below.q_error + above.q_error, right.p - left.p,
                         right.p_error + left.p_error);
    }
  return result;
}

void look_at_slopes(Slopes slopes, NormalMapCheck& check) {
  ScaleAgreement best;
  double least_residual = 2;
  std::vector<ScaleAgreement> scales;
  while (slopes.width >= 4 && slopes.height >= 4) {
    scales.push_back(agreement_of(slopes));
    const ScaleAgreement& s = scales.back();
    for (const Agreement* a : {&s.as_named, &s.swapped})
      if (a->votes() >= least_votes && a->residual() < least_residual) {
        least_residual = a->residual();
        best = s;
      }
    slopes = halved(slopes);
  }
  constexpr double gradient = 0.1, no_gradient = 0.3;
  if (best.as_named.residual() < gradient && best.swapped.residual() > no_gradient) check.swapped = false;
  if (best.swapped.residual() < gradient && best.as_named.residual() > no_gradient) check.swapped = true;
  for (const ScaleAgreement& s : scales) {
    const Agreement& a = check.swapped.value_or(false) ? s.swapped : s.as_named;
    if (a.votes() < least_votes || a.share() < least_share || a.residual() > relief) continue;
    if (a.votes() <= check.voting_cells) continue;
    check.voting_cells = a.votes();
    check.agreeing = a.share();
    // v runs down the image, against w: with green up the derivatives are opposite.
    check.green = a.opposite > a.alike ? MapGreen::opengl : MapGreen::directx;
  }
}

}  // namespace

NormalMapCheck check_normal_map(const Image& map, bool signed_floats) {
  check_image(map);
  const normal_map::TexelAccess access(map);
  const normal_map::Coding coding(map.type(), signed_floats);
  const bool floats = map.type() == SampleType::f32;
  const double half_code = floats ? 1e-7 : 1 / normal_map::most_of(map.type());
  // A relief too flat for 8 bits does not count: smaller slopes in deeper maps are residue of a bake.
  const double half_code_of_slopes = 1 / normal_map::most_of(SampleType::u8);
  const double off = floats ? 1e-6 : 2 * std::sqrt(3.0) * half_code * (1 + 1e-9);
  NormalMapCheck check;
  check.texels = map.texels();
  check.flat = true;
  check.least_length = std::numeric_limits<double>::infinity();
  Slopes slopes{map.width, map.height, {}};
  slopes.cells.reserve(map.texels());
  for (std::size_t i = 0; i < map.texels(); ++i) {
    const Vec3<double> n = coding.numbers(access.get(i));
    const double length = std::sqrt(dot(n, n));
    slopes.cells.push_back(slope_of(n, half_code_of_slopes));
    if (!(length > 0) || !std::isfinite(length)) {
      ++check.not_finite;
      check.flat = false;
      continue;
    }
    check.below_surface += n.z <= 0;
    check.not_unit += std::fabs(length - 1) > off;
    check.least_length = std::fmin(check.least_length, length);
    check.greatest_length = std::fmax(check.greatest_length, length);
    check.flat = check.flat && normal_map::is_flat(n);
    for (std::size_t c = 0; c < 3; ++c) check.mean[c] += (c == 0 ? n.x : c == 1 ? n.y : n.z);
  }
  const std::size_t finite = check.texels - check.not_finite;
  if (finite == 0) {
    check.least_length = 0;
    return check;
  }
  for (double& m : check.mean) m /= static_cast<double>(finite);
  const auto largest = std::max_element(check.mean.begin(), check.mean.end());
  if (*largest > 0.25) check.z_channel = static_cast<int>(largest - check.mean.begin());
  look_at_slopes(std::move(slopes), check);
  return check;
}

// ---- two maps ---------------------------------------------------------------------------------------------

namespace {

// The island of each texel, numbered over all pieces; -1: none.
class Islands {
 public:
  Islands(std::span<const MapPiece> pieces, int width, int height)
      : of_texel_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                  pieces.empty() ? 0 : -1) {
    if (pieces.empty()) islands_.push_back({});
    normal_map::Work work;
    for (std::size_t p = 0; p < pieces.size(); ++p) add(pieces[p], p, width, height, work);
  }
  std::int32_t of(std::size_t texel) const { return of_texel_[texel]; }
  std::vector<MapDifference::Island>& islands() { return islands_; }

 private:
  void add(const MapPiece& piece, std::size_t index, int width, int height, normal_map::Work& work) {
    const std::string name = normal_map::name_of(piece);
    check_consistent(piece.mesh, name);
    check_finite(piece.mesh, name);
    if (piece.mesh.uvs.empty()) throw MeshError(name, expected_got("uvs", "none"));
    const MeshClasses classes = classify(piece.mesh, {});
    const auto first = static_cast<std::int32_t>(islands_.size());
    for (std::int32_t k = 0; k < classes.islands; ++k) islands_.push_back({index, k, 0, {}});
    for (std::size_t i = 0; i < piece.mesh.triangles.size(); ++i) {
      const auto triangle = normal_map::texel_triangle(piece, i, width, height);
      if (!triangle || classes.island_of_triangle[i] < 0) continue;
      work.add(*triangle);
      work.check(of_texel_.size());
      const auto [low, high] = triangle->rows();
      for (std::int64_t y = low; y < high; ++y) {
        const std::int64_t row = normal_map::wrapped(y, height, piece.wrap[1]);
        if (row < 0) continue;
        const normal_map::Span span = triangle->span(y);
        for (std::int64_t x = span.begin; x < span.end; ++x)
          if (const std::int64_t column = normal_map::wrapped(x, width, piece.wrap[0]); column >= 0) {
            std::int32_t& of = of_texel_[static_cast<std::size_t>(row * width + column)];
            if (of < 0) of = first + classes.island_of_triangle[i];
          }
      }
    }
  }
  std::vector<std::int32_t> of_texel_;
  std::vector<MapDifference::Island> islands_;
};

}  // namespace

MapDifference compare_normal_maps(const Image& a, const Image& b, std::span<const MapPiece> pieces,
                                  const CompareMapsOptions& options) {
  check_image(a);
  check_image(b);
  const auto size = [](const Image& i) { return std::to_string(i.width) + " x " + std::to_string(i.height); };
  if (a.width != b.width || a.height != b.height)
    throw ParameterError("maps", expected_got("two of one size", size(a) + " and " + size(b)));
  Islands islands(pieces, a.width, a.height);
  const auto reader = [&](const Image& map, MapGreen green) {
    return [access = normal_map::TexelAccess(map),
            coding = normal_map::Coding(map.type(), options.signed_floats),
            flip = green == MapGreen::directx ? -1.0 : 1.0](std::size_t texel) {
      Vec3<double> n = coding.numbers(access.get(texel));
      n.y *= flip;
      return n;
    };
  };
  const auto of_a = reader(a, options.green_a), of_b = reader(b, options.green_b);
  MapDifference result;
  result.angles_deg.assign(a.texels(), std::numeric_limits<float>::quiet_NaN());
  std::vector<std::vector<double>> by_island(islands.islands().size());
  std::vector<double> all;
  std::vector<MapDifference::Texel>& worst = result.worst;
  const auto worse = [](const auto& one, const auto& other) { return one.angle_deg > other.angle_deg; };
  for (std::size_t i = 0; i < a.texels(); ++i) {
    const std::int32_t island = islands.of(i);
    if (island < 0) continue;
    const Vec3<double> x = of_a(i), y = of_b(i);
    const double angle = angle_between(x, y) * degrees_per_radian, lengths = norm(x) * norm(y);
    if (!(lengths > 0) || !std::isfinite(lengths)) {
      ++result.not_finite;
      continue;
    }
    result.angles_deg[i] = static_cast<float>(angle);
    all.push_back(angle);
    by_island[static_cast<std::size_t>(island)].push_back(angle);
    const auto most = static_cast<std::size_t>(std::max(options.worst, 0));
    if (most == 0 || (worst.size() == most && angle <= worst.back().angle_deg)) continue;
    const auto width = static_cast<std::size_t>(a.width);
    const MapDifference::Texel texel{static_cast<int>(i % width), static_cast<int>(i / width), angle, island};
    worst.insert(std::upper_bound(worst.begin(), worst.end(), texel, worse), texel);
    if (worst.size() > most) worst.pop_back();
  }
  result.compared = all.size();
  result.angle_deg = summarise(all);
  for (std::size_t k = 0; k < by_island.size(); ++k) {
    if (by_island[k].empty()) continue;
    result.islands.push_back(islands.islands()[k]);
    result.islands.back().texels = by_island[k].size();
    result.islands.back().angle_deg = summarise(by_island[k]);
  }
  return result;
}

Image heat_map(const MapDifference& difference, int width, int height, double full_deg) {
  Image picture(width, height, 3, SampleType::u8);
  auto& samples = std::get<0>(picture.samples);
  constexpr std::array<std::array<double, 3>, 4> colours{
      {{40, 20, 90}, {30, 110, 140}, {90, 190, 90}, {250, 230, 40}}};
  for (std::size_t i = 0; i < std::min(picture.texels(), difference.angles_deg.size()); ++i) {
    const double angle = difference.angles_deg[i];
    if (std::isnan(angle)) continue;
    const double at = 3 * (full_deg > 0 ? std::clamp(angle / full_deg, 0.0, 1.0) : 0);
    const auto k = static_cast<std::size_t>(std::min(at, 2.0));
    for (std::size_t c = 0; c < 3; ++c) {
      const double share = at - static_cast<double>(k);
      samples[3 * i + c] =
          static_cast<std::uint8_t>(std::lround((1 - share) * colours[k][c] + share * colours[k + 1][c]));
    }
  }
  return picture;
}

}  // namespace darboux
