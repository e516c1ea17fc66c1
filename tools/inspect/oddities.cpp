#include "tools/inspect/oddities.h"

#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/grid_types.h"
#include "carve/volume/triplet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <set>

namespace fluidcarve {

void Oddities::add(const std::string& text, const std::string& name) {
    auto found = std::ranges::find_if(all_, [&](const auto& each) { return each.first == text; });
    if (found == all_.end()) found = all_.insert(all_.end(), {text, {}});
    if (!name.empty()) found->second.push_back(name);
}

std::vector<std::string> Oddities::lines() const {
    std::vector<std::string> out;
    for (const auto& [text, names] : all_)
        out.push_back(names.empty() ? text : fmt::format("{}: {}", fmt::join(names, ", "), text));
    return out;
}

namespace {

using Json = nlohmann::ordered_json;
using openvdb::GridBase;
using openvdb::points::PointDataGrid;

/// @param say  takes a note
void note_metadata(const openvdb::MetaMap& map, const auto& say) {
    if (map.metaCount() > most_metadata)
        say(fmt::format("{} entries of metadata, of which the first {} are listed", map.metaCount(),
                        most_metadata));
}

/// Adds what is odd about a grid.
class GridNotes {
public:
    GridNotes(const GridBase& grid, const Json& facts, const Conventions* conventions,
              Oddities& out)
        : grid_(grid), facts_(facts), conventions_(conventions), out_(out) {}

    void add() const {
        note_metadata(grid_, [&](const std::string& text) { say(text); });
        if (RawGrid::of(grid_))
            return say(
                fmt::format("of type {}, which OpenVDB does not know: kept as it is, but can't be "
                            "looked at or carved",
                            grid_.type()));
        if (grid_.activeVoxelCount() == 0) say("no active voxels");
        add_shape();
        add_values();
        if (grid_.isType<VectorGrid>()) add_vectors();
        add_class();
        if (grid_.isType<PointDataGrid>()) add_points();
    }

private:
    void say(const std::string& text) const { out_.add(text, facts_["name"].get<std::string>()); }
    bool blender() const { return conventions_ && conventions_->name == "blender"; }

    /// The shape of voxels.
    void add_shape() const {
        const auto size = grid_.voxelSize();
        if (!grid_.transform().isLinear())
            say(fmt::format("voxels of varying shape ({}): no energy or lattice takes them",
                            grid_.transform().mapType()));
        else if (!are_cubes(grid_.transform()))
            say(fmt::format(
                "voxels that are no cubes ({:.6g} x {:.6g} x {:.6g}): distances refuse them",
                size.x(), size.y(), size.z()));
    }
    void add_values() const {
        if (facts_.contains("not_finite"))
            return say(fmt::format(
                "{} values are not finite, the first at voxel {}: energies refuse them",
                facts_["not_finite"].get<std::size_t>(), facts_["first_not_finite"].dump()));
        if (facts_.contains("range") && facts_["range"][0] == facts_["range"][1] &&
            grid_.activeVoxelCount() > 1 &&
            voxels_in(grid_.evalActiveVoxelBoundingBox()) == grid_.activeVoxelCount())
            say(
                fmt::format("{:g} everywhere in its box: it shows no content, so fit the lattice "
                            "to another grid",
                            facts_["range"][0].get<double>()));
    }
    void add_vectors() const {
        const bool velocity = grid_.getName().starts_with("vel");
        if (grid_.getGridClass() == openvdb::GRID_STAGGERED)
            say("staggered: component c stands on the face below its voxel along axis c");
        if (grid_.getVectorType() == openvdb::VEC_INVARIANT && velocity)
            say("its vector type is invariant: other tools don't rotate it with its transform");
        if (conventions_ && velocity)
            say(fmt::format("if {} wrote it, in {}", conventions_->application,
                            conventions_->velocity_unit));
    }
    void add_class() const {
        const auto of = grid_.getGridClass();
        if (of == openvdb::GRID_LEVEL_SET && grid_.isType<FloatGrid>() &&
            static_cast<const FloatGrid&>(grid_).background() <= 0)
            say("called a level set, but its background is not above 0: dense values in voxels, no "
                "narrow band");
        if (blender() && of == openvdb::GRID_FOG_VOLUME && facts_.contains("range") &&
            facts_["range"][0] >= 1e-6 && facts_["range"][0] < 1.1e-6)
            say("active only above 1e-06: derivatives jump at the border of the smoke");
        if (of == openvdb::GRID_UNKNOWN && grid_.isType<FloatGrid>() &&
            grid_.getName() == "density")
            say("no class: treated as a fog volume");
    }
    void add_points() const {
        if (blender()) say("particles half a voxel off the other grids' voxels");
        for (const auto& [name, type] : facts_["points"]["attributes"].items())
            if (type.get<std::string>() == "int32 trnc")
                say(
                    fmt::format("attribute '{}' is in a half-size codec that OpenVDB itself does "
                                "not read; fluidcarve does",
                                name));
    }

    const GridBase& grid_;
    const Json& facts_;
    const Conventions* conventions_;
    Oddities& out_;
};

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

}  // namespace

void note_volume(const Volume& volume, const VdbHeader& header, const Json& grids,
                 const Conventions* conventions, Oddities& out) {
    for (std::size_t n = 0; n < volume.grids.size(); ++n)
        GridNotes(volume.grids[n].header(), grids[n], conventions, out).add();
    note_between(volume, grids, out);
    note_file(volume, header, conventions, out);
}

}  // namespace fluidcarve
