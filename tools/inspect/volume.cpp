#include "tools/inspect/volume.h"

#include "carve/base/one_line.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/grid_types.h"
#include "carve/volume/triplet.h"
#include "formats/vdb/conventions.h"
#include "tools/inspect/facts.h"

#include <fmt/ranges.h>

#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
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

constexpr std::size_t most_entries = 1000;  ///< of metadata that are listed

Json metadata_of(const openvdb::MetaMap& map) {
    auto out = Json::object();
    for (auto entry = map.beginMeta(); entry != map.endMeta() && out.size() < most_entries; ++entry)
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

/// Notes for the author of a pipeline, each with the grids that it applies to; without grids it
/// applies to the file.
class Oddities {
public:
    void add(const std::string& text, const std::string& grid = {}) {
        auto found = std::find_if(all_.begin(), all_.end(),
                                  [&](const auto& each) { return each.first == text; });
        if (found == all_.end()) found = all_.insert(all_.end(), {text, {}});
        if (!grid.empty()) found->second.push_back(grid);
    }
    std::vector<std::string> lines() const {
        std::vector<std::string> out;
        for (const auto& [text, grids] : all_)
            out.push_back(grids.empty() ? text
                                        : fmt::format("{}: {}", fmt::join(grids, ", "), text));
        return out;
    }

private:
    std::vector<std::pair<std::string, std::vector<std::string>>> all_;
};

/// @param say  takes a note
void note_metadata(const openvdb::MetaMap& map, const auto& say) {
    if (map.metaCount() > most_entries)
        say(fmt::format("{} entries of metadata, of which the first {} are listed", map.metaCount(),
                        most_entries));
}

void note_grid(const GridBase& grid, const Json& facts, const Conventions* conventions,
               Oddities& out) {
    const auto say = [&](const std::string& text) {
        out.add(text, facts["name"].get<std::string>());
    };
    const bool blender = conventions && conventions->name == "blender";
    const auto size = grid.voxelSize();
    note_metadata(grid, say);

    if (RawGrid::of(grid))
        return say(
            fmt::format("of type {}, which OpenVDB does not know: kept as it is, but can't be "
                        "looked at or carved",
                        grid.type()));
    if (grid.activeVoxelCount() == 0) say("no active voxels");
    if (!grid.transform().isLinear())
        say(fmt::format("voxels of varying shape ({}): no energy or lattice takes them",
                        grid.transform().mapType()));
    else if (!are_cubes(grid.transform()))
        say(fmt::format(
            "voxels that are no cubes ({:.6g} x {:.6g} x {:.6g}): distances refuse them", size.x(),
            size.y(), size.z()));
    if (facts.contains("not_finite"))
        say(fmt::format("{} values are not finite, the first at voxel {}: energies refuse them",
                        facts["not_finite"].get<std::size_t>(), facts["first_not_finite"].dump()));
    if (facts.contains("range") && !facts.contains("not_finite") &&
        facts["range"][0] == facts["range"][1] && grid.activeVoxelCount() > 1 &&
        voxels_in(grid.evalActiveVoxelBoundingBox()) == grid.activeVoxelCount())
        say(fmt::format(
            "{:g} everywhere in its box: it shows no content, so fit the lattice to another grid",
            facts["range"][0].get<double>()));
    if (grid.isType<VectorGrid>()) {
        if (grid.getGridClass() == openvdb::GRID_STAGGERED)
            say("staggered: component c stands on the face below its voxel along axis c");
        if (grid.getVectorType() == openvdb::VEC_INVARIANT && grid.getName().starts_with("vel"))
            say("its vector type is invariant: other tools don't rotate it with its transform");
        if (conventions && grid.getName().starts_with("vel"))
            say(fmt::format("if {} wrote it, in {}", conventions->application,
                            conventions->velocity_unit));
    }
    if (grid.getGridClass() == openvdb::GRID_LEVEL_SET && grid.isType<FloatGrid>() &&
        static_cast<const FloatGrid&>(grid).background() <= 0)
        say("called a level set, but its background is not above 0: dense values in voxels, no "
            "narrow band");
    if (blender && grid.getGridClass() == openvdb::GRID_FOG_VOLUME && facts.contains("range") &&
        facts["range"][0] >= 1e-6 && facts["range"][0] < 1.1e-6)
        say("active only above 1e-06: derivatives jump at the border of the smoke");
    if (grid.getGridClass() == openvdb::GRID_UNKNOWN && grid.isType<FloatGrid>() &&
        grid.getName() == "density")
        say("no class: treated as a fog volume");
    if (grid.isType<PointDataGrid>()) {
        if (blender) say("particles half a voxel off the other grids' voxels");
        for (const auto& [name, type] : facts["points"]["attributes"].items())
            if (type.get<std::string>() == "int32 trnc")
                say(
                    fmt::format("attribute '{}' is in a half-size codec that OpenVDB itself does "
                                "not read; fluidcarve does",
                                name));
    }
}

void note_between(const Volume& volume, const Json& grids, Oddities& out) {
    std::set<std::string> names;
    std::set<const openvdb::TreeBase*> trees;
    for (std::size_t n = 0; n < volume.grids.size(); ++n) {
        const auto& grid = volume.grids[n].header();
        const auto name = grids[n]["name"].get<std::string>();
        const auto triplet = triplet_of(volume, grid);
        if (triplet)
            out.add(fmt::format("{} vector in three grids: name it under `grids: {{{}: vector}}`",
                                triplet->staggered ? "a staggered" : "a", triplet->name),
                    name);
        else if (n > 0 && grid.transform() != volume.grids[0].header().transform())
            out.add(fmt::format("another transform than {}", grids[0]["name"].get<std::string>()),
                    name);
        if (!names.insert(grid.getName()).second) out.add("not the only grid of its name", name);
        if (!trees.insert(&grid.constBaseTree()).second)
            out.add("shares its voxels with a grid before it", name);
    }
}

void note_file(const Volume& volume, const VdbHeader& header, const Conventions* conventions,
               Oddities& out) {
    note_metadata(volume.metadata, [&](const std::string& text) { out.add(text); });
    if (volume.grids.empty()) return out.add("no grids");
    if (conventions && conventions->name == "blender" &&
        volume.grids[0].header().transform().indexToWorld(openvdb::Vec3d(0)).isZero())
        out.add(
            "the grids start at the world's origin: Blender's caches lose their place in the "
            "scene; the reader's `translate` gives it back");
    if (header.version != openvdb::OPENVDB_FILE_VERSION)
        out.add(fmt::format("the file's version is {}; it would be written as {}", header.version,
                            static_cast<unsigned>(openvdb::OPENVDB_FILE_VERSION)));
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
    Oddities oddities;
    for (std::size_t n = 0; n < volume.grids.size(); ++n) {
        out["grids"].push_back(grid_json(volume.grids[n].header(), header.grids[n].unique_name));
        note_grid(volume.grids[n].header(), out["grids"].back(), conventions, oddities);
    }
    note_between(volume, out["grids"], oddities);
    note_file(volume, header, conventions, oddities);
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
    const auto three = [](const Json& v) {
        return fmt::format("{:.6g}, {:.6g}, {:.6g}", v[0].get<double>(), v[1].get<double>(),
                           v[2].get<double>());
    };
    return fmt::format("voxels of [{}], the first at [{}], {}", three(transform["voxel_size"]),
                       three(transform["origin"]), transform["map"].get<std::string>());
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
    for (const auto& grid : file["grids"]) {
        out += fmt::format("  {:<{}}  {:<8} {:<10} {:<5}{:>10} voxels",
                           grid["name"].get<std::string>(), widest, grid["type"].get<std::string>(),
                           grid["class"].get<std::string>(), grid["half"].get<bool>() ? "half" : "",
                           count_text(grid["active_voxels"]));
        if (grid.contains("box"))
            out += fmt::format(" in {} to {}, world {}", grid["box"][0].dump(),
                               grid["box"][1].dump(), world_text(grid["world_box"]));
        if (grid.contains("range"))
            out += fmt::format(", {}{}",
                               grid["type"].get<std::string>().starts_with("vec") ? "lengths " : "",
                               range_text(grid["range"]));
        if (grid.contains("points")) {
            out += fmt::format(", {} points with", count_text(grid["points"]["count"]));
            for (const auto& [name, type] : grid["points"]["attributes"].items())
                out += " " + name + " (" + type.get<std::string>() + ")";
        }
        out += "\n";
    }
    std::vector<std::pair<std::string, std::string>> places;
    for (const auto& grid : file["grids"]) {
        const auto place = transform_text(grid["transform"]);
        const auto name = grid["name"].get<std::string>();
        if (const auto found = std::find_if(places.begin(), places.end(),
                                            [&](const auto& each) { return each.first == place; });
            found != places.end())
            found->second += ", " + name;
        else places.emplace_back(place, name);
    }
    for (const auto& [place, names] : places) out += fmt::format("  {} ({})\n", place, names);
    for (const auto& oddity : file["oddities"])
        out += "  note: " + oddity.get<std::string>() + "\n";
    return out;
}

}  // namespace

FileInspector vdb_inspector() { return {{".vdb"}, {}, "grids", &look, &compare, &text}; }

}  // namespace fluidcarve
