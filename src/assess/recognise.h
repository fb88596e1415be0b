// Which surface a mesh, or a part of one, was made from: cheap questions first, fits last, then the evidence.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/assess.h>

#include "shape.h"
#include "stages.h"

namespace darboux {

// For a fit that does not fit: what it came to, and why that is not enough. An affine map has so much freedom
// that it must fit better. \param limit the rms_relative up to which it would fit
std::string nearest_fit(const MeshFit& fit, double limit);

// How much may still be tried on one mesh, after what was tried on others of its file: a limit of time, and
// counts of parts that matched no surface.
class SearchBudget {
 public:
  // What parts that repeat have in common, wherever they lie: their shape in five numbers; uvs, normals.
  using Outline = std::array<std::size_t, 7>;

  explicit SearchBudget(const AssessOptions& options);
  SearchBudget(const SearchBudget&) = delete;
  SearchBudget& operator=(const SearchBudget&) = delete;
  bool spent() const;                            // the budget is; ask only where something would be left out
  bool cut_short() const { return cut_short_; }  // whether something was
  // Whether a part like it failed before: within this mesh alike in shape, in other meshes alike in uvs and
  // normals as well.
  bool has_failed(const Outline& outline) const;
  void failed(const Outline& outline);
  // Whether only cheap fits may be tried on a part; counts it where that is so.
  bool count_if_brief();
  std::size_t searched_briefly() const { return searched_briefly_; }
  // Only once, and not in a mesh that falls apart into islands of an atlas: there only kinds that are found
  // by positions are charted.
  bool may_search_affine(const Shape& shape);

 private:
  std::optional<std::chrono::steady_clock::time_point> until_;
  mutable bool cut_short_ = false;
  SearchHistory own_;
  SearchHistory& history_;
  std::size_t failed_before_;  // of these in other meshes
  std::size_t searched_briefly_ = 0;
  bool affine_searched_ = false;
  std::optional<bool> one_chart_;  // of what was looked at first
};

// Any surface of the catalogue, with evidence. \param placement held when given
// \param signs of its triangles, in the sense of triangle_signs()
// \param charted nothing but this kind, through uvs that are its own; nothing: any, by uvs, normals and
// positions
Recognition recognise(const Mesh& mesh, std::span<const signed char> signs,
                      const std::optional<Eigen::Isometry3d>& placement, SearchBudget& budget,
                      std::optional<std::string_view> charted = {});

}  // namespace darboux
