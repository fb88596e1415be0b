// any_surface.cpp compiles what an AnySurface holds of each surface of the catalogue: a second and more each.
// A source that makes one says so, and takes that: DARBOUX_COMPILED_MODEL(Torus<>)
#pragma once

#include <darboux/any_surface.h>

#define DARBOUX_COMPILED_MODEL(Surface) extern template struct darboux::AnySurface::Model<Surface>;
