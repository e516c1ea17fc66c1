#pragma once

#include "carve/seam/seams.h"
#include "formats/file/provenance.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// The curves of one seam in one frame: lines along its surface.
struct SeamCurves {
    std::vector<openvdb::Vec3d> vertices;             ///< world positions
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< pairs of indices in `vertices`
    std::array<std::uint8_t, 3> colour{};             ///< sRGB
};

/// The curves of all seams in a frame, in the order of finding. The two seams of a pair follow
/// each other, in the same colour. They lie at the seams' places in the uncarved lattice: at
/// removed vertices, or half a vertex behind doubled ones.
/// @param every  distance of neighbouring curves along the lateral dimension and along w, vertices,
///   at least 1; the last one always has a curve
/// @throws Failure as CarveMap: another lattice, another shape, or no such frame
std::vector<SeamCurves> seam_curves(const Lattice& lattice, const Seams& seams, int frame,
                                    const std::array<int, 2>& every);

/// Writes curves, whole or not at all: as PLY, binary, vertices and edges with colours, or as OBJ,
/// an object of lines for each seam.
/// @param path  ends in .ply or .obj
/// @throws Failure if the file can't be written
void write_seam_curves(const std::string& path, const std::vector<SeamCurves>& curves,
                       const Provenance& provenance = {});

}  // namespace fluidcarve
