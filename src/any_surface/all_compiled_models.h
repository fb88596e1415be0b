// compiled_models.h for the whole catalogue.
#pragma once

#include "compiled_models.h"
#include "evaluate/kernels/index_in_catalogue.h"
#include "kernel_list.h"

#define DARBOUX_COMPILED_MODEL_OF(header) DARBOUX_COMPILED_MODEL(DARBOUX_SURFACE_OF(header))
DARBOUX_FOR_EACH_SURFACE_HEADER(DARBOUX_COMPILED_MODEL_OF)
