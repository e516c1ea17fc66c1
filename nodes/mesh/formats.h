#pragma once

#include "nodes/mesh/file_text.h"
#include "nodes/mesh/mesh.h"

namespace fluidcarve {

/// What a reader left out or a writer could not hold, in words, one each.
using Losses = std::vector<std::string>;

// Each reads one format. @throws Failure (input) with file, place and reason if it can't be kept as it is

Mesh read_obj(FileText& file, Losses& losses);
Mesh read_ply(FileText& file, Losses& losses);
Mesh read_off(FileText& file, Losses& losses);
Mesh read_stl(FileText& file, Losses& losses);

/// Looks at the head alone: that the file is of the format, and large enough for what it promises.
void probe_ply(FileText& file);
void probe_off(FileText& file);
void probe_stl(FileText& file);

// Each gives a file's bytes. @param points  positions in the file's space

std::string obj_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string ply_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string off_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);
std::string stl_text(const Mesh& mesh, const std::vector<openvdb::Vec3d>& points, Losses& losses);

/// @throws Failure (input) naming the first face with a corner that is no vertex
void require_vertices(const FileText& file, const Mesh& mesh);
/// "UVs", "normals", "colours", or the name in quotes.
std::string text_of(const Mesh::Attribute& attribute);
/// "vertices", "faces" or "corners".
std::string text_of(Mesh::Attribute::On on);
/// What full light is in colours of this type: an integer's maximum, or 1.
double full_light(Mesh::Attribute::Type type);
/// Says that an attribute, or all lines of another format's file, are not written.
void lose(Losses& losses, const Mesh::Attribute& attribute, const std::string& why);
/// The mesh's lines if its file was of this format; says that groups and materials of another are not written.
const std::vector<Mesh::Line>& lines_for(const Mesh& mesh, const std::string& format, Losses& losses);

}  // namespace fluidcarve
