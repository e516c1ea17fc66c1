#include "nodes/page/page_scene.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/lattice/alignment.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/carve_map.h"
#include "nodes/page/packed.h"
#include "nodes/page/page_grid.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace fluidcarve {

using Json = nlohmann::ordered_json;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

Json to_json(const Vec3d& at) { return {at.x(), at.y(), at.z()}; }

/// Number of vertices by which a chain of sets may move content along its axes.
int farthest_move(const std::vector<Ref<Seams>>& sets) {
    std::size_t out = 0;
    for (const auto& set : sets) out += set->seams.size();
    return static_cast<int>(out);
}

/// The index box that a page shows: the active voxels of all frames, and the places to which the
/// carve may move them.
CoordBBox shown_box(const std::vector<PageFrame>& frames) {
    CoordBBox out;
    for (const auto& frame : frames) {
        const auto active = frame.before->evalActiveVoxelBoundingBox();
        if (active.empty()) continue;
        out.expand(active);
        if (frame.seams.empty()) continue;
        const CarveMap map(*frame.lattice, frame.seams, frame.number, std::nullopt);
        const auto lattice = map.extended(*frame.lattice);
        const auto& space = frame.before->transform();
        const auto voxel = space.voxelSize();
        const double move = farthest_move(frame.seams) * lattice.spacing /
                            std::min({voxel.x(), voxel.y(), voxel.z()});
        auto moved = padded(active, static_cast<int>(std::min(std::ceil(move), 1e6)));
        moved.intersect(voxels_around(Mapping(lattice, map.reach()).world_box(map.moved()), space,
                                      "the lattice"));
        if (!moved.empty()) out.expand(moved);
    }
    return out.empty() ? CoordBBox(openvdb::Coord(0), openvdb::Coord(0)) : out;
}

/// Number of planes by which carves of any number of seams reach beyond a lattice: before its
/// first plane, and behind its last.
std::array<int, 2> planes_beyond(const Lattice& lattice, const std::vector<Ref<Seams>>& sets) {
    int origin = 0, first = 0, last = lattice.shape[2] - 1;
    for (const auto& set : sets) {
        if (set->axis != Axis::w) continue;
        int begin = origin;
        for (std::size_t count = 0; count <= set->size(); ++count) {
            begin = origin + set->shift_after(count);
            first = std::min(first, begin);
            last = std::max(last, begin + set->shape_after(count)[2] - 1);
        }
        origin = begin;
    }
    return {-first, last - (lattice.shape[2] - 1)};
}

/// Planes in page voxels: of each the position of vertex (0, 0) and the steps to the next vertex
/// along u, v and w.
Json lattice_json(const Lattice& given, const std::vector<Ref<Seams>>& sets, const PageGrid& page) {
    const auto alignment = align(given, *page.space);
    const auto lattice =
        alignment && alignment->one_to_one() ? on_voxels(given, *alignment, *page.space) : given;
    const auto [before, behind] = planes_beyond(given, sets);
    std::vector<double> planes;
    for (const auto& plane : extended(lattice, {0, 0, before}, behind).planes) {
        const auto origin = page.place(plane.origin);
        const auto add = [&](const Vec3d& at) {
            planes.insert(planes.end(), {at.x(), at.y(), at.z()});
        };
        add(origin);
        for (const auto& direction : {plane.u, plane.v, plane.w})
            add(page.place(plane.origin + lattice.spacing * direction) - origin);
    }
    std::vector<std::uint8_t> bytes;
    append_numbers(bytes, planes);
    return {{"shape", lattice.shape},  {"closed", lattice.closed}, {"around", lattice.around},
            {"box", lattice.is_box()}, {"before", before},         {"planes", packed(bytes)}};
}

Json rig_json(const Rig& rig, const PageGrid& page) {
    Json points = Json::array();
    for (const auto& point : rig.points) {
        const auto at = page.place(point);
        for (int n = 0; n < 3; ++n) points.push_back(std::round(100 * at[n]) / 100);
    }
    return {{"closed", rig.closed}, {"points", std::move(points)}};
}

/// Appends entries of the seams of a window as original indices: `[seam][column]`.
/// @param first  of the columns of the frame
void append_entries(const std::vector<Seams::Seam>& window, Seams::Kind kind, std::size_t first,
                    std::size_t columns, std::vector<std::uint16_t>& out) {
    const auto base = out.size();
    out.resize(base + window.size() * columns);
    std::vector<std::uint16_t> entries, scratch;
    for (std::size_t column = 0; column < columns; ++column) {
        entries.clear();
        for (const auto& seam : window) entries.push_back(seam.at[first + column]);
        if (kind == Seams::Kind::remove) to_original(entries, scratch);
        for (std::size_t n = 0; n < entries.size(); ++n)
            out[base + n * columns + column] = entries[n];
    }
}

