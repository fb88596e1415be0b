#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <string>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/normal_map.h>

#include "base/degrees.h"
#include "base/parallel.h"
#include "base/text.h"
#include "normal_map/corners.h"
#include "normal_map/coverage.h"
#include "normal_map/covered.h"
#include "normal_map/dilate.h"
#include "normal_map/frames.h"
#include "normal_map/texels.h"
#include "normal_map/wrap.h"

namespace darboux {
namespace {

using normal_map::Columns;
using normal_map::name_of;
using normal_map::Span;
using normal_map::TexelTriangle;
using normal_map::wrapped;

constexpr std::int64_t band_rows = 64;
constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

// A triangle that covers texels.
struct MapTriangle {
  TexelTriangle texels;
  std::uint32_t piece, triangle;
};

// The counts of the rows of one band.
struct BandTally {
  std::size_t covered = 0, conflicts = 0, below_surface = 0, not_finite = 0, no_frame = 0, too_long = 0,
              outside_map = 0, condition_above_10 = 0;
  double condition_square = 0, chord_square_max = 0, chord_square_sum = 0;
  std::optional<MapConflict> first_conflict;
  std::size_t first_conflict_texel = 0;
};

class Converter {
 public:
  Converter(const Image& map, std::span<const MapPiece> pieces, const NormalMapOptions& options)
      : map_(map),
        pieces_(pieces),
        options_(options),
        out_type_(options.type.value_or(map.type())),
        in_coding_(map.type(), options.signed_floats),
        out_coding_(out_type_, options.signed_floats, options.dither),
        in_(map) {
    check();
  }

  NormalMapResult run() {
    for (const MapPiece& piece : pieces_) add_piece(piece);
    work_.check(map_.texels());
    result_.image = Image(map_.width, map_.height, map_.channels, out_type_);
    result_.states.resize(map_.texels());
    owners_.resize(whole_surface() ? 0 : map_.texels(), nobody);
    out_.emplace(result_.image);
    const std::size_t bands = static_cast<std::size_t>((map_.height + band_rows - 1) / band_rows);
    fill_bins(bands);
    std::vector<BandTally> tallies(bands);
    std::mutex told;
    std::size_t done = 0;
    parallel_ranges(
        bands, thread_count(options_.threads),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t band = begin; band < end; ++band) {
            run_band(band, tallies[band]);
            finish_band(band);
            if (!options_.progress) continue;
            const std::lock_guard lock(told);
            options_.progress(static_cast<double>(++done) / static_cast<double>(bands));
          }
        },
        1);
    sum_up(tallies);
    if (result_.conflicts != 0)
      result_.image = Image();
    else if (options_.dilate > 0)
      result_.dilated = normal_map::dilate(result_.image, result_.states, options_.dilate, wraps());
    return std::move(result_);
  }

 private:
  // ---- what is asked for
  // ------------------------------------------------------------------------------------

  bool reads_frames() const { return options_.to == MapSpace::tangent || options_.from == MapSpace::tangent; }
  bool whole_surface() const { return pieces_.empty(); }
  bool analytic() const { return options_.basis == MapBasis::analytic && reads_frames(); }

  std::array<bool, 2> wraps() const {
    std::array<bool, 2> result{true, true};
    for (const MapPiece& piece : pieces_)
      for (std::size_t k = 0; k < 2; ++k) result[k] = result[k] && piece.wrap[k] == MapWrap::repeat;
    return result;
  }

  void check() const {
    const auto fail = [](const char* what, const std::string& expected, const std::string& got) {
      throw ParameterError(what, expected_got(expected, got));
    };
    if (map_.width < 1 || map_.height < 1 || (map_.channels != 3 && map_.channels != 4))
      fail("map", "an image of 3 or 4 channels",
           std::to_string(map_.width) + " x " + std::to_string(map_.height) + " of " +
               std::to_string(map_.channels));
    const std::size_t samples = std::visit([](const auto& s) { return s.size(); }, map_.samples);
    if (samples != map_.texels() * static_cast<std::size_t>(map_.channels))
      fail("map", std::to_string(map_.texels() * static_cast<std::size_t>(map_.channels)) + " samples",
           std::to_string(samples));
    if (options_.to == MapSpace::world) fail("to", "object or tangent", "world");
    if (options_.from == options_.to) fail("to", "another space than that of the map", "the same");
    if (options_.two_channels && options_.from != MapSpace::tangent)
      fail("two channels", "a map in tangent space", "another");
    if (options_.dilate < 0 || options_.dilate > 1024)
      fail("dilate", "0 to 1024 texels", std::to_string(options_.dilate));
    if (options_.basis == MapBasis::analytic && options_.surface == nullptr)
      fail("basis", "a surface for the analytic one", "none");
    if (whole_surface() && !analytic()) fail("mesh", "triangles that the map lies on", "none");
  }

