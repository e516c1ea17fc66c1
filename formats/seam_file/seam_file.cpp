#include "formats/seam_file/seam_file.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "formats/seam_file/seam_checksum.h"
#include "formats/seam_file/seam_metadata.h"
#include "formats/seam_file/warp_file.h"
#include "formats/vdb/provenance_metadata.h"
#include "formats/vdb/vdb_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace fluidcarve {

namespace {

using openvdb::Coord;

constexpr const char* checksum_name = "fluidcarve_checksum";

std::string seam_name(std::size_t n) { return fmt::format("seam.{:04}", n); }
std::string pair_name(std::size_t n) { return seam_name(n) + ".pair"; }
std::string place(const Coord& at) { return fmt::format("({})", numbers_text(at)); }

/// Where the entry of a column stands in a grid.
Coord place_of(const Seams& seams, int lateral, int slice, int layer) {
    return seams.in_time() ? Coord(layer, lateral, slice) : Coord(lateral, slice, layer);
}

template <class Visit>
void each_column(const Seams& seams, Visit&& visit) {
    std::size_t column = 0;
    for (int layer = 0; layer < static_cast<int>(seams.layers()); ++layer)
        for (int slice = 0; slice < seams.slices(); ++slice)
            for (int lateral = 0; lateral < seams.laterals(); ++lateral)
                visit(place_of(seams, lateral, slice, layer), column++);
}

openvdb::GridBase::Ptr to_grid(const Seams& seams, const Seams::Seam& seam, const std::string& name,
                               Seams::Kind kind) {
    const auto grid = FloatGrid::create();
    grid->setName(name);
    grid->insertMeta("kind", openvdb::StringMetadata(to_text(kind)));
    grid->insertMeta("energy", openvdb::DoubleMetadata(seam.energy));
    auto values = grid->getAccessor();
    each_column(seams, [&](const Coord& at, std::size_t column) {
        values.setValueOn(at, seam.at[column]);
    });
    return grid;
}

/// The names of grids for messages; of many, the first.
std::string some_names(const Volume& volume) {
    constexpr std::size_t most = 12;
    if (volume.grids.size() <= most) return volume.names();
    Volume first;
    first.grids.assign(volume.grids.begin(), volume.grids.begin() + most);
    return fmt::format("{} and {} more", first.names(), volume.grids.size() - most);
}

/// The grids of a seam file, in the order of the seams.
struct SeamGrids {
    std::vector<FloatGrid::ConstPtr> seams, pairs;

