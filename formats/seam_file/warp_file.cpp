#include "formats/seam_file/warp_file.h"

#include "carve/base/words.h"
#include "formats/seam_file/seam_metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

std::string warp_name(std::size_t n) { return fmt::format("warp.{:04}", n); }

CoordBBox points_box(const Warp& warp) {
    const auto& points = warp.points();
    return {Coord(0), Coord(points[0] - 1, points[1] - 1, points[2] - 1)};
}

/// The grids in the order of the frames.
std::vector<FloatGrid::ConstPtr> ordered(const Volume& volume, std::size_t frames) {
    if (volume.grids.size() != 1 && volume.grids.size() != frames)
        throw wrong_seams(
            fmt::format("there are {} grids, but a warp has one, or one for each of {} frames",
                        volume.grids.size(), frames));
    std::map<std::string, FloatGrid::ConstPtr> named;
    for (const auto& grid : volume.grids)
        named.emplace(grid->getName(), openvdb::GridBase::grid<FloatGrid>(grid));
    std::vector<FloatGrid::ConstPtr> out;
    for (std::size_t n = 0; n < volume.grids.size(); ++n) {
        const auto found = named.find(warp_name(n));
        if (found == named.end() || !found->second)
            throw wrong_seams(fmt::format(
                "there is no float grid '{}'; a warp of {} grids has '{}' to '{}'", warp_name(n),
                volume.grids.size(), warp_name(0), warp_name(volume.grids.size() - 1)));
        out.push_back(found->second);
    }
    return out;
}

/// Requires that each grid holds all points and nothing else, and that the warp takes little more
/// memory than the grids, which may hold very many points in a few tiles, or in a tree that they
/// share.
void require_points(const std::vector<FloatGrid::ConstPtr>& grids,
                    const std::array<int, 3>& points) {
    const auto count = static_cast<std::uint64_t>(points[0]) *
                       static_cast<std::uint64_t>(points[1]) *
                       static_cast<std::uint64_t>(points[2]);
    const CoordBBox wanted(Coord(0), Coord(points[0] - 1, points[1] - 1, points[2] - 1));
    std::set<const FloatGrid::TreeType*> trees;
    std::uint64_t held = 0;
    for (const auto& grid : grids) {
        if (!trees.insert(&grid->tree()).second) continue;
        held += grid->memUsage();
        if (const auto voxels = grid->activeVoxelCount();
            voxels != count || grid->evalActiveVoxelBoundingBox() != wanted)
            throw wrong_seams(
                fmt::format("grid '{}' has {} active voxels, but must have the {} points from (0, "
                            "0, 0) to ({}), by the shape and the factor",
                            grid->getName(), voxels, count, numbers_text(wanted.max())));
    }
    if (!fits_grids(count, grids.size(), sizeof(float), held))
        throw wrong_seams(
            fmt::format("the warp has {} points in each of {} grids, but these hold them in tiles "
                        "or shared trees of {} bytes; write each point of each grid as a voxel of "
                        "its own",
                        count, grids.size(), held));
}

void read_values(const FloatGrid& grid, const std::array<int, 3>& points, std::span<float> out) {
    const auto row = static_cast<std::size_t>(points[0]),
               slice = row * static_cast<std::size_t>(points[1]);
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        const auto box = value.getBoundingBox();
        if (!std::isfinite(*value))
            throw wrong_seams(fmt::format("grid '{}' has {} at ({}), which is not finite",
                                          grid.getName(), *value, numbers_text(box.min())));
        for (int k = box.min().z(); k <= box.max().z(); ++k)
            for (int lateral = box.min().y(); lateral <= box.max().y(); ++lateral)
                std::fill_n(
                    out.begin() +
                        static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * slice +
                                                    static_cast<std::size_t>(lateral) * row) +
                        box.min().x(),
                    box.dim().x(), *value);
    }
}

/// Requires that points of a column keep their order.
void require_rising(const Warp& warp, std::size_t t) {
    const auto& points = warp.points();
    const auto values = warp.values(t);
    for (std::size_t n = 0; n + 1 < values.size(); ++n) {
        const auto row = static_cast<std::size_t>(points[0]), u = n % row;
        if (u + 1 == row) continue;
        const int low = warp.vertex_of(0, static_cast<int>(u)),
                  high = warp.vertex_of(0, static_cast<int>(u) + 1);
        if (high + static_cast<double>(values[n + 1]) > low + static_cast<double>(values[n]))
            continue;
        throw wrong_seams(
            fmt::format("grid '{}' moves the point ({}, {}, {}) by {} vertices and the next along "
                        "u by {}: they would change places",
                        warp_name(t), u, n / row % static_cast<std::size_t>(points[1]),
                        n / row / static_cast<std::size_t>(points[1]), values[n], values[n + 1]));
    }
}

/// Requires a displacement that leaves the vertices within what a lattice may have.
void require_bounded(const Warp& warp) {
    const auto& [least, most] = warp.bounds().value;
    if (std::max(std::abs(least), std::abs(most)) > static_cast<float>(most_vertices))
        throw wrong_seams(
            fmt::format("the warp moves by {} to {} vertices, but a lattice has at most {}", least,
                        most, most_vertices));
}

}  // namespace

std::vector<VolumeGrid> grids_of_warp(const Warp& warp) {
    std::vector<VolumeGrid> out;
    const auto scale = static_cast<float>(warp.scale());
    for (std::size_t t = 0; t < warp.frames(); ++t) {
        const auto grid = FloatGrid::create();
        grid->setName(warp_name(t));
        auto values = grid->getAccessor();
        const auto from = warp.values(t);
        std::size_t n = 0;
        const auto box = points_box(warp);
        for (int k = 0; k <= box.max().z(); ++k)
            for (int lateral = 0; lateral <= box.max().y(); ++lateral)
                for (int u = 0; u <= box.max().x(); ++u)
                    values.setValueOn({u, lateral, k}, scale * from[n++]);
        out.push_back(grid);
    }
    return out;
}

Warp warp_of_grids(const Volume& volume, const Seams& seams, int factor) {
    const auto grids = ordered(volume, seams.frames.size());
    require_points(grids, Warp::points_of(seams.warp_vertices(), seams.warp_rings(), factor));
    Warp out(seams.warp_vertices(), seams.warp_rings(), factor, grids.size());
    for (std::size_t t = 0; t < grids.size(); ++t) {
        read_values(*grids[t], out.points(), out.values(t));
        require_rising(out, t);
    }
    out.find_bounds();
    require_bounded(out);
    if (const auto& [least, most] = out.bounds().first; seams.around && (least != 0 || most != 0))
        throw wrong_seams(
            fmt::format("the warp moves the rig, which the lattice goes around, by {} to {} "
                        "vertices; its values at u = 0 must be 0",
                        least, most));
    return out;
}

}  // namespace fluidcarve
