#pragma once

#include "nodes/lattice/mapping.h"
#include "nodes/points/points.h"
#include "nodes/seams/carve_map.h"

namespace fluidcarve {

/// Where a point of a step's lattice goes (METHOD 6), by the carved axis alone: no place if a removal takes it, or an
/// insertion writes over it; several if seams are inserted where it is. A removed seam takes what is nearer to it than half a
/// vertex; what an inserted seam adds is a copy of all between the doubled entry and the next. Seams are interpolated
/// bilinearly between columns. Points that the step does not hold stay.
/// With a fade, a seam takes and adds by CarveStep::scale less.
/// @param at      lattice index coordinates
/// @param places  becomes the coordinates along the axis, the point itself first
/// @param rooms   becomes for each the interval along the axis that a copy may be anywhere in, without leaving its seam
void carve_point(const CarveStep& step, const openvdb::Vec3d& at, std::vector<double>& places, std::vector<openvdb::Vec2d>& rooms);

/// Vertices by which copies are moved at most.
constexpr double default_jitter = 0.25;

/// What became of the points of a list: `points - deleted + copied` are left.
struct CarvedPoints {
    std::size_t moved = 0, deleted = 0, copied = 0;
    std::vector<PointImage> images;
    /// Whether anything did.
    bool changed() const { return moved + deleted + copied > 0; }
};

/// Carves points through all steps of a map, each in the space that those before it leave. Through a smoothed one each point goes where its
/// place goes, and is thinned or doubled by as much as space is pressed together or drawn out there. Copies are moved by up to `jitter` vertices
/// along each of the lattice's axes, within their seam: by the point's identity alone, whatever the order or number of threads.
/// @param positions, identities  of each point
/// @param jitter  0: a copy is exactly one vertex away
CarvedPoints carve_points(const std::vector<openvdb::Vec3d>& positions, const std::vector<std::uint64_t>& identities, const Lattice& lattice,
                          const CarveMap& map, double jitter);

}  // namespace fluidcarve
