// Where a mesh passes through itself: edges that pierce triangles with which they share no vertex.
#pragma once

#include "renderer/scene/uv_mesh.h"

namespace renderer {

int self_crossings(const UvMesh& mesh);

}  // namespace renderer
