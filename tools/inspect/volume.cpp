#include "tools/inspect/volume.h"

#include "carve/base/one_line.h"
#include "carve/volume/grid_types.h"
#include "formats/vdb/conventions.h"
#include "tools/inspect/facts.h"
#include "tools/inspect/oddities.h"

#include <fmt/format.h>

#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;
using openvdb::GridBase;
using openvdb::points::PointDataGrid;

/// Range of a grid's active values; for vectors, of their lengths.
struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    std::size_t not_finite = 0;
    openvdb::Coord first_not_finite;

    void add(double value, const openvdb::Coord& at) {
        if (std::isfinite(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        } else if (not_finite++ == 0) {
            first_not_finite = at;
        }
    }
};

template <class GridT>
void span(const GridT& grid, Range& out) {
    if constexpr (!std::is_same_v<GridT, openvdb::MaskGrid>)
        for (auto value = grid.cbeginValueOn(); value; ++value) {
            if constexpr (openvdb::VecTraits<typename GridT::ValueType>::IsVec)
                out.add(openvdb::Vec3d(*value).length(), value.getCoord());
            else out.add(static_cast<double>(*value), value.getCoord());
        }
}

Range range_of(const GridBase& grid) {
    Range out;
#define FLUIDCARVE_SPAN(GridT) \
    if (grid.isType<GridT>()) span(static_cast<const GridT&>(grid), out);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_SPAN)
#undef FLUIDCARVE_SPAN
    return out;
}

/// Number of points, and names and types of their attributes.
Json points_of(const PointDataGrid& grid) {
    Json out{{"count", 0}, {"attributes", Json::object()}};
    std::uint64_t count = 0;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) count += leaf->pointCount();
    out["count"] = count;
    if (const auto leaf = grid.tree().cbeginLeaf()) {
        const auto& descriptor = leaf->attributeSet().descriptor();
        for (const auto& [name, place] : descriptor.map())
            out["attributes"][one_line(name)] =
                descriptor.type(place).first + " " + descriptor.type(place).second;
    }
    return out;
}

Json list(const openvdb::Coord& at) { return {at.x(), at.y(), at.z()}; }

Json metadata_of(const openvdb::MetaMap& map) {
    auto out = Json::object();
    for (auto entry = map.beginMeta(); entry != map.endMeta() && out.size() < most_metadata;
         ++entry)
        out[one_line(entry->first)] = one_line(entry->second->str());
    return out;
}

Json grid_json(const GridBase& grid, const std::string& unique_name) {
    const auto& transform = grid.transform();
    Json out{{"name", one_line(unique_name)},
             {"type", grid.valueType()},
             {"tree", one_line(grid.type())},
             {"class", GridBase::gridClassToString(grid.getGridClass())},
             {"half", grid.saveFloatAsHalf()},
             {"active_voxels", grid.activeVoxelCount()},
             {"memory_bytes", grid.memUsage()},
             {"transform",
              {{"map", transform.mapType()},
               {"voxel_size", facts_of(transform.voxelSize())},
               {"origin", facts_of(transform.indexToWorld(openvdb::Vec3d(0)))}}}};
    if (const auto box = grid.evalActiveVoxelBoundingBox(); !box.empty()) {
        out["box"] = {list(box.min()), list(box.max())};
        out["world_box"] = facts_of(transform.indexToWorld(
            openvdb::BBoxd(box.min().asVec3d() - 0.5, box.max().asVec3d() + 0.5)));
    }
    const auto range = range_of(grid);
    if (range.low <= range.high) out["range"] = {range.low, range.high};
    if (range.not_finite > 0) {
        out["not_finite"] = range.not_finite;
        out["first_not_finite"] = list(range.first_not_finite);
    }
    if (grid.isType<PointDataGrid>())
        out["points"] = points_of(static_cast<const PointDataGrid&>(grid));
    out["metadata"] = metadata_of(grid);
    return out;
}

Json look(const std::string& path) {
    VdbFile from(path);
    const auto& header = from.header();
    const auto volume = from.read();
    const auto* const conventions = detected_conventions(header);
    Json out{{"file", path},
             {"kind", "volume"},
             {"bytes", std::filesystem::file_size(path)},
             {"version", header.version},
             {"compression", volume.codec}};
    out["profile"] = conventions ? Json(conventions->name) : Json(nullptr);
    out["metadata"] = metadata_of(volume.metadata);
    out["grids"] = Json::array();
    for (std::size_t n = 0; n < volume.grids.size(); ++n)
        out["grids"].push_back(grid_json(volume.grids[n].header(), header.grids[n].unique_name));
    Oddities oddities;
    note_volume(volume, header, out["grids"], conventions, oddities);
    out["oddities"] = oddities.lines();
    return out;
}

