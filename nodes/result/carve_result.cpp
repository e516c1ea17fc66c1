#include "nodes/result/carve_result.h"

#include "carve/base/frame_set.h"
#include "carve/base/numbers.h"
#include "carve/volume/triplet.h"
#include "nodes/result/grid_measure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;
using openvdb::Vec3d;

constexpr double same_share = 1e-4,
                 same_voxels = 0.01;    ///< smaller changes of mass and place count as none
constexpr double nothing_share = 1e-6;  ///< share of the mass that counts as nothing left
constexpr double much_mass = 1.0 / 3;   ///< change of the mass from which on there is a warning
/// Least difference from the change by even scaling to the same size, for a warning.
constexpr double unlike_even = 0.2;
/// An end of the content that moves by fewer voxels over the sequence stands still.
constexpr double steady_voxels = 1.5;
constexpr double far_voxels = 5;  ///< displacement of the source from which on there is a warning

Json to_json(const Vec3d& vector) { return Json::array({vector.x(), vector.y(), vector.z()}); }

Json to_json(const GridMeasure& measure) {
    Json out = Json::object();
    if (!measure.box.empty())
        out["box"] = Json::array({to_json(measure.box.min()), to_json(measure.box.max())});
    out["mass"] = measure.mass;
    if (measure.highest) out["highest"] = *measure.highest;
    if (measure.mass > 0) out["centre"] = to_json(measure.centre);
    return out;
}

double number_in(const Json& value) { return value.is_number() ? value.get<double>() : 0; }
Vec3d vector_in(const Json& value) {
    return {number_in(value.at(0)), number_in(value.at(1)), number_in(value.at(2))};
}

GridMeasure measure_in(const Json& entry) {
    GridMeasure out;
    if (entry.contains("box"))
        out.box = {vector_in(entry.at("box").at(0)), vector_in(entry.at("box").at(1))};
    out.mass = number_in(entry.at("mass"));
    if (entry.contains("highest")) out.highest = number_in(entry.at("highest"));
    if (entry.contains("centre")) out.centre = vector_in(entry.at("centre"));
    return out;
}

bool unchanged(const GridMeasure& a, const GridMeasure& b, double voxel) {
    const auto near = [&](const Vec3d& one, const Vec3d& other) {
        return (one - other).length() <= same_voxels * voxel;
    };
    if (a.box.empty() || b.box.empty()) return a.box.empty() == b.box.empty();
    return std::abs(a.mass - b.mass) <= same_share * a.mass && near(a.box.min(), b.box.min()) &&
           near(a.box.max(), b.box.max()) && near(a.centre, b.centre);
}

/// Whether a box is one voxel thick: its content is a picture, which has no source.
bool is_picture(const openvdb::BBoxd& box, double voxel) {
    const auto size = box.extents();
    return !box.empty() && std::min({size.x(), size.y(), size.z()}) < 1.5 * voxel;
}

bool nothing_left(double mass_before, double mass_after) {
    return mass_before > 0 && mass_after <= nothing_share * mass_before;
}

/// A grid before or after the carve, over all frames.
struct OverFrames {
    openvdb::BBoxd box;  ///< around the boxes of all frames
    double mass = 0;     ///< sum over the frames
    std::optional<double> highest;
    Vec3d moment{0};        ///< sum of mass times centre
    double volume = 0;      ///< sum of the volumes of the frames' boxes
    double steps = 0;       ///< sum of the mass's absolute changes from frame to frame
    std::size_t pairs = 0;  ///< number of neighbouring frames

    /// @param before  of the frame before; null if there is none
    void add(const GridMeasure& now, const GridMeasure* before) {
        if (!now.box.empty()) {
            box.expand(now.box);
            volume += now.box.extents().product();
        }
        mass += now.mass;
        if (now.highest) highest = std::max(highest.value_or(0), *now.highest);
        moment += now.mass * now.centre;
        if (!before) return;
        steps += std::abs(now.mass - before->mass);
        ++pairs;
    }
    Json to_report(std::size_t frames) const {
        const double mean = mass / static_cast<double>(frames);
        Json out = to_json(GridMeasure{box, mean, highest, mass > 0 ? moment / mass : Vec3d(0)});
        if (pairs > 0 && mass > 0) out["flicker"] = steps / static_cast<double>(pairs) / mean;
        return out;
    }
};

/// An end of a grid's content along an axis, over the frames, world units.
struct End {
    double lowest = std::numeric_limits<double>::infinity(),
           highest = -lowest;  ///< before the carve
    double moved = 0;          ///< by the carve, at most
    int frame = 0;             ///< frame of that displacement

    void add(int number, double before, double after) {
        lowest = std::min(lowest, before);
        highest = std::max(highest, before);
        if (std::abs(after - before) <= moved) return;
        moved = std::abs(after - before);
        frame = number;
    }
    double range() const { return highest - lowest; }
};

