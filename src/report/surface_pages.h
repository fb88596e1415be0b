/// \file surface_pages.h
/// The pages of the catalogue in docs/surfaces.
#pragma once

#include <string>
#include <vector>

namespace darboux {

/// A file in the folder of the pages.
struct PageFile {
  std::string name, content;
};

/// NAME.md and NAME.svg for each surface of the catalogue, and README.md, the index. The content of a page
/// comes from the surface itself and from its header as it was when the tool was built: the comment above the
/// type, in which indented lines are formulas, and those above the facts. Source keys are looked up in
/// docs/references.bib. The bytes depend on nothing else. \throws Error naming a surface whose header has no
/// such comment, or a source key without an entry
std::vector<PageFile> surface_pages();

}  // namespace darboux
