// The code behind an AnySurface takes a second or more per surface of the catalogue to compile. Generated
// sources compile it once (compile_model.h). A source that makes an AnySurface uses that code by saying:
// DARBOUX_COMPILED_MODEL(Torus<>)
#pragma once

#include <darboux/any_surface.h>

#define DARBOUX_COMPILED_MODEL(Surface) extern template struct darboux::AnySurface::Model<Surface>;
