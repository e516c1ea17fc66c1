#include "nodes/seams/seam_file.h"

#include "graph/text/problem.h"
#include "graph/types/frames.h"
#include "nodes/io/vdb_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdio>
#include <map>

namespace fluidcarve {

namespace {

using openvdb::Coord;

Failure wrong(const std::string& message) { return Failure(message, Failure::Kind::input); }

std::string seam_name(std::size_t n) { return fmt::format("seam.{:04}", n); }
std::string pair_name(std::size_t n) { return seam_name(n) + ".pair"; }

template <class Visit>
void each_column(const Seams& seams, Visit&& visit) {
    std::size_t column = 0;
    for (int t = 0; t < static_cast<int>(seams.frames.size()); ++t)
        for (int k = 0; k < seams.shape[2]; ++k)
            for (int lateral = 0; lateral < seams.lateral(); ++lateral) visit(Coord(lateral, k, t), column++);
}

openvdb::GridBase::Ptr to_grid(const Seams& seams, const Seams::Seam& seam, const std::string& name, Seams::Kind kind) {
    const auto grid = FloatGrid::create();
    grid->setName(name);
    grid->insertMeta("kind", openvdb::StringMetadata(to_text(kind)));
    grid->insertMeta("energy", openvdb::DoubleMetadata(seam.energy));
    auto values = grid->getAccessor();
    each_column(seams, [&](const Coord& at, std::size_t column) { values.setValueOn(at, seam.at[column]); });
    return grid;
}

std::string text_of(const openvdb::MetaMap& map, const std::string& name, const std::string& owner) {
    const auto found = map.getMetadata<openvdb::StringMetadata>(name);
    if (!found) throw wrong(fmt::format("{} has no text '{}' in its metadata, so it is no seam file", owner, name));
    return found->value();
}

void read_shape(const std::string& text, Seams& out, std::size_t& frames) {
    int shape[4] = {}, end = 0;
    const bool four =
        std::sscanf(text.c_str(), "%d,%d,%d,%d%n", &shape[0], &shape[1], &shape[2], &shape[3], &end) == 4 && text.size() == static_cast<std::size_t>(end);
    for (const int n : shape)
        if (!four || n < 1 || n > 65535) throw wrong(fmt::format("'fluidcarve_shape' wants four numbers from 1 to 65535, I,J,K,T, not '{}'", text));
    for (std::size_t n = 0; n < 3; ++n) out.shape[n] = shape[n];
    frames = static_cast<std::size_t>(shape[3]);
}

/// The two ends of a window; nothing if the file states none.
std::optional<Window> read_window(const Volume& volume, const char* name, int size) {
    if (!volume.metadata[name]) return std::nullopt;
    const auto text = text_of(volume.metadata, name, "the file");
    Window out;
    int end = 0;
    const bool two = std::sscanf(text.c_str(), "%d,%d%n", &out.first, &out.last, &end) == 2 && text.size() == static_cast<std::size_t>(end);
    if (!two || out.first < 0 || out.last < out.first || out.last >= size)
        throw wrong(fmt::format("'{}' wants two vertices from 0 to {}, first,last, not '{}'", name, size - 1, text));
    return out;
}

Anchor read_anchor(const Volume& volume, int size) {
    const auto* const name = "fluidcarve_anchor";
    if (!volume.metadata[name]) return {};
    const auto text = text_of(volume.metadata, name, "the file");
    for (const auto at : {Anchor::At::low, Anchor::At::middle, Anchor::At::high})
        if (text == to_text(Anchor{at, 0})) return {at, 0};
    int vertex = -1, end = 0;
    const bool whole = std::sscanf(text.c_str(), "%d%n", &vertex, &end) == 1 && text.size() == static_cast<std::size_t>(end);
    if (!whole || vertex < 0 || vertex >= size)
        throw wrong(fmt::format("'{}' wants low, middle, high or a vertex from 0 to {}, not '{}'", name, size - 1, text));
    return {Anchor::At::vertex, vertex};
}

Seams::Kind kind_of(const FloatGrid& grid) {
    const auto text = text_of(grid, "kind", "grid '" + grid.getName() + "'");
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        if (text == to_text(kind)) return kind;
    throw wrong(fmt::format("grid '{}' has the kind '{}'; known: remove, insert", grid.getName(), text));
}

/// @param n  number of seams of this kind before it
Seams::Seam read_seam(const FloatGrid& grid, const Seams& seams, Seams::Kind kind, std::size_t n) {
    const auto energy = grid.getMetadata<openvdb::DoubleMetadata>("energy");
    if (!energy) throw wrong(fmt::format("grid '{}' has no number 'energy' in its metadata", grid.getName()));
    // A removal is an index among the entries that its predecessors leave. The last entry can't be doubled.
    const int highest = seams.carved() - 1 - (kind == Seams::Kind::remove ? static_cast<int>(n) : 1);
    // Checked before memory is allocated: the file may not hold the columns that its shape claims.
    const auto columns = seams.columns_per_frame() * seams.frames.size();
    if (grid.activeVoxelCount() != columns)
        throw wrong(fmt::format("grid '{}' has {} active voxels, but wants one for each of {} columns", grid.getName(), grid.activeVoxelCount(), columns));
    std::vector<std::uint16_t> entries(columns);
    auto values = grid.getConstAccessor();
    each_column(seams, [&](const Coord& at, std::size_t column) {
        float value = 0;
        const bool active = values.probeValue(at, value);
        if (!active || !(value >= 0 && value <= static_cast<float>(highest)) || value != std::floor(value))
            throw wrong(fmt::format("grid '{}' has {} at ({}, {}, {}), but wants a whole number from 0 to {}", grid.getName(),
                                    active ? fmt::format("{}", value) : "nothing", at.x(), at.y(), at.z(), highest));
        entries[column] = static_cast<std::uint16_t>(value);
    });
    return {std::move(entries), energy->value()};
}

/// Requires that no two insertions double the same entry of a column.
/// @param name  gives the name of the n-th grid
void require_distinct(const Seams& seams, const std::vector<Seams::Seam>& insertions, std::string (*name)(std::size_t n)) {
    std::vector<bool> taken(static_cast<std::size_t>(seams.carved()));
    each_column(seams, [&](const Coord& at, std::size_t column) {
        taken.assign(taken.size(), false);
        for (std::size_t n = 0; n < insertions.size(); ++n) {
            const auto entry = insertions[n].at[column];
            if (taken[entry])
                throw wrong(fmt::format("grid '{}' doubles entry {} at ({}, {}, {}), which another seam doubles too", name(n), entry, at.x(), at.y(), at.z()));
            taken[entry] = true;
        }
    });
}

/// Requires that in each column all second seams of pairs lie above all seams of the first window.
void require_apart(const Seams& seams) {
    std::vector<std::uint16_t> entries, sorted;
    const auto originals = [&](const std::vector<Seams::Seam>& window, Seams::Kind kind, std::size_t column) {
        entries.clear();
        for (const auto& seam : window) entries.push_back(seam.at[column]);
        if (kind == Seams::Kind::remove) to_original(entries, sorted);
        return std::minmax_element(entries.begin(), entries.end());
    };
    each_column(seams, [&](const Coord& at, std::size_t column) {
        const auto highest = *originals(seams.seams, seams.kind, column).second;
        const auto lowest = *originals(seams.pairs, opposite(seams.kind), column).first;
        if (lowest <= highest)
            throw wrong(fmt::format("at ({}, {}, {}) a pair takes entry {}, but must be above all seams of the first window, which reach {}", at.x(), at.y(),
                                    at.z(), lowest, highest));
    });
}

}  // namespace

Volume seams_to_volume(const Seams& seams) {
    Volume out;
    const std::size_t grids = seams.paired() ? 2 : 1;
    out.grids.resize(grids * seams.seams.size());
    tbb::parallel_for(std::size_t{0}, seams.seams.size(), [&](std::size_t n) {
        out.grids[grids * n] = to_grid(seams, seams.seams[n], seam_name(n), seams.kind);
        if (seams.paired()) out.grids[grids * n + 1] = to_grid(seams, seams.pairs[n], pair_name(n), opposite(seams.kind));
    });
    const auto say = [&](const char* name, const std::string& text) { out.metadata.insertMeta(name, openvdb::StringMetadata(text)); };
    say("fluidcarve_axis", to_text(seams.axis));
    say("fluidcarve_shape", fmt::format("{},{},{},{}", seams.shape[0], seams.shape[1], seams.shape[2], seams.frames.size()));
    say("fluidcarve_frames", FrameSet(seams.frames).text());
    say("fluidcarve_lattice", seams.lattice);
    say("fluidcarve_lattice_hash", seams.lattice_hash);
    if (seams.closed) say("fluidcarve_closed", "true");
    if (seams.window) say("fluidcarve_window", fmt::format("{},{}", seams.window->first, seams.window->last));
    if (seams.pair_window) say("fluidcarve_pair_window", fmt::format("{},{}", seams.pair_window->first, seams.pair_window->last));
    if (seams.anchor != Anchor{}) say("fluidcarve_anchor", to_text(seams.anchor));
    return out;
}

Seams seams_from_volume(const Volume& volume) {
    const auto say = [&](const char* name) { return text_of(volume.metadata, name, "the file"); };
    Seams out;
    const auto axis = say("fluidcarve_axis");
    if (axis != "u" && axis != "v") throw wrong(fmt::format("'fluidcarve_axis' wants u or v, not '{}'", axis));
    out.axis = axis == "u" ? Axis::u : Axis::v;
    std::size_t frames = 0;
    read_shape(say("fluidcarve_shape"), out, frames);
    std::string fault;
    const auto set = FrameSet::parse(say("fluidcarve_frames"), fault);
    if (!set) throw wrong("'fluidcarve_frames' " + fault);
    if (set->frames().size() != frames)
        throw wrong(fmt::format("'fluidcarve_frames' lists {} frames, but 'fluidcarve_shape' {}", set->frames().size(), frames));
    out.frames = set->frames();
    out.lattice = say("fluidcarve_lattice");
    out.lattice_hash = say("fluidcarve_lattice_hash");

    if (volume.metadata["fluidcarve_closed"]) {
        const auto closed = say("fluidcarve_closed");
        if (closed != "true" && closed != "false") throw wrong(fmt::format("'fluidcarve_closed' wants true or false, not '{}'", closed));
        out.closed = closed == "true";
    }

    out.window = read_window(volume, "fluidcarve_window", out.carved());
    out.pair_window = read_window(volume, "fluidcarve_pair_window", out.carved());
    out.anchor = read_anchor(volume, out.carved());

    if (!volume.grids.empty() && !volume.find(seam_name(0))) throw wrong(fmt::format("there is no grid '{}' among {}", seam_name(0), volume.names()));
    const bool paired = volume.find(pair_name(0)) != nullptr;
    const auto count = paired ? (volume.grids.size() + 1) / 2 : volume.grids.size();
    const auto grid_of = [&](const std::string& name) {
        const auto grid = openvdb::GridBase::grid<FloatGrid>(volume.find(name));
        if (!grid)
            throw wrong(fmt::format("the {} grids must be float grids named '{}' to '{}', but there are {}", volume.grids.size(), seam_name(0),
                                    paired ? pair_name(count - 1) : seam_name(count - 1), volume.names()));
        return grid;
    };
    for (std::size_t n = 0; n < count; ++n) {
        const auto grid = grid_of(seam_name(n));
        const auto kind = kind_of(*grid);
        if (n == 0) out.kind = kind;
        if (kind != out.kind) throw wrong(fmt::format("grid '{}' says {}, but '{}' says {}", seam_name(n), to_text(kind), seam_name(0), to_text(out.kind)));
        if (static_cast<int>(n) >= out.carved()) throw wrong(fmt::format("{} seams do not fit {} vertices", count, out.carved()));
        out.seams.push_back(read_seam(*grid, out, out.kind, n));
        if (!paired) continue;
        const auto pair = grid_of(pair_name(n));
        if (kind_of(*pair) != opposite(out.kind))
            throw wrong(
                fmt::format("grid '{}' says {} as '{}' does, but one of a pair removes and the other inserts", pair_name(n), to_text(out.kind), seam_name(n)));
        out.pairs.push_back(read_seam(*pair, out, opposite(out.kind), n));
    }
    if (out.kind == Seams::Kind::insert) require_distinct(out, out.seams, seam_name);
    else require_distinct(out, out.pairs, pair_name);
    if (paired) require_apart(out);
    out.find_shifts();
    return out;
}

void write_seams(const std::string& path, const Seams& seams) { write_vdb(path, seams_to_volume(seams)); }

Seams read_seams(const std::string& path) {
    const auto volume = read_vdb(path);
    try {
        return seams_from_volume(volume);
    } catch (const Failure& failure) {
        throw Failure(fmt::format("{}: {}", path, failure.what()), failure.kind);
    }
}

}  // namespace fluidcarve
