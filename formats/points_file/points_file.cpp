#include "formats/points_file/points_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/points/point_grid.h"
#include "carve/stream/openvdb_types.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/points_file/ply.h"
#include "formats/vdb/conventions.h"
#include "formats/vdb/provenance_metadata.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {
namespace {

using openvdb::Vec3d;

/// Index of the point grid in the header.
std::size_t point_grid_index(const VdbHeader& header, const std::string& name) {
    const auto is_points = [](const VdbHeader::Entry& grid) {
        return grid.type == point_grid_type;
    };
    if (!name.empty()) {
        const auto place = header.place(name);
        if (is_points(header.grids[place])) return place;
        throw Failure(fmt::format("{}: grid '{}' holds no points, it is of type {}", header.path,
                                  name, header.grids[place].type),
                      Failure::Kind::input);
    }
    const auto found = std::ranges::find_if(header.grids, is_points);
    const auto known = header.names();
    if (found == header.grids.end())
        throw Failure(
            fmt::format("{} has no points; it has {}", header.path,
                        known.empty() ? "no grids" : fmt::format("{}", fmt::join(known, ", "))),
            Failure::Kind::input);
    if (const auto next = std::find_if(found + 1, header.grids.end(), is_points);
        next != header.grids.end())
        throw Failure(
            fmt::format("{} has several grids with points, '{}' and '{}': say which with 'grid:'",
                        header.path, found->unique_name, next->unique_name),
            Failure::Kind::input);
    return static_cast<std::size_t>(found - header.grids.begin());
}

void require_no_name(const std::string& path, const std::string& grid) {
    if (!grid.empty())
        throw Failure(
            fmt::format("{} is a PLY file, which has no grid '{}'; leave 'grid' out", path, grid),
            Failure::Kind::input);
}

Vec3d offset_of(const openvdb::GridBase& grid) {
    const auto stored = stored_form_of(grid);
    return stored ? stored->placement.offset : Vec3d(0);
}

/// A volume with the points' grid and those beside it.
Volume together(const Points& points, const openvdb::GridBase::ConstPtr& grid,
                const Volume* beside) {
    Volume out;
    out.metadata = points.metadata;
    out.codec = points.codec;
    if (beside) {
        out.grids = beside->grids;
        if (!beside->codec.empty()) out.codec = beside->codec;
        for (auto each = beside->metadata.beginMeta(); each != beside->metadata.endMeta(); ++each) {
            out.metadata.removeMeta(each->first);
            out.metadata.insertMeta(each->first, *each->second);
        }
    }
    const auto same = [&](const auto& each) {
        return is_point_grid(each.header()) && each.name() == grid->getName();
    };
    const auto found = std::ranges::find_if(out.grids, same);
    if (found == out.grids.end()) {
        out.grids.push_back(grid);
        return out;
    }
    if (std::find_if(found + 1, out.grids.end(), same) != out.grids.end())
        throw Failure(
            fmt::format("'beside' has several grids of points '{}', and which of them to replace "
                        "can't be told: write the points to a file of their own",
                        grid->getName()));
    *found = grid;
    return out;
}

}  // namespace

Points read_points(const std::string& path, const std::string& grid, PointOffset offset,
                   const Placement& placement) {
    Points out;
    if (is_ply(path)) {
        require_no_name(path, grid);
        out.ply = std::make_shared<PointTable>(read_ply(path));
        out.placement = placement;
        return out;
    }
    VdbFile file(path);
    const auto& header = file.header();
    const auto place = point_grid_index(header, grid);
    const auto found = file.read(place);
    require_sound(*found, path);
    auto by = placement;
    const auto* const from = detected_conventions(header);
    if (offset == PointOffset::half_voxel ||
        (offset == PointOffset::detect && from && from->points_off))
        by.offset = Vec3d(-0.5);
    out.grid = placed(found, by);
    out.metadata = header.metadata;
    out.codec = header.grids[place].codec;
    return out;
}

void probe_points(const std::string& path, const std::string& grid) {
    if (is_ply(path)) {
        require_no_name(path, grid);
        read_ply_header(path);
    } else {
        point_grid_index(read_vdb_header(path), grid);
    }
}

PointLosses write_points(const std::string& path, const Points& points, const Volume* beside,
                         const NumberForm* encoding, const Placement* placement,
                         const Provenance& provenance) {
    PointLosses out;
    if (ending_of(path) != ".ply") {
        const auto grid = in_grid(points);
        auto volume = together(points, grid, beside);
        set_provenance(volume.metadata, provenance);
        const auto* const seen_as =
            detected_conventions(write_vdb(path, volume, Codec::as_read, placement));
        const bool off = !offset_of(*grid).isZero(), seen_off = seen_as && seen_as->points_off;
        if (off != seen_off) out.offset = off ? "half_voxel" : "none";
        return out;
    }
    auto ply = points.ply ? *points.ply
                          : ply_of(*placed(unplaced(points.grid, placement),
                                           {Vec3d(0), 1, offset_of(*points.grid)}),
                                   out.attributes);
    if (points.ply && placement && *placement != points.placement)
        for (std::size_t n = 0; n < ply.size; ++n)
            ply.set_position(n, (points.placement.scale * ply.position(n) +
                                 points.placement.translate - placement->translate) /
                                    placement->scale);
    if (encoding) ply.encoding = *encoding;
    std::erase_if(ply.comments, is_provenance_comment);
    const auto comments = provenance_comments(provenance, ply_comment);
    ply.comments.insert(ply.comments.begin(), comments.begin(), comments.end());
    write_ply(path, ply);
    return out;
}

}  // namespace fluidcarve