  void check(const MapPiece& piece) const {
    const Mesh& mesh = piece.mesh;
    const std::string name = name_of(piece);
    check_consistent(mesh, name);
    check_finite(mesh, name);
    const auto need = [&](bool there, const char* what) {
      if (!there) throw MeshError(name, expected_got(what, "none"));
    };
    need(!mesh.uvs.empty(), "uvs");
    if (reads_frames() && !analytic()) {
      need(!mesh.normals.empty(), "normals");
      need(options_.basis != MapBasis::stored || !mesh.tangents.empty(),
           "tangents, or --basis mikktspace to make them");
    }
    if (!std::isfinite(piece.scale) || (piece.scale == 0 && options_.to == MapSpace::tangent))
      throw MeshError(name,
                      expected_got("a scale that x and y of a map can be divided by", shortest(piece.scale)));
    if (options_.from == MapSpace::world &&
        !(std::isfinite(piece.to_world.sum()) && piece.to_world.determinant() != 0))
      throw MeshError(name, expected_got("a node whose matrix has an inverse", "a singular one"));
  }

  // ---- triangles ----------------------------------------------------------------------------------------

  void add_piece(const MapPiece& piece) {
    check(piece);
    const std::uint32_t index = static_cast<std::uint32_t>(&piece - pieces_.data());
    const bool framed = reads_frames() && !analytic();
    corners_.emplace_back(piece, framed ? options_.basis : MapBasis::stored, options_.threads);
    from_world_.push_back(piece.to_world.transpose());
    for (std::size_t i = 0; i < piece.mesh.triangles.size(); ++i) {
      const auto texels = normal_map::texel_triangle(piece, i, map_.width, map_.height);
      if (!texels) {
        ++result_.degenerate_uv_triangles;
        continue;
      }
      if (framed) {
        const auto of = corners_.back().of(i);
        result_.mixed_sign_triangles += of[0].w != of[1].w || of[0].w != of[2].w;
      }
      work_.add(*texels);
      triangles_.push_back({*texels, index, static_cast<std::uint32_t>(i)});
    }
  }