/// The effect of a carve on a grid.
struct GridResult {
    std::size_t frames = 0;
    OverFrames before, after;
    bool same = true;         ///< in all frames
    std::vector<int> lost;    ///< numbers of the frames where nothing is left
    std::size_t full = 0;     ///< number of frames with content
    std::array<End, 6> ends;  ///< of the content: lowest and highest along x, y and z
    double voxel = 0;         ///< edge
    bool picture = false;     ///< in any frame
    bool surface = false;     ///< whether it is a level set
    std::optional<std::pair<GridMeasure, GridMeasure>> last;

    /// @param neighbour  whether the frame before was added last
    void add(int frame, const Json& entry, bool neighbour) {
        const std::pair now(measure_in(entry.at("before")), measure_in(entry.at("after")));
        voxel = number_in(entry.at("voxel"));
        surface = entry.contains("level_set");
        const bool follows = neighbour && last;
        before.add(now.first, follows ? &last->first : nullptr);
        after.add(now.second, follows ? &last->second : nullptr);
        ++frames;
        same = same && unchanged(now.first, now.second, voxel);
        if (now.first.mass > 0) {
            ++full;
            const bool none = nothing_left(now.first.mass, now.second.mass);
            if (none) lost.push_back(frame);
            picture = picture || is_picture(now.first.box, voxel);
            if (!none && !now.first.box.empty() && !now.second.box.empty())
                for (int axis = 0; axis < 3; ++axis) {
                    ends[2 * static_cast<std::size_t>(axis)].add(frame, now.first.box.min()[axis],
                                                                 now.second.box.min()[axis]);
                    ends[2 * static_cast<std::size_t>(axis) + 1].add(
                        frame, now.first.box.max()[axis], now.second.box.max()[axis]);
                }
        }
        last = now;
    }
    /// The end that stands still over the sequence while the other end moves, if the carve moved
    /// it far. It is taken for the source.
    const End* moved_source() const {
        if (picture || full < 2) return nullptr;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto &low = ends[2 * axis], &high = ends[2 * axis + 1];
            const bool low_stands = low.range() < steady_voxels * voxel,
                       high_stands = high.range() < steady_voxels * voxel;
            const auto& source = low_stands ? low : high;
            if (low_stands != high_stands && source.moved >= far_voxels * voxel) return &source;
        }
        return nullptr;
    }
    /// Change of the mass that even scaling to the same size would bring, as a share.
    double even_change() const { return before.volume > 0 ? after.volume / before.volume - 1 : 0; }
    bool empty() const { return before.mass == 0; }
    /// Whether it has one value everywhere in its boxes, as far as the sum tells.
    bool flat() const {
        constexpr double nearly = 0.999;
        return before.highest && before.mass >= nearly * *before.highest * before.volume;
    }
    bool gone() const { return nothing_left(before.mass, after.mass); }
    double change() const { return after.mass / before.mass - 1; }  ///< of the mass, as a share
};

using GridResults =
    std::vector<std::pair<std::string, GridResult>>;  ///< by grid name, in the order of the file

/// A share as text, with its sign: "-2.0 %".
std::string signed_percent(double share) {
    const double tenths = std::round(share * 1000);
    return fmt::format("{:+.1f} %", tenths == 0 ? 0.0 : tenths / 10);
}

std::string box_text(const openvdb::BBoxd& box) {
    const auto size = box.empty() ? Vec3d(0) : box.extents();
    return fmt::format("{:.3g} x {:.3g} x {:.3g}", size.x(), size.y(), size.z());
}

std::string line_of(const std::string& name, const GridResult& grid) {
    const auto size = box_text(grid.before.box);
    if (grid.gone()) return fmt::format("{} {} -> nothing", name, size);
    if (grid.same) return fmt::format("{} {}, nothing changed", name, size);
    auto out = fmt::format("{} {} -> {}, mass {}", name, size, box_text(grid.after.box),
                           signed_percent(grid.change()));
    if (grid.after.highest)
        out +=
            fmt::format(", highest {:.2f} of before", *grid.after.highest / *grid.before.highest);
    return out;
}

/// The frames that the entries are of, in the order of time; for a single entry of another name,
/// the first frame.
std::vector<std::pair<std::size_t, const Json*>> in_time(const Json& frames,
                                                         const std::vector<int>& sequence) {
    std::map<int, const Json*> by_number;
    for (const auto& [name, entry] : frames.items()) {
        by_number[number_of<int>(name).value_or(sequence.front())] = &entry;
    }
    std::vector<std::pair<std::size_t, const Json*>> out;
    for (std::size_t t = 0; t < sequence.size(); ++t)
        if (const auto found = by_number.find(sequence[t]); found != by_number.end())
            out.emplace_back(t, found->second);
    return out;
}

