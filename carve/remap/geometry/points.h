#pragma once

#include "carve/lattice/mapping.h"
#include "carve/points/points.h"
#include "carve/seam/carve_map.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

/// Finds the places of a point after a step, along the carved axis (METHOD 6). There is none if a
/// removal takes the point or an insertion overwrites it, and several if seams are inserted there.
/// A removed seam takes all points from half a vertex below it up to half a vertex above. An
/// inserted seam adds a copy of all points from the doubled entry up to the next. The upper ends
/// do not belong to these intervals. Seams are interpolated bilinearly between columns.
/// Points outside CarveStep::holds() stay.
/// Where the rim fades, a seam takes and adds less, by the factor CarveStep::rim_scale.
/// @param at      lattice index coordinates
/// @param places  becomes the coordinates along the axis, the point itself first
/// @param rooms   becomes, for each place, the interval along the axis in which a copy stays inside
///   its seam
void carve_point(const CarveStep& step, const openvdb::Vec3d& at, std::vector<double>& places,
                 std::vector<openvdb::Vec2d>& rooms);

/// Largest random displacement of a copy, vertices.
constexpr double default_jitter = 0.25;

/// The result of carving a list of points; `points - deleted + copied` are left.
struct CarvedPoints {
    std::size_t moved = 0, deleted = 0, copied = 0;
    std::vector<PointImage> images;
    /// Whether any point was moved, deleted or copied.
    bool changed() const { return moved + deleted + copied > 0; }
};

/// Carves points through all steps of a map, each in the space that the steps before leave. Under a
/// smoothed map, each point moves with its place, and points are thinned or doubled as space is
/// compressed or stretched there. Copies are displaced at random by up to `jitter` vertices along
/// each lattice axis, within their seam. The displacement depends on the point's identity alone,
/// not on the order or the number of threads.
/// @param positions   world units
/// @param identities  of each point
/// @param jitter      vertices; 0: a copy is exactly one vertex away
CarvedPoints carve_points(const std::vector<openvdb::Vec3d>& positions,
                          const std::vector<std::uint64_t>& identities, const Lattice& lattice,
                          const CarveMap& map, double jitter);

}  // namespace fluidcarve
