// A glTF file before and after add_tangents().
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <darboux/file_tangents.h>
#include <darboux/io.h>

#include "generated_gltf.h"
#include "gltf_corners.h"

namespace darboux::test {

using Made = std::vector<std::pair<std::size_t, std::size_t>>;

/// What became of a file.
struct Rewritten {
  FileTangents report;
  Glb before, after;
  Made made() const {
    Made result;
    for (const PrimitiveTangents& p : report.primitives) result.emplace_back(p.mesh, p.primitive);
    return result;
  }
};

inline Rewritten rewrite(const std::string& path, const FileTangentOptions& options = {}) {
  const TempFolder folder;
  GltfDocument document = GltfDocument::load(path);
  Rewritten result;
  result.report = add_tangents(document, options);
  document.save_glb(folder / "out.glb");
  result.before = split_glb(read_bytes(path));
  result.after = split_glb(read_bytes(folder / "out.glb"));
  return result;
}

inline Rewritten rewrite(const Builder& builder, const FileTangentOptions& options = {}) {
  const TempFolder folder;
  return rewrite(write_bytes(folder / "in.glb", builder.glb()), options);
}

}  // namespace darboux::test
