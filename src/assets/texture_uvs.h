/// \file texture_uvs.h
/// The uvs at which a texture is read.
#pragma once

#include <darboux/io.h>

namespace darboux {

/// Applies the KHR_texture_transform of a primitive to the uvs of a mesh like its own. A transform that maps
/// them onto a line or a point leaves them no direction; it is not applied.
void transform_uvs(Mesh& mesh, const Primitive& primitive);

}  // namespace darboux
