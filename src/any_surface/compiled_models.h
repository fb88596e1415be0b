// What an AnySurface holds of a surface of the catalogue takes a second and more to compile. Sources that
// CMake writes compile it, by compile_model.h; a source that makes one says so, and takes that:
// DARBOUX_COMPILED_MODEL(Torus<>)
#pragma once

#include <darboux/any_surface.h>

#define DARBOUX_COMPILED_MODEL(Surface) extern template struct darboux::AnySurface::Model<Surface>;
