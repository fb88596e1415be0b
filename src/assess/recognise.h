// Finds the surface that a mesh, or a part of one, was made from: cheap tests first, then fits, then the
// evidence.
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

// A text for a fit that is not good enough: what it reached, and why that is not enough. An affine map has so
// much freedom that it must fit better. \param limit the largest rms_relative that is accepted
std::string nearest_fit(const MeshFit& fit, double limit);

// The remaining budget for a mesh after the other meshes of its file: a time limit, and counts of parts that
// matched no surface.
class SearchBudget {
 public:
  // The common properties of repeated parts in any placement: five numbers for their shape, one each for uvs
  // and normals.
  using Outline = std::array<std::size_t, 7>;

  explicit SearchBudget(const AssessOptions& options);
  SearchBudget(const SearchBudget&) = delete;
  SearchBudget& operator=(const SearchBudget&) = delete;
  bool spent() const;  // whether time is up; call only if something would then be left out
  bool cut_short() const { return cut_short_; }  // whether something was left out
  // Whether a similar part failed before: in this mesh, one of the same shape; in other meshes, one with the
  // same shape, uvs and normals.
  bool has_failed(const Outline& outline) const;
  void failed(const Outline& outline);
  // Whether only cheap fits may be tried on a part; if so, counts the part.
  bool count_if_brief();
  std::size_t searched_briefly() const { return searched_briefly_; }
  // Whether to search affine maps of uvs: once per mesh, and never in a mesh whose uvs are islands of an
  // atlas. There, charts are fitted only for kinds that were found by positions.
  bool may_search_affine(const Shape& shape);

 private:
  std::optional<std::chrono::steady_clock::time_point> until_;
  mutable bool cut_short_ = false;
  SearchHistory own_;
  SearchHistory& history_;
  std::size_t failed_before_;  // of them in other meshes
  std::size_t searched_briefly_ = 0;
  bool affine_searched_ = false;
  std::optional<bool> one_chart_;  // of the first shape examined
};

// Recognises any surface of the catalogue, with evidence. \param placement fixed if given
// \param signs of its triangles, in the sense of triangle_signs()
// \param charted try only this kind, through its own uvs; none: any kind, by uvs, normals and positions
Recognition recognise(const Mesh& mesh, std::span<const signed char> signs,
                      const std::optional<Eigen::Isometry3d>& placement, SearchBudget& budget,
                      std::optional<std::string_view> charted = {});

}  // namespace darboux