  // The triangles of each band of rows, in their order; counts texels above and below a map that clamps.
  void fill_bins(std::size_t bands) {
    bins_.resize(bands);
    std::vector<std::uint32_t> seen(bands, nobody);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      const auto [first, last] = triangles_[i].texels.rows();
      const MapWrap wrap = pieces_[triangles_[i].piece].wrap[1];
      const auto [low, high] = limits(first, last, map_.height, wrap);
      for (std::int64_t y = first; y < last; ++y) {
        if (y < low || y >= high) {
          const Span span = triangles_[i].texels.span(y);
          result_.outside_map += static_cast<std::size_t>(span.end - span.begin);
          continue;
        }
        const auto band = static_cast<std::size_t>(wrapped(y, map_.height, wrap) / band_rows);
        if (seen[band] == i) continue;
        seen[band] = i;
        bins_[band].push_back(i);
      }
    }
  }

  // The part of begin to end - 1 that is inside the map.
  static std::array<std::int64_t, 2> limits(std::int64_t begin, std::int64_t end, std::int64_t size,
                                            MapWrap wrap) {
    if (wrap != MapWrap::clamp) return {begin, end};
    return {std::max<std::int64_t>(begin, 0), std::min(end, size)};
  }

  // ---- rows -----------------------------------------------------------------------------------------------

  void run_band(std::size_t band, BandTally& tally) {
    if (whole_surface()) {
      const auto first = static_cast<std::int64_t>(band) * band_rows;
      for (std::int64_t y = first; y < std::min<std::int64_t>(first + band_rows, map_.height); ++y)
        analytic_row({0, map_.width, {}}, y, y, nullptr, nobody, tally);
      return;
    }
    for (const std::uint32_t i : bins_[band]) {
      const MapTriangle& of = triangles_[i];
      const double scale = pieces_[of.piece].scale;
      if (!reads_frames()) {
        rows(band, i, [&](const Span& span, std::int64_t, std::int64_t row) {
          each_texel(span, row, i, tally,
                     [&](std::int64_t, std::size_t texel) { put(texel, i, from_world(texel, of), tally); });
        });
      } else if (analytic()) {
        rows(band, i, [&](const Span& span, std::int64_t y, std::int64_t row) {
          analytic_row(span, y, row, &pieces_[of.piece], i, tally);
        });
      } else if (options_.decode == MapDecode::mikktspace) {
        framed_rows(band, i, normal_map::MikkFrames(corners_[of.piece].of(of.triangle), scale), tally);
      } else {
        framed_rows(band, i, normal_map::ViewerFrames(corners_[of.piece].of(of.triangle), scale), tally);
      }
    }
  }

  // Calls f(span, y, row of the map) for the rows of a triangle in the band.
  template <class F>
  void rows(std::size_t band, std::uint32_t index, const F& f) const {
    const MapTriangle& of = triangles_[index];
    const MapWrap wrap = pieces_[of.piece].wrap[1];
    const auto [first, last] = of.texels.rows();
    const auto [low, high] = limits(first, last, map_.height, wrap);
    if (low >= high) return;
    const std::int64_t height = map_.height, top = static_cast<std::int64_t>(band) * band_rows,
                       bottom = std::min(top + band_rows, height);
    const auto copy_of = [&](std::int64_t y) { return y >= 0 ? y / height : -1 - (-1 - y) / height; };
    // The band in each copy of the map that the triangle reaches; upside down in odd copies if the map
    // mirrors.
    for (std::int64_t copy = copy_of(low); copy <= copy_of(high - 1); ++copy) {
      const bool turned = wrap == MapWrap::mirror && copy % 2 != 0;
      const std::int64_t begin = copy * height + (turned ? height - bottom : top),
                         end = begin + (bottom - top);
      for (std::int64_t y = std::max(begin, low); y < std::min(end, high); ++y)
        if (const Span span = of.texels.span(y); span.begin < span.end) f(span, y, wrapped(y, height, wrap));
    }
  }

  // Calls f(column, possibly outside the map, texel) for the texels of a span.
  template <class F>
  void each_texel(const Span& span, std::int64_t row, std::uint32_t owner, BandTally& tally,
                  const F& f) const {
    const MapWrap wrap = owner == nobody ? MapWrap::clamp : pieces_[triangles_[owner].piece].wrap[0];
    const auto [begin, end] = limits(span.begin, span.end, map_.width, wrap);
    tally.outside_map +=
        static_cast<std::size_t>((span.end - span.begin) - std::max(end - begin, std::int64_t{0}));
    const std::size_t row_begin = static_cast<std::size_t>(row * map_.width);
    for (std::int64_t x = begin; x < end; ++x)
      f(x, row_begin + static_cast<std::size_t>(wrapped(x, map_.width, wrap)));
  }

  template <class Frames>
  void framed_rows(std::size_t band, std::uint32_t index, Frames frames, BandTally& tally) {
    const TexelTriangle& texels = triangles_[index].texels;
    frames.set_steps({texels.step(0), texels.step(1), texels.step(2)});
    rows(band, index, [&](const Span& span, std::int64_t, std::int64_t row) {
      frames.start_row(span.weights);
      each_texel(span, row, index, tally, [&](std::int64_t x, std::size_t texel) {
        const Columns frame = frames.at(static_cast<double>(x - span.begin));
        const double condition_square =
            frames.condition_square(frame, std::min(tally.condition_square, 100.0));
        if (!convert(texel, index, frame, tally)) return;
        tally.condition_square = std::max(tally.condition_square, condition_square);
        tally.condition_above_10 += condition_square > 100;
      });
    });
  }

  void analytic_row(const Span& span, std::int64_t y, std::int64_t row, const MapPiece* piece,
                    std::uint32_t owner, BandTally& tally) {
    const bool v_up = piece != nullptr && piece->v_up;
    const double down = (static_cast<double>(y) + 0.5) / map_.height, v = v_up ? 1 - down : down;
    const double scale = piece != nullptr ? piece->scale : 1,
                 condition_square = std::max(scale * scale, 1 / (scale * scale));
    each_texel(span, row, owner, tally, [&](std::int64_t x, std::size_t texel) {
      const Frame<double> f = options_.surface->frame((static_cast<double>(x) + 0.5) / map_.width, v);
      const double w = v_up ? f.handedness : -f.handedness;
      if (!convert(texel, owner, {scale * f.t, scale * w * cross(f.n, f.t), f.n}, tally)) return;
      tally.condition_square = std::max(tally.condition_square, condition_square);
      tally.condition_above_10 += condition_square > 100;
    });
  }

  // ---- one texel ------------------------------------------------------------------------------------------

  struct Wanted {
    Vec3<double> direction;  // of any length, in the space to be written
    double length = 1;       // to be written
    bool finite = true;      // whether the texel read is a direction
    bool below_surface = false, too_long = false;
  };

  // The direction in the map, in its own space; green up.
  Wanted read(std::size_t texel) const {
    Wanted result;
    std::array<double, 3> codes = in_.get(texel);
    Vec3<double>& x = result.direction;
    x = in_coding_.numbers(codes);
    if (options_.from == MapSpace::tangent) {
      if (options_.green == MapGreen::directx) x.y = -x.y;
      if (options_.two_channels) {
        const double rest = 1 - (x.x * x.x + x.y * x.y);
        result.too_long = rest < 0;
        x.z = rest > 0 ? std::sqrt(rest) : 0;
      }
      result.below_surface = x.z <= 0;
    }
    const double length = std::sqrt(dot(x, x));
    result.finite = length > 0 && std::isfinite(length);
    if (options_.keep_length) result.length = length;
    return result;
  }

  Wanted from_world(std::size_t texel, const MapTriangle& of) const {
    Wanted wanted = read(texel);
    wanted.direction = to_object(wanted.direction, of.piece);
    return wanted;
  }
  Vec3<double> to_object(const Vec3<double>& x, std::uint32_t piece) const {
    const Eigen::Vector3d y = from_world_[piece] * Eigen::Vector3d(x.x, x.y, x.z);
    return {y.x(), y.y(), y.z()};
  }

  // \returns whether the texel has a frame and a direction
  bool convert(std::size_t texel, std::uint32_t owner, const Columns& frame, BandTally& tally) {
    Wanted wanted = read(texel);
    if (options_.to == MapSpace::object) {
      wanted.direction = times(frame, wanted.direction);
    } else {
      if (options_.from == MapSpace::world && owner != nobody)
        wanted.direction = to_object(wanted.direction, triangles_[owner].piece);
      wanted.direction = inverse_times(frame, wanted.direction);
      wanted.below_surface = wanted.direction.z <= 0;
      if (options_.green == MapGreen::directx) wanted.direction.y = -wanted.direction.y;
    }
    return put(texel, owner, wanted, tally);
  }

  bool put(std::size_t texel, std::uint32_t owner, const Wanted& wanted, BandTally& tally) {
    const double length = std::sqrt(dot(wanted.direction, wanted.direction));
    if (!wanted.finite || !(length > 0) || !std::isfinite(length)) {
      ++(wanted.finite ? tally.no_frame : tally.not_finite);
      return false;
    }
    const Vec3<double> unit = wanted.direction / length;
    const std::array<double, 3> codes = out_coding_.codes(wanted.length * unit, texel);
    if (result_.states[texel] != TexelState::empty) {
      compare(texel, owner, codes, tally);
      return true;
    }
    result_.states[texel] = TexelState::covered;
    if (owner != nobody) owners_[texel] = owner;
    out_->set(texel, codes);
    ++tally.covered;
    tally.below_surface += wanted.below_surface;
    tally.too_long += wanted.too_long;
    const Vec3<double> written = out_coding_.numbers(codes);
    const Vec3<double> chord = written / std::sqrt(dot(written, written)) - unit;
    const double chord_square = dot(chord, chord);
    tally.chord_square_max = std::max(tally.chord_square_max, chord_square);
    tally.chord_square_sum += chord_square;
    return true;
  }

  // Compares a further triangle at a texel.
  void compare(std::size_t texel, std::uint32_t owner, const std::array<double, 3>& codes, BandTally& tally) {
    const std::array<double, 3> stored = out_->get(texel);
    const double step = normal_map::code_step(out_type_);
    bool same = true;
    for (std::size_t c = 0; c < 3; ++c) same = same && std::fabs(codes[c] - stored[c]) <= step;
    if (same || result_.states[texel] == TexelState::conflict) return;
    result_.states[texel] = TexelState::conflict;
    ++tally.conflicts;
    if (tally.first_conflict && tally.first_conflict_texel < texel) return;
    const MapTriangle &first = triangles_[owners_[texel]], &second = triangles_[owner];
    const std::size_t width = static_cast<std::size_t>(map_.width);
    tally.first_conflict_texel = texel;
    tally.first_conflict =
        MapConflict{static_cast<int>(texel % width),
                    static_cast<int>(texel / width),
                    {{{first.piece, first.triangle, stored}, {second.piece, second.triangle, codes}}}};
  }

  // ---- the rest -------------------------------------------------------------------------------------------

  // Uncovered texels, and alpha.
  void finish_band(std::size_t band) {
    const std::size_t width = static_cast<std::size_t>(map_.width);
    const std::size_t begin = band * band_rows * width,
                      end = std::min(begin + band_rows * width, map_.texels());
    const double z = options_.to == MapSpace::tangent ? 1 : 0;
    const auto empty = normal_map::Coding(out_type_, options_.signed_floats).codes({0, 0, z}, 0);
    const double scale = normal_map::most_of(out_type_) / normal_map::most_of(map_.type());
    for (std::size_t texel = begin; texel < end; ++texel) {
      if (result_.states[texel] == TexelState::empty) out_->set(texel, empty);
      if (map_.channels != 4) continue;
      const double alpha = scale * in_.get(texel, 3);
      // fmax() takes 0 for NaN.
      out_->set(texel, 3,
                out_type_ == SampleType::f32
                    ? alpha
                    : std::floor(std::fmin(std::fmax(alpha, 0), normal_map::most_of(out_type_)) + 0.5));
    }
  }

  void sum_up(const std::vector<BandTally>& tallies) {
    double condition_square = 0, chord_square_max = 0, chord_square_sum = 0;
    for (const BandTally& t : tallies) {
      result_.covered += t.covered;
      result_.conflicts += t.conflicts;
      result_.below_surface += t.below_surface;
      result_.not_finite += t.not_finite;
      result_.no_frame += t.no_frame;
      result_.too_long += t.too_long;
      result_.outside_map += t.outside_map;
      result_.condition_above_10 += t.condition_above_10;
      condition_square = std::fmax(condition_square, t.condition_square);
      chord_square_max = std::fmax(chord_square_max, t.chord_square_max);
      chord_square_sum += t.chord_square_sum;
      if (!result_.first_conflict) result_.first_conflict = t.first_conflict;
    }
    result_.condition = std::sqrt(condition_square);
    result_.quantisation_max_deg =
        2 * std::asin(std::fmin(1, std::sqrt(chord_square_max) / 2)) * degrees_per_radian;
    if (result_.covered > 0)
      result_.quantisation_rms_deg =
          std::sqrt(chord_square_sum / static_cast<double>(result_.covered)) * degrees_per_radian;
  }

  const Image& map_;
  std::span<const MapPiece> pieces_;
  const NormalMapOptions& options_;
  SampleType out_type_;
  normal_map::Coding in_coding_, out_coding_;
  normal_map::TexelAccess<const Image> in_;
  std::optional<normal_map::TexelAccess<Image>> out_;
  std::vector<normal_map::Corners> corners_;  // of each piece
  std::vector<Eigen::Matrix3d> from_world_;
  std::vector<MapTriangle> triangles_;
  std::vector<std::vector<std::uint32_t>> bins_;
  std::vector<std::uint32_t> owners_;
  normal_map::Work work_;
  NormalMapResult result_;
};

}  // namespace

NormalMapResult convert_normal_map(const Image& map, std::span<const MapPiece> pieces,
                                   const NormalMapOptions& options) {
  return Converter(map, pieces, options).run();
}

Image picture_of(const NormalMapResult& result, int width, int height) {
  Image picture(width, height, 3, SampleType::u8);
  constexpr std::array<std::array<std::uint8_t, 3>, 4> colours{
      {{0, 0, 0}, {160, 160, 160}, {80, 80, 80}, {255, 0, 0}}};
  auto& samples = std::get<0>(picture.samples);
  for (std::size_t i = 0; i < std::min(picture.texels(), result.states.size()); ++i)
    std::copy_n(colours[static_cast<std::size_t>(result.states[i])].begin(), 3, &samples[3 * i]);
  return picture;
}

}  // namespace darboux
