#pragma once

#include "carve/mesh/mesh.h"
#include "formats/file/provenance.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Writes a mesh as a .usda file with one UsdGeomMesh, not subdivided. Positions are those of the
/// shot's world. UVs, normals, colours and velocities become USD's own attributes, other
/// attributes primvars. The file appears whole or not at all.
/// @param placement  the placement to undo in positions; null: none
/// @param frame      the time of the mesh; nothing: it is the same at all times
/// @return messages about data that USD can't hold
/// @throws Failure if the file can't be written
std::vector<std::string> write_mesh_usda(const std::string& path, const Mesh& mesh,
                                         const Placement* placement, std::optional<int> frame,
                                         const Provenance& provenance);

}  // namespace fluidcarve