    std::vector<FloatGrid::ConstPtr> all() const {
        auto out = seams;
        out.insert(out.end(), pairs.begin(), pairs.end());
        return out;
    }
};

SeamGrids grids_of(const Volume& volume) {
    SeamGrids out;
    if (volume.grids.empty()) return out;
    std::map<std::string, FloatGrid::ConstPtr> named;
    for (const auto& grid : volume.grids)
        named.emplace(grid->getName(), openvdb::GridBase::grid<FloatGrid>(grid));
    if (!named.contains(seam_name(0)))
        throw wrong_seams(
            fmt::format("there is no grid '{}' among {}", seam_name(0), some_names(volume)));
    const bool paired = named.contains(pair_name(0));
    const auto count = paired ? (volume.grids.size() + 1) / 2 : volume.grids.size();
    const auto grid_of = [&](const std::string& name) {
        const auto found = named.find(name);
        if (found == named.end() || !found->second)
            throw wrong_seams(fmt::format(
                "the {} grids must be float grids named '{}' to '{}', but there are {}",
                volume.grids.size(), seam_name(0),
                paired ? pair_name(count - 1) : seam_name(count - 1), some_names(volume)));
        return found->second;
    };
    for (std::size_t n = 0; n < count; ++n) {
        out.seams.push_back(grid_of(seam_name(n)));
        if (paired) out.pairs.push_back(grid_of(pair_name(n)));
    }
    return out;
}

Seams::Kind kind_of(const FloatGrid& grid) {
    const auto text = seam_text(grid, "kind", "grid '" + grid.getName() + "'");
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        if (text == to_text(kind)) return kind;
    throw wrong_seams(fmt::format("grid '{}' has the kind '{}'; known: remove, insert",
                                  grid.getName(), cut_short(text)));
}

/// The kind of the seams; that of their pairs is the opposite.
Seams::Kind kind_of(const SeamGrids& grids) {
    if (grids.seams.empty()) return Seams::Kind::remove;
    const auto kind = kind_of(*grids.seams.front());
    for (const auto& grid : grids.seams)
        if (kind_of(*grid) != kind)
            throw wrong_seams(fmt::format("grid '{}' says {}, but '{}' says {}", grid->getName(),
                                          to_text(opposite(kind)), seam_name(0), to_text(kind)));
    for (std::size_t n = 0; n < grids.pairs.size(); ++n)
        if (kind_of(*grids.pairs[n]) == kind)
            throw wrong_seams(fmt::format(
                "grid '{}' says {} as '{}' does, but one of a pair removes and the other inserts",
                pair_name(n), to_text(kind), seam_name(n)));
    return kind;
}

/// Requires that each grid holds all columns and nothing else, and that entries take little more
/// memory than the grids: a file may hold very many columns in a few tiles, and one tree for very
/// many seams.
void require_columns(const SeamGrids& grids, const Seams& seams) {
    const auto all = grids.all();
    const auto columns = seams.columns();
    const openvdb::CoordBBox wanted(Coord(0),
                                    place_of(seams, seams.laterals() - 1, seams.slices() - 1,
                                             static_cast<int>(seams.layers()) - 1));
    std::set<const FloatGrid::TreeType*> trees;
    std::uint64_t held = 0;
    for (const auto& grid : all) {
        if (!trees.insert(&grid->tree()).second) continue;
        held += grid->memUsage();
        if (const auto voxels = grid->activeVoxelCount(); voxels != columns)
            throw wrong_seams(fmt::format(
                "grid '{}' has {} active voxels, but must have one for each of {} columns",
                grid->getName(), voxels, columns));
        if (const auto box = grid->evalActiveVoxelBoundingBox(); box != wanted)
            throw wrong_seams(
                fmt::format("grid '{}' has active voxels from {} to {}, but must have the columns "
                            "from {} to {}",
                            grid->getName(), place(box.min()), place(box.max()),
                            place(wanted.min()), place(wanted.max())));
    }
    if (!fits_grids(columns, all.size(), sizeof(std::uint16_t), held))
        throw wrong_seams(
            fmt::format("the shape states {} columns, but the grids hold them in tiles or shared "
                        "trees of {} bytes; write each column of each grid as a voxel of its own",
                        columns, held));
}

/// Reads the entries of grids that hold all columns. Grids that share a tree share their entries.
class EntriesReader {
public:
    explicit EntriesReader(const Seams& seams) : seams_(seams) {}

    /// @param n  number of seams of this kind before it
    Seams::Seam read(const FloatGrid& grid, Seams::Kind kind, std::size_t n) {
        const auto energy = grid.getMetadata<openvdb::DoubleMetadata>("energy");
        if (!energy)
            throw wrong_seams(
                fmt::format("grid '{}' has no number 'energy' in its metadata", grid.getName()));
        if (!std::isfinite(energy->value()))
            throw wrong_seams(fmt::format("grid '{}' has the energy {}, which is not finite",
                                          grid.getName(), energy->value()));
        // A removal is an index among the entries that its predecessors leave. The last entry can't
        // be doubled.
        const int highest =
            seams_.before() - 1 - (kind == Seams::Kind::remove ? static_cast<int>(n) : 1);
        auto& tree = trees_[&grid.tree()];
        if (tree.entries.size() == 0 || tree.highest > highest) tree = read_tree(grid, highest);
        return {tree.entries, energy->value()};
    }

private:
    struct Tree {
        SeamEntries entries;
        int highest = 0;
    };

