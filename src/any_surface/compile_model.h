// Compiles the code behind an AnySurface for one surface of the catalogue; see compiled_models.h. CMake
// generates sources that expand DARBOUX_COMPILE_MODEL for the headers of surfaces/.
#pragma once

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>

#include "evaluate/kernels/index_in_catalogue.h"

#define DARBOUX_COMPILE_MODEL(header) template struct darboux::AnySurface::Model<DARBOUX_SURFACE_OF(header)>;