/// Entries of all seams of a frame as original indices: `[set][window][seam][column]`.
std::vector<std::uint16_t> original_entries(const std::vector<Ref<Seams>>& sets, int frame) {
    std::vector<std::uint16_t> out;
    for (const auto& set : sets) {
        const auto t =
            static_cast<std::size_t>(std::ranges::find(set->frames, frame) - set->frames.begin());
        const auto columns = set->columns_per_frame();
        append_entries(set->seams, set->kind, t * columns, columns, out);
        append_entries(set->pairs, opposite(set->kind), t * columns, columns, out);
    }
    return out;
}

Json set_json(const Seams& set) {
    Json energies = Json::array(), shifts = Json::array();
    for (const auto& seam : set.seams) energies.push_back(seam.energy);
    for (std::size_t count = 0; count <= set.seams.size(); ++count)
        shifts.push_back(set.shift_after(count));
    const auto window = [](const std::optional<Window>& each) {
        return each ? Json{each->first, each->last} : Json();
    };
    return {{"axis", dimension(set.axis)},   {"kind", to_text(set.kind)},
            {"closed", set.closed},          {"around", set.around},
            {"paired", set.paired()},        {"shape", set.shape},
            {"window", window(set.window)},  {"pair_window", window(set.pair_window)},
            {"anchor", to_text(set.anchor)}, {"energies", std::move(energies)},
            {"shifts", std::move(shifts)}};
}

/// Numbers equal things: lattices, rigs and frames of seams that several frames share are written
/// once.
class Shared {
public:
    /// @param make  makes the thing, if it is new
    template <class Make>
    std::size_t number(const std::string& key, const Make& make) {
        const auto [place, fresh] = numbers_.emplace(key, all_.size());
        if (fresh) all_.push_back(make());
        return place->second;
    }
    Json take() { return std::move(all_); }

private:
    std::map<std::string, std::size_t> numbers_;
    Json all_ = Json::array();
};

/// Lowest and highest of many values.
struct Span {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    void add(const std::vector<float>& values) {
        for (const auto value : values) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
};

float background_of(const openvdb::GridBase& grid) {
    return grid.isType<FloatGrid>() ? static_cast<const FloatGrid&>(grid).background()
                                    : static_cast<const VectorGrid&>(grid).background().length();
}

void require_one_space(const std::string& grid, const std::vector<PageFrame>& frames) {
    const auto& first = frames.front();
    if (!first.before->transform().isLinear())
        throw Failure(fmt::format(
            "grid '{}' lies in a frustum; a page shows grids with linear transforms", grid));
    for (const auto& frame : frames)
        if (frame.before->transform() != first.before->transform())
            throw Failure(
                fmt::format("grid '{}' has another transform in frame {} than in frame {}; a page "
                            "shows frames in one space",
                            grid, frame.number, first.number));
}

/// The voxels of a page that shows all frames.
PageGrid page_of(const PageRequest& request, const std::vector<PageFrame>& frames) {
    const auto box = shown_box(frames);
    require_near(request.grid, box);
    const bool flat = box.min().x() == box.max().x() || box.min().y() == box.max().y() ||
                      box.min().z() == box.max().z();
    auto out = page_grid(frames.front().before->transformPtr(), box,
                         flat ? request.flat_voxels : request.voxels);
    // Far more than a page may weigh.
    constexpr std::size_t most_voxels = std::size_t{1} << 28;
    if (out.count() > most_voxels / frames.size())
        throw Failure(
            fmt::format("the page would hold {} voxels in each of {} frames; lower "
                        "`voxels` or `frames`",
                        out.count(), frames.size()));
    return out;
}

/// The grids and energies of all frames in page voxels, with one scale for each.
class PageVolumes {
public:
    PageVolumes(const std::vector<PageFrame>& frames, const PageGrid& page)
        : background_(background_of(*frames.front().before)) {
        Span seen, energy;
        seen.add({background_});
        energy.add({0});
        for (const auto& frame : frames) {
            values_.push_back(page_values(*frame.before, page));
            seen.add(values_.back());
            if (frame.energy) energy.add(energies_.emplace_back(page_values(*frame.energy, page)));
        }
        if (seen.low == seen.high) seen.high += 1;
        if (energy.high == 0) energy.high = 1;
        // The inside of a level set is below 0: it is shown as what there is most of.
        level_set_ = frames.front().before->getGridClass() == openvdb::GRID_LEVEL_SET;
        from_ = level_set_ ? seen.high : seen.low;
        to_ = level_set_ ? seen.low : seen.high;
        energy_high_ = energy.high;
    }
    bool level_set() const { return level_set_; }
    /// The values of a grid that become 0 and 255.
    Json range() const { return {from_, to_}; }
    Json energy_range() const { return energies_.empty() ? Json() : Json{0, energy_high_}; }
    std::uint8_t background() const {
        return page_bytes(std::vector{background_}, from_, to_).front();
    }
    /// Appends the volumes of frame `n`, in the order of frames.
    void append(std::vector<std::uint8_t>& bytes, std::size_t n) const {
        append_differences(bytes, page_bytes(values_[n], from_, to_));
        if (!energies_.empty())
            append_differences(bytes, page_bytes(energies_[n], 0, energy_high_));
    }

private:
    std::vector<std::vector<float>> values_, energies_;
    bool level_set_ = false;
    float background_, from_ = 0, to_ = 0, energy_high_ = 0;
};

/// The entries of the page that hold for all frames.
Json common_json(const PageRequest& request, const PageFrame& first, const PageGrid& page,
                 const PageVolumes& volumes) {
    Json out;
    out["title"] = request.title;
    out["grid"] = request.grid;
    out["levelSet"] = volumes.level_set();
    out["size"] = page.size;
    out["step"] = page.step;
    out["first"] = {page.first.x(), page.first.y(), page.first.z()};
    out["world"] = {to_json(page.world(Vec3d(0))), to_json(page.world({1, 0, 0})),
                    to_json(page.world({0, 1, 0})), to_json(page.world({0, 0, 1}))};
    out["range"] = volumes.range();
    out["background"] = volumes.background();
    out["energyRange"] = volumes.energy_range();
    out["setting"] = request.setting;
    out["count"] = request.count;
    out["softness"] = {{"soft", request.softness.vertices},
                       {"soft_time", request.softness.frames},
                       {"fade", request.rim_fade}};
    out["masks"] = Json::array();
    for (const auto& [name, mask] : first.masks) out["masks"].push_back(name);
    out["sets"] = Json::array();
    for (const auto& set : first.seams) out["sets"].push_back(set_json(*set));
    return out;
}

/// Frames as a page's script reads them, and the lattices, rigs and seams that they share.
class FrameWriter {
public:
    /// @param soft_time  frames by which the carve is soft (Softness)
    FrameWriter(const PageGrid& page, const PageVolumes& volumes, double soft_time)
        : page_(page), volumes_(volumes), reach_(static_cast<int>(std::ceil(soft_time))) {}