    Tree read_tree(const FloatGrid& grid, int highest) const {
        std::vector<std::uint16_t> entries(seams_.columns());
        const int lowest = seams_.whole_window().first;
        float most = 0;
        for (auto value = grid.cbeginValueOn(); value; ++value) {
            const auto box = value.getBoundingBox();
            if (!(*value >= static_cast<float>(lowest) && *value <= static_cast<float>(highest)) ||
                *value != std::floor(*value))
                throw wrong_seams(fmt::format(
                    "grid '{}' has {} at {}, but must have a whole number from {} to {}",
                    grid.getName(), *value, place(box.min()), lowest, highest));
            most = std::max(most, *value);
            for (auto at = box.begin(); at; ++at)
                entries[column(*at)] = static_cast<std::uint16_t>(*value);
        }
        return {std::move(entries), static_cast<int>(most)};
    }

    /// The column whose entry stands at a place of a grid.
    std::size_t column(const Coord& at) const {
        const auto [lateral, slice, layer] = seams_.in_time() ? std::array{at.y(), at.z(), at.x()}
                                                              : std::array{at.x(), at.y(), at.z()};
        const auto row =
            static_cast<std::size_t>(layer) * static_cast<std::size_t>(seams_.slices()) +
            static_cast<std::size_t>(slice);
        return row * static_cast<std::size_t>(seams_.laterals()) +
               static_cast<std::size_t>(lateral);
    }

    const Seams& seams_;
    std::map<const FloatGrid::TreeType*, Tree> trees_;
};

/// Requires that no two insertions double the same entry of a column.
/// @param name  gives the name of the n-th grid
void require_distinct(const Seams& seams, const std::vector<Seams::Seam>& insertions,
                      std::string (*name)(std::size_t n)) {
    if (insertions.empty())
        return;  // a file of a kilobyte may state so many columns that visiting them takes a
                 // minute
    std::vector<bool> taken(static_cast<std::size_t>(seams.before()));
    each_column(seams, [&](const Coord& at, std::size_t column) {
        for (std::size_t n = 0; n < insertions.size(); ++n) {
            const auto entry = insertions[n].at[column];
            if (taken[entry])
                throw wrong_seams(
                    fmt::format("grid '{}' doubles entry {} at {}, which another seam doubles too",
                                name(n), entry, place(at)));
            taken[entry] = true;
        }
        for (const auto& seam : insertions) taken[seam.at[column]] = false;
    });
}

/// Requires that in each column all second seams of pairs lie above all seams of the first window.
void require_apart(const Seams& seams) {
    // The lowest removal is an original entry, since nothing below it is removed. The highest
    // original entry is the one that leaves the fewest behind it: the highest sum of an entry and
    // the number of removals before it.
    const auto range = [](const std::vector<Seams::Seam>& window, Seams::Kind kind,
                          std::size_t column) {
        int lowest = std::numeric_limits<int>::max(), highest = 0;
        for (std::size_t n = 0; n < window.size(); ++n) {
            const int entry = window[n].at[column];
            lowest = std::min(lowest, entry);
            highest =
                std::max(highest, entry + (kind == Seams::Kind::remove ? static_cast<int>(n) : 0));
        }
        return std::pair(lowest, highest);
    };
    each_column(seams, [&](const Coord& at, std::size_t column) {
        const int highest = range(seams.seams, seams.kind, column).second,
                  lowest = range(seams.pairs, opposite(seams.kind), column).first;
        if (lowest <= highest)
            throw wrong_seams(
                fmt::format("at {} a pair takes entry {}, but must be above all seams of the first "
                            "window, which reach {}",
                            place(at), lowest, highest));
    });
}

/// Requires that the seams of each slab run side by side.
/// @param name  gives the name of the n-th grid
void require_slabs(const Seams& seams, const std::vector<Seams::Seam>& all, Seams::Kind kind,
                   std::string (*name)(std::size_t n)) {
    const auto thickness = static_cast<std::size_t>(seams.thickness);
    for (std::size_t n = 0; n < all.size(); ++n) {
        if (n % thickness == 0) continue;
        const int step = kind == Seams::Kind::insert ? 1 : 0;
        if (!std::ranges::equal(all[n - 1].at, all[n].at,
                                [&](int before, int entry) { return entry == before + step; }))
            throw wrong_seams(
                fmt::format("grid '{}' is part of a slab of {} seams ('fluidcarve_thickness'), but "
                            "does not run beside '{}'",
                            name(n), seams.thickness, name(n - 1)));
    }
}

/// Requires that a checksum that the file states matches.
void require_checksum(const openvdb::MetaMap& metadata, const Seams& seams) {
    if (metadata[checksum_name] &&
        seam_text(metadata, checksum_name, "the file") != seam_checksum(seams))
        throw wrong_seams(
            fmt::format("the file is damaged or was changed: its content does not match its "
                        "checksum; write it again, or remove the metadata '{}' if you changed it "
                        "on purpose",
                        checksum_name));
}

}  // namespace