/// Voxel size and domain, which all frames of a sequence must share: "voxels of 0.1, 0.1, 0.1 in a
/// domain of [20, 20, 40]".
std::string space_text(const Json& grid) {
    const auto& size = grid["transform"]["voxel_size"];
    const auto domain = grid["metadata"].value("file_base_resolution", std::string());
    return fmt::format("voxels of {:.6g}, {:.6g}, {:.6g}{}", size[0].get<double>(),
                       size[1].get<double>(), size[2].get<double>(),
                       domain.empty() ? "" : " in a domain of " + domain);
}

/// Finds grids whose place or voxel size changes between files.
std::vector<std::string> compare(const std::vector<Json>& files) {
    /// Grid name to the first file with it, and the grid.
    std::map<std::string, std::pair<std::string, const Json*>> first;
    Oddities out;
    std::set<std::string> told;
    for (const auto& file : files)
        for (const auto& grid : file["grids"]) {
            const auto name = grid["name"].get<std::string>();
            const auto [place, is_new] =
                first.try_emplace(name, file["file"].get<std::string>(), &grid);
            const auto& [other_file, other] = place->second;
            if (is_new || told.contains(name) ||
                ((*other)["transform"] == grid["transform"] &&
                 space_text(*other) == space_text(grid)))
                continue;
            told.insert(name);
            out.add(fmt::format("{} in {}, but {} in {}: if these are frames of one sequence, its "
                                "domain is adaptive, and no lattice fits",
                                space_text(*other), other_file, space_text(grid),
                                file["file"].get<std::string>()),
                    name);
        }
    return out.lines();
}

std::string transform_text(const Json& transform) {
    return fmt::format("voxels of {}, the first at {}, {}", vector_text(transform["voxel_size"]),
                       vector_text(transform["origin"]), transform["map"].get<std::string>());
}

/// @param widest  of the grids' names, characters
std::string grid_line(const Json& grid, std::size_t widest) {
    auto out =
        fmt::format("  {:<{}}  {:<8} {:<10} {:<5}{:>10} voxels", grid["name"].get<std::string>(),
                    widest, grid["type"].get<std::string>(), grid["class"].get<std::string>(),
                    grid["half"].get<bool>() ? "half" : "", count_text(grid["active_voxels"]));
    if (grid.contains("box"))
        out += fmt::format(" in {} to {}, world {}", grid["box"][0].dump(), grid["box"][1].dump(),
                           world_text(grid["world_box"]));
    if (grid.contains("range"))
        out += fmt::format(", {}{}",
                           grid["type"].get<std::string>().starts_with("vec") ? "lengths " : "",
                           range_text(grid["range"]));
    if (grid.contains("points")) {
        out += fmt::format(", {} points with", count_text(grid["points"]["count"]));
        for (const auto& [name, type] : grid["points"]["attributes"].items())
            out += " " + name + " (" + type.get<std::string>() + ")";
    }
    return out + "\n";
}

/// The transforms, each with the grids that have it.
std::string transform_lines(const Json& all) {
    std::vector<std::pair<std::string, std::string>> places;
    for (const auto& grid : all) {
        const auto place = transform_text(grid["transform"]);
        const auto name = grid["name"].get<std::string>();
        if (const auto found =
                std::ranges::find_if(places, [&](const auto& each) { return each.first == place; });
            found != places.end())
            found->second += ", " + name;
        else places.emplace_back(place, name);
    }
    std::string out;
    for (const auto& [place, names] : places) out += fmt::format("  {} ({})\n", place, names);
    return out;
}

std::string text(const Json& file) {
    const auto* const known =
        file["profile"].is_null() ? nullptr : conventions_of(file["profile"].get<std::string>());
    auto out = fmt::format("{}: {} bytes, version {}, compression {}{}\n",
                           file["file"].get<std::string>(), count_text(file["bytes"]),
                           count_text(file["version"]), file["compression"].get<std::string>(),
                           known ? fmt::format(", as {} writes", known->application) : "");
    for (const auto& [name, value] : file["metadata"].items())
        out += fmt::format("  {}: {}\n", name, value.get<std::string>());
    std::size_t widest = 4;
    for (const auto& grid : file["grids"])
        widest = std::max(widest, grid["name"].get<std::string>().size());
    for (const auto& grid : file["grids"]) out += grid_line(grid, widest);
    out += transform_lines(file["grids"]);
    for (const auto& oddity : file["oddities"])
        out += "  note: " + oddity.get<std::string>() + "\n";
    return out;
}

}  // namespace

FileInspector vdb_inspector() { return {{".vdb"}, {}, "grids", &look, &compare, &text}; }

}  // namespace fluidcarve