    /// Adds frame `n`, in the order of frames.
    void add(const PageFrame& frame, std::size_t n) {
        Json out{{"number", frame.number},
                 {"lattice", nullptr},
                 {"rig", nullptr},
                 {"seams", Json::array()}};
        if (frame.lattice)
            out["lattice"] = lattices_.number(frame.lattice->hash, [&] {
                return lattice_json(*frame.lattice, frame.seams, page_);
            });
        if (frame.rig) {
            const auto rig = rig_json(*frame.rig, page_);
            out["rig"] = rigs_.number(rig.dump(), [&] { return rig; });
        }
        if (!frame.seams.empty()) out["seams"] = seams_around(frame);
        std::vector<std::uint8_t> bytes;
        volumes_.append(bytes, n);
        for (const auto& [name, mask] : frame.masks)
            append_differences(bytes, page_mask(*mask, page_));
        out["voxels"] = packed(bytes);
        list_.push_back(std::move(out));
    }
    /// Hands over all that was added.
    void finish(Json& out) {
        out["lattices"] = lattices_.take();
        out["rigs"] = rigs_.take();
        out["seams"] = seams_.take();
        out["frames"] = std::move(list_);
    }

private:
    /// Numbers of the neighbours' seams in time, this frame in the middle; at an end of the
    /// sequence the last one again (soften()).
    Json seams_around(const PageFrame& frame) {
        Json out = Json::array();
        const auto& numbers = frame.seams.front()->frames;
        const int last = static_cast<int>(numbers.size()) - 1;
        const auto place =
            static_cast<int>(std::ranges::find(numbers, frame.number) - numbers.begin());
        for (int by = -reach_; by <= reach_; ++by) {
            const int number = numbers[static_cast<std::size_t>(std::clamp(place + by, 0, last))];
            out.push_back(seams_.number(std::to_string(number), [&] {
                std::vector<std::uint8_t> bytes;
                append_differences(bytes, original_entries(frame.seams, number));
                return packed(bytes);
            }));
        }
        return out;
    }

    const PageGrid& page_;
    const PageVolumes& volumes_;
    int reach_;
    Shared lattices_, rigs_, seams_;
    Json list_ = Json::array();
};

}  // namespace

Json page_scene(const PageRequest& request, const std::vector<PageFrame>& frames) {
    require_one_space(request.grid, frames);
    const auto page = page_of(request, frames);
    const PageVolumes volumes(frames, page);
    auto out = common_json(request, frames.front(), page, volumes);
    FrameWriter writer(page, volumes, request.softness.frames);
    for (std::size_t n = 0; n < frames.size(); ++n) writer.add(frames[n], n);
    writer.finish(out);
    return out;
}

}  // namespace fluidcarve