Volume seams_to_volume(const Seams& seams) {
    Volume out;
    const std::size_t grids = seams.paired() ? 2 : 1;
    if (seams.warp) out.grids = grids_of_warp(*seams.warp);
    else out.grids.resize(grids * seams.seams.size());
    tbb::parallel_for(std::size_t{0}, seams.seams.size(), [&](std::size_t n) {
        out.grids[grids * n] = to_grid(seams, seams.seams[n], seam_name(n), seams.kind);
        if (seams.paired())
            out.grids[grids * n + 1] =
                to_grid(seams, seams.pairs[n], pair_name(n), opposite(seams.kind));
    });
    for (const auto& [name, text] : seam_texts(seams))
        out.metadata.insertMeta(name, openvdb::StringMetadata(text));
    out.metadata.insertMeta(checksum_name, openvdb::StringMetadata(seam_checksum(seams)));
    return out;
}

Seams seams_from_volume(const Volume& volume) {
    auto out = seams_of_texts(volume.metadata);
    if (const auto factor = warp_factor(volume.metadata)) {
        out.warp = warp_of_grids(volume, out, *factor);
        require_checksum(volume.metadata, out);
        return out;
    }
    const auto grids = grids_of(volume);
    if (const auto count = static_cast<int>(grids.seams.size()); count > out.before())
        throw wrong_seams(fmt::format("{} seams do not fit {} vertices", count, out.before()));
    out.kind = kind_of(grids);
    require_columns(grids, out);
    EntriesReader entries(out);
    for (std::size_t n = 0; n < grids.seams.size(); ++n)
        out.seams.push_back(entries.read(*grids.seams[n], out.kind, n));
    for (std::size_t n = 0; n < grids.pairs.size(); ++n)
        out.pairs.push_back(entries.read(*grids.pairs[n], opposite(out.kind), n));
    if (out.thick()) {
        require_slabs(out, out.seams, out.kind, seam_name);
        require_slabs(out, out.pairs, opposite(out.kind), pair_name);
    } else if (out.kind == Seams::Kind::insert) {
        require_distinct(out, out.seams, seam_name);
    } else {
        require_distinct(out, out.pairs, pair_name);
    }
    if (out.paired()) require_apart(out);
    require_checksum(volume.metadata, out);
    out.find_shifts();
    return out;
}

void write_seams(const std::string& path, const Seams& seams, const Provenance& provenance) {
    auto volume = seams_to_volume(seams);
    set_provenance(volume.metadata, provenance);
    write_vdb(path, volume);
}

std::optional<FrameCarvePromise> frames_carved_by(const std::string& path) try {
    const auto header = read_vdb_header(path);
    if (seam_text(header.metadata, "fluidcarve_axis", path) != to_text(Axis::t))
        return std::nullopt;
    const auto count = static_cast<int>(header.grids.size());
    if (count == 0) return FrameCarvePromise{};
    const auto& first = header.grids[header.place(seam_name(0))].metadata;
    const bool paired = header.find(pair_name(0)).has_value();
    const bool inserts = seam_text(first, "kind", path) == to_text(Seams::Kind::insert);
    return FrameCarvePromise{{static_cast<double>(inserts ? count : -count)}, paired};
} catch (const Failure&) {
    return std::nullopt;  // read_seams() reports the fault
}

Seams read_seams(const std::string& path) {
    const auto volume = read_vdb(path);
    try {
        return seams_from_volume(volume);
    } catch (const Failure& failure) {
        throw Failure(fmt::format("{}: {}", path, failure.what()), failure.kind);
    }
}

}  // namespace fluidcarve
