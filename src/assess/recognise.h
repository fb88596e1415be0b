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

// What may still be tried on a mesh, given what was tried on the other meshes of its file: a time limit, and
// counts of parts that matched no surface.
class SearchBudget {
 public:
  // What repeated parts have in common, wherever they lie: five numbers for their shape, one each for uvs and
  // normals.
  using Outline = std::array<std::size_t, 7>;

  explicit SearchBudget(const AssessOptions& options);
  SearchBudget(const SearchBudget&) = delete;
  SearchBudget& operator=(const SearchBudget&) = delete;
  bool spent() const;                            // time is up; ask only where something would be left out
  bool cut_short() const { return cut_short_; }  // whether something was left out
  // Whether a similar part failed before: in this mesh, one of the same shape; in other meshes, one of the
  // same shape, uvs and normals.
  bool has_failed(const Outline& outline) const;
  void failed(const Outline& outline);
  // Whether only cheap fits may be tried on a part; if so, counts the part.
  bool count_if_brief();
  std::size_t searched_briefly() const { return searched_briefly_; }
  // Whether affine maps of uvs may be searched: once per mesh, and never in a mesh that falls apart into
  // islands of an atlas, where only kinds that are found by positions are charted.
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
