#pragma once

#include "carve/mesh/mesh.h"
#include "formats/file/provenance.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A mesh read from a file, and messages about data of the file that the mesh does not hold.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> losses;
};

/// Reads .obj, .ply (text or binary), .off (text) and .stl (text or binary). Numbers in text files
/// are read as doubles, OBJ's UVs and normals are on corners, PLY's properties keep their names.
/// Vertices are merged in STL only, if their positions are equal.
/// @throws Failure (input) naming the file, the place in it and the reason: missing, a pipe,
///   truncated, another format, a number that is invalid or not finite, a face with a vertex that
///   does not exist
MeshFile read_mesh(const std::string& path);

/// Checks only the header of a file, if its format has one, and the file's size.
/// @throws Failure (input) as read_mesh
void probe_mesh(const std::string& path);

/// Writes a mesh in the format of the path's extension. A mesh read from a file of that format is
/// written as it was. The file appears whole or not at all.
/// @param placement  the placement to undo; null: that of the mesh's stored form
/// @param provenance  what the file states of how it was made, as comments in OBJ and PLY; OFF and
///   STL state nothing
/// @return messages about data that the format can't hold
/// @throws Failure if the file can't be written
std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh,
                                    const Placement* placement = nullptr,
                                    const Provenance& provenance = {});

/// The extensions of all mesh formats: ".obj", ".ply", ...
std::vector<std::string> all_mesh_endings();

/// Why a path's extension is not that of a mesh file; empty if it is.
std::string ending_fault(const std::string& path);

}  // namespace fluidcarve
