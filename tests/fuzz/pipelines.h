#pragma once

#include <string>

namespace fuzz {

/// Pipelines that take a harmful file through what a user would do with it. Each reads one file of
/// its folder and writes there.

/// The end of pipelines that carve: a lattice around a float field, an energy, one seam out of a
/// volume.
/// @param field   node or output with the field
/// @param volume  node or output with the volume
inline std::string carve(const std::string& field, const std::string& volume) {
    return "  energy: {type: energy.gradient, field: " + field +
           "}\n  box: {type: lattice.box, fit: " + field +
           "}\n  seams: {type: seam.greedy, energy: energy, field: " + field +
           ", lattice: box, count: -1}\n  carved: {type: remap.grids, source: " + volume +
           ", lattice: box, seams: seams}\n";
}

/// Carves a VDB file and shows it. @param grid  a grid of the file  @param type  float or vector
inline std::string volume_pipeline(const std::string& grid, const std::string& type) {
    const bool vector = type == "vector";
    return "fluidcarve: 1\nnodes:\n  in: {type: vdb.read, path: in.vdb, grids: {field: {name: \"" +
           grid + "\", type: " + type + "}}}\n" +
           (vector ? "  size: {type: field.magnitude, vectors: in.field}\n" : "") +
           carve(vector ? "size" : "in.field", "in") +
           "  out: {type: vdb.write, source: carved, path: out.vdb}\n  sheet: {type: "
           "preview.sheet, before: in, after: carved, grid: \"" +
           grid + "\", path: sheet.png}\n";
}

/// Reads all of a VDB file and writes it.
inline std::string copy_pipeline() {
    return "fluidcarve: 1\nnodes:\n  in: {type: vdb.read, path: in.vdb}\n  out: {type: vdb.write, "
           "source: in, path: out.vdb}\n";
}

/// A sphere of smoke beside which the other files of a pipeline stand.
/// @param data  the folder of test data
inline std::string smoke_of(const std::string& data) {
    return "fluidcarve: 1\nnodes:\n  smoke: {type: vdb.read, path: \"" + data +
           "/vdb/gaffer_arnold_sphere.vdb\", grids: {density: float}}\n";
}

/// Carves points by the seams of a sphere of smoke. @param ending  of the file of points
inline std::string points_pipeline(const std::string& data, const std::string& ending) {
    return smoke_of(data) + carve("smoke.density", "smoke") + "  in: {type: points.read, path: in" +
           ending +
           "}\n  moved: {type: remap.points, source: in, lattice: box, seams: seams}\n  out: "
           "{type: points.write, source: moved, path: out" +
           ending + "}\n";
}

/// Carves smoke by the seams of a file.
/// @param smoke  path of the volume in which the seams were found
/// @param grid  of it
inline std::string seams_pipeline(const std::string& smoke, const std::string& grid) {
    return "fluidcarve: 1\nnodes:\n  smoke: {type: vdb.read, path: \"" + smoke + "\", grids: {" +
           grid + ": float}}\n  box: {type: lattice.box, fit: smoke." + grid +
           "}\n  in: {type: seams.read, path: in.vdb}\n"
           "  carved: {type: remap.grids, source: smoke, lattice: box, seams: in}\n  out: {type: "
           "vdb.write, source: carved, path: out.vdb}\n"
           "  again: {type: seams.write, seams: in, path: again.vdb}\n";
}

/// Reads an image and writes it. @param ending  of its file
inline std::string image_pipeline(const std::string& ending, const std::string& to) {
    return "fluidcarve: 1\nnodes:\n  in: {type: image.read, path: in" + ending +
           "}\n  energy: {type: energy.image, source: in}\n  out: {type: image.write, source: in, "
           "path: out" +
           to + "}\n";
}

/// Reads a mesh and writes it. @param ending  of its file
inline std::string mesh_pipeline(const std::string& ending, const std::string& to) {
    return "fluidcarve: 1\nnodes:\n  in: {type: mesh.read, path: in" + ending +
           "}\n  out: {type: mesh.write, source: in, path: out" + to + "}\n";
}

/// Builds a lattice along a curve. @param ending  of its file
inline std::string curve_pipeline(const std::string& ending) {
    return "fluidcarve: 1\nnodes:\n  in: {type: rig.curve, path: in" + ending +
           "}\n  lattice: {type: lattice.build, rig: in, spacing: 0.2, extent_u: [-0.4, 0.4], "
           "extent_v: [-0.4, 0.4], max_iterations: 20}\n"
           "  out: {type: lattice.write, lattice: lattice, path: out.obj}\n";
}

}  // namespace fuzz
