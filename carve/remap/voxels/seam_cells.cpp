#include "carve/remap/voxels/seam_cells.h"

#include <algorithm>
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
    const auto& columns = step.columns();
    clip(columns.axis(), step.start(), step.last());
    if (columns.around) once(columns.lateral_axis(), columns.laterals);
    else clip(columns.lateral_axis(), columns.first_lateral, columns.last_lateral());
    if (columns.closed) once(columns.slice_axis(), columns.slices);
    else clip(columns.slice_axis(), columns.first_slice, columns.last_slice());
    return vertices;
}

/// The corners of all cells that meet a box, borders included.
CoordBBox corners(const CarveStep& step, const BBoxd& range) {
    return within(step,
                  {Coord::ceil(range.min()).offsetBy(-1), Coord::floor(range.max()).offsetBy(1)});
}

/// The common displacement of all vertices of a box of a step's carved space, half vertices;
/// nothing if they differ.
/// @param vertices  not empty; along a closed axis across the carved one they may lie one turn off
std::optional<int> common_displacement(const CarveStep& step, const CoordBBox& vertices) {
    const auto& columns = step.columns();
    const int first = vertices.min()[step.axis()], last = vertices.max()[step.axis()];
    std::optional<int> out;
    for (int w = vertices.min()[step.slice_axis()]; w <= vertices.max()[step.slice_axis()]; ++w)
        for (int v = vertices.min()[step.lateral_axis()]; v <= vertices.max()[step.lateral_axis()];
             ++v) {
            const auto bounds = step.first_displaced(
                columns.index(columns.turned_lateral(v), columns.turned_slice(w)));
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
    const auto& columns = step.columns();
    for (auto at = vertices.begin(); at; ++at) {
        const auto column = columns.index(columns.turned_lateral((*at)[columns.lateral_axis()]),
                                          columns.turned_slice((*at)[columns.slice_axis()]));
        if (step.soft()->entry((*at)[step.axis()], column) != 0) return false;
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
