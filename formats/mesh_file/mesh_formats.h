#pragma once

#include "carve/mesh/mesh.h"
#include "formats/geometry_file/file_text.h"

namespace fluidcarve {

/// Messages about data that a reader left out or a writer could not write.
using Losses = std::vector<std::string>;

// Readers of the formats. @throws Failure (input) naming file, place and reason

Mesh read_obj(FileText& file, Losses& losses);
Mesh read_ply(FileText& file, Losses& losses);
Mesh read_off(FileText& file, Losses& losses);
Mesh read_stl(FileText& file, Losses& losses);

// Check only the header: whether the file has the format, and is large enough for the stated
// content.
// @throws Failure (input)
void probe_ply(FileText& file);
void probe_off(FileText& file);
void probe_stl(FileText& file);

// Writers: return the bytes of a file. @param points  position of each vertex in the file's space

std::string obj_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string ply_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string off_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string stl_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);

/// Checks that all corners refer to vertices of the mesh.
/// @throws Failure (input) naming the first face with a wrong corner
void require_vertices(const FileText& file, const Mesh& mesh);
/// Name of an attribute for messages: "UVs", "normals", "colours", or its name in quotes.
std::string to_text(const Mesh::Attribute& attribute);
/// Name for messages: "vertices", "faces" or "corners".
std::string to_text(Mesh::Attribute::On on);
/// Adds the message that an attribute is not written.
void lose(Losses& losses, const Mesh::Attribute& attribute, const std::string& why);
/// The mesh's lines if its file had this format. Else none, and adds a message if groups or
/// materials are lost.
const std::vector<Mesh::Line>& lines_for(const Mesh& mesh, const std::string& format,
                                         Losses& losses);

}  // namespace fluidcarve
