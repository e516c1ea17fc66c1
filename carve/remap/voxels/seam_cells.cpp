#include "carve/remap/voxels/seam_cells.h"

#include <algorithm>
#include <array>
#include <optional>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

CoordBBox within(const CarveStep& step, CoordBBox vertices) {
    auto &low = vertices.min(), &high = vertices.max();
    const auto clip = [&](int dimension, int first, int last) {
        low[dimension] = std::max(low[dimension], first);
        high[dimension] = std::min(high[dimension], last);
    };
    const auto once = [&](int dimension, int size) {
        high[dimension] = std::min(high[dimension], low[dimension] + size - 1);
    };
    clip(step.axis(), step.start(), step.last());
    if (step.around()) once(step.lateral_axis(), step.laterals());
    else clip(step.lateral_axis(), step.first_lateral(), step.last_lateral());
    if (step.closed()) once(step.slice_axis(), step.slices());
    else clip(step.slice_axis(), step.first_slice(), step.last_slice());
    return vertices;
}

/// The corners of all cells that meet a box, borders included.
CoordBBox corners(const CarveStep& step, const BBoxd& range) {
    return within(step,
                  {Coord::ceil(range.min()).offsetBy(-1), Coord::floor(range.max()).offsetBy(1)});
}

/// The column at a vertex: its lateral index, and its slice.
std::array<int, 2> column_at(const CarveStep& step, int lateral, int slice) {
    return {step.around() ? (lateral + step.laterals()) % step.laterals() : lateral,
            step.closed() ? (slice + step.slices()) % step.slices() : slice};
}

/// The common displacement of all vertices of a box of a step's carved space, half vertices;
/// nothing if they differ.
/// @param vertices  not empty; along a closed axis across the carved one they may lie one turn off
std::optional<int> common_displacement(const CarveStep& step, const CoordBBox& vertices) {
    const int first = vertices.min()[step.axis()], last = vertices.max()[step.axis()];
    std::optional<int> out;
    for (int w = vertices.min()[step.slice_axis()]; w <= vertices.max()[step.slice_axis()]; ++w)
        for (int v = vertices.min()[step.lateral_axis()]; v <= vertices.max()[step.lateral_axis()];
             ++v) {
            const auto [lateral, slice] = column_at(step, v, w);
            const auto bounds = step.first_displaced(lateral, slice);
            const auto passed = CarveStep::passed(first, bounds);
            const int displacement = step.displacement(first, passed, bounds);
            if (out.value_or(displacement) != displacement ||
                CarveStep::passed(last, bounds) != passed ||
                step.displacement(last, passed, bounds) != displacement)
                return std::nullopt;
            out = displacement;
        }
    return out;
}

/// Whether no vertex of a box of a step's carved space is displaced.
bool stays(const CarveStep& step, const CoordBBox& vertices) {
    if (!step.soft()) return common_displacement(step, vertices) == 0;
    for (auto at = vertices.begin(); at; ++at) {
        const auto [lateral, slice] =
            column_at(step, (*at)[step.lateral_axis()], (*at)[step.slice_axis()]);
        if (step.soft()->entry((*at)[step.axis()], lateral, slice) != 0) return false;
    }
    return true;
}

}  // namespace

bool along_seam(const CarveMap& map, Vec3d at) {
    for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step) {
        if (!step->holds(at)) continue;
        if (!step->carves(at, 1)) return false;
        const auto displacement = common_displacement(*step, corners(*step, {at, at}));
        if (!displacement) return true;
        // A whole number of vertices: an inserted entry, half a vertex off, differs from its
        // neighbours.
        const int whole = *displacement / 2;
        at[step->axis()] += whole;
    }
    return false;
}

bool may_hold_seam(const CarveMap& map, BBoxd range) {
    if (range.empty()) return false;
    for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step) {
        const auto vertices = corners(*step, range);
        if (vertices.empty()) continue;
        const auto displacement = common_displacement(*step, vertices);
        if (!displacement) return true;
        // Points outside the step's lattice stay.
        const int axis = step->axis(), by = *displacement / 2;
        (by < 0 ? range.min() : range.max())[axis] += by;
    }
    return false;
}

bool is_moved(const CarveMap& map, const Vec3d& at) {
    for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step) {
        if (!step->holds(at)) continue;
        if (!step->carves(at, 1)) {
            if (step->frees(at)) return true;
            continue;
        }
        if (!stays(*step, within(*step, {Coord::floor(at), Coord::ceil(at)}))) return true;
    }
    return false;
}

}  // namespace fluidcarve
