/// \file texture_uvs.h
/// The uvs at which a texture is read.
#pragma once

#include <darboux/io.h>

namespace darboux {

/// Applies the KHR_texture_transform of a primitive to the uvs of a mesh like its own. A transform that maps
/// them onto a line or a point is not applied, since it would leave no direction.
void transform_uvs(Mesh& mesh, const Primitive& primitive);

}  // namespace darboux
