#pragma once

#include "nodes/mesh/mesh.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A mesh as its file has it, and what of the file it does not hold, in words.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> losses;
};

/// Reads .obj, .ply (text or binary), .off (text) and .stl (text or binary). Numbers of text are kept at double precision, OBJ's
/// UVs and normals per corner, PLY's properties under their own names. Only vertices of STL that stand at one place become one.
/// @throws Failure (input) with the file, the place in it and the reason: missing, a pipe, cut off, another format, a number that is
///   none or not finite, a face with a vertex that there is not
MeshFile read_mesh(const std::string& path);

/// Looks at the head of a file alone, as far as its format has one, and at the file's size. @throws Failure (input) as read_mesh
void probe_mesh(const std::string& path);

/// Writes the format that the path's ending names; a mesh of a file of that format as that file was. The file appears whole or
/// not at all.
/// @param placement  of a reader, to undo instead of the mesh's own; null: the mesh's own
/// @return what the format can't hold, in words
/// @throws Failure if the file can't be written
std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh, const Placement* placement = nullptr);

/// What keeps an ending from being one of a mesh file, or empty.
std::string ending_fault(const std::string& path);

}  // namespace fluidcarve