/// Grids that are level sets in some frames and densities in others count as two: volumes and
/// amounts have no sum.
GridResults over_frames(const Json& frames, const std::vector<int>& sequence) {
    GridResults out;
    std::map<std::string, std::size_t> last_t;
    const auto entries = in_time(frames, sequence);
    std::map<std::string, std::set<bool>> classes;
    for (const auto& [t, entry] : entries)
        for (const auto& [name, grid] : entry->items())
            classes[name].insert(grid.contains("level_set"));
    for (const auto& [t, entry] : entries)
        for (const auto& [given, grid] : entry->items()) {
            const auto name =
                classes[given].size() == 1
                    ? given
                    : given + (grid.contains("level_set") ? " (level set)" : " (no level set)");
            auto found =
                std::ranges::find_if(out, [&](const auto& each) { return each.first == name; });
            if (found == out.end()) found = out.emplace(out.end(), name, GridResult());
            const auto last = last_t.find(name);
            found->second.add(sequence[t], grid, last != last_t.end() && last->second + 1 == t);
            last_t[name] = t;
        }
    return out;
}

void warn_of_nothing_changed(const GridResults& grids, const Context& context) {
    std::vector<std::string> names;
    for (const auto& [name, grid] : grids)
        if (!grid.empty() && grid.same) names.push_back(name);
    if (!names.empty())
        context.warn(
            fmt::format("the carve changed nothing in {}; if the lattice lies beside it, move or "
                        "widen the lattice (`fit` of lattice.box; `rig`, `extent_u` and "
                        "`extent_v` of lattice.build); if only the space beside it is carved, "
                        "connect it as `field` of the solver, or raise the solver's `empty`",
                        fmt::join(names, ", ")));
}

void warn_of_nothing_left(const GridResults& grids, const Context& context) {
    std::map<std::string, std::vector<std::string>> names;  // by frames
    for (const auto& [name, grid] : grids)
        if (!grid.lost.empty())
            names[grid.lost.size() == grid.full
                      ? ""
                      : (grid.lost.size() == 1 ? " in frame " : " in frames ") +
                            FrameSet(grid.lost).text()]
                .push_back(name);
    for (const auto& [where, lost] : names)
        context.warn(
            fmt::format("nothing is left of {}{}; carve less (`count` of seams, `amount` of a "
                        "warp), or keep the carve off it (`protect` of the solver)",
                        fmt::join(lost, ", "), where));
}

void warn_of_mass(const GridResults& grids, const Context& context) {
    // Beside other grids with content, a grid of one value does not count.
    const bool content = std::ranges::any_of(
        grids, [](const auto& each) { return !each.second.empty() && !each.second.flat(); });
    std::vector<std::string> changes;
    for (const auto& [name, grid] : grids)
        // A river's box does not tell its width, and the mass of a surface is not conserved.
        if (!grid.surface && !grid.empty() && !grid.gone() && !(content && grid.flat()) &&
            std::abs(grid.change()) >= much_mass &&
            std::abs((1 + grid.change()) / (1 + grid.even_change()) - 1) >= unlike_even)
            changes.push_back(fmt::format("{} {}, even scaling {}", name,
                                          signed_percent(grid.change()),
                                          signed_percent(grid.even_change())));
    if (!changes.empty())
        context.warn(
            fmt::format("the carve changed the mass by far more or less than even scaling to the "
                        "same size: {}; carve less (`count` of seams, `amount` of a warp), keep "
                        "the carve off the content (`protect` of the solver), or keep the mass of "
                        "densities (`conserve`)",
                        fmt::join(changes, "; ")));
}

void warn_of_moved_source(const GridResults& grids, const Context& context) {
    for (const auto& [name, grid] : grids)
        if (const auto* const end = grid.moved_source())
            return context.warn(
                fmt::format("the end of {} that stands still over the sequence, where its source "
                            "is, moved by {:.1f} voxels in frame {}; if it must stay in "
                            "place, set `anchor` of the solver",
                            name, end->moved / grid.voxel, end->frame));
}

}  // namespace

Json compared(const Volume& before, const Volume& after) {
    Json out = Json::object();
    const auto names = before.unique_names();
    for (std::size_t n = 0; n < before.grids.size(); ++n) {
        const auto& given = before.grids[n].header();
        if (triplet_of(before, given)) continue;
        const auto first = measured(*before.grids[n].grid());
        if (!first) continue;
        const auto second =
            after.grids.at(n) == before.grids[n] ? first : measured(*after.grids[n].grid());
        out[names[n]] = {
            {"voxel", voxel_edge(given)}, {"before", to_json(*first)}, {"after", to_json(*second)}};
        if (given.getGridClass() == openvdb::GRID_LEVEL_SET) out[names[n]]["level_set"] = true;
    }
    return out;
}

void report_result(const Json& frames, Context& context) {
    const auto grids = over_frames(frames, context.frames());
    Json entry = Json::object();
    for (const auto& [name, grid] : grids) {
        entry[name] = {{"frames", grid.frames},
                       {"before", grid.before.to_report(grid.frames)},
                       {"after", grid.after.to_report(grid.frames)}};
        if (!grid.empty()) context.tell(line_of(name, grid));
    }
    context.report(carved_grids, entry);
    warn_of_nothing_changed(grids, context);
    warn_of_nothing_left(grids, context);
    warn_of_mass(grids, context);
    warn_of_moved_source(grids, context);
}

}  // namespace fluidcarve
