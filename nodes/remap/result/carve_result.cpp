#include "nodes/remap/result/carve_result.h"

#include "graph/types/frames.h"
#include "nodes/io/triplet.h"
#include "nodes/remap/result/grid_measure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;
using openvdb::Vec3d;

constexpr double same_share = 1e-4, same_voxels = 0.01;  ///< smaller changes of mass and place count as none
constexpr double nothing_share = 1e-6;                   ///< share of the mass that counts as nothing left
constexpr double much_mass = 1.0 / 3;                    ///< change of the mass from which on it is warned of
constexpr double far_voxels = 10;                        ///< the same for the way that the start moved

Json to_json(const Vec3d& vector) { return Json::array({vector.x(), vector.y(), vector.z()}); }

Json to_json(const GridMeasure& measure) {
    Json out = Json::object();
    if (!measure.box.empty()) out["box"] = Json::array({to_json(measure.box.min()), to_json(measure.box.max())});
    out["mass"] = measure.mass;
    if (measure.highest) out["highest"] = *measure.highest;
    if (measure.mass > 0) out["centre"] = to_json(measure.centre);
    return out;
}

double number_in(const Json& value) { return value.is_number() ? value.get<double>() : 0; }
Vec3d vector_in(const Json& value) { return {number_in(value.at(0)), number_in(value.at(1)), number_in(value.at(2))}; }

GridMeasure measure_in(const Json& entry) {
    GridMeasure out;
    if (entry.contains("box")) out.box = {vector_in(entry.at("box").at(0)), vector_in(entry.at("box").at(1))};
    out.mass = number_in(entry.at("mass"));
    if (entry.contains("highest")) out.highest = number_in(entry.at("highest"));
    if (entry.contains("centre")) out.centre = vector_in(entry.at("centre"));
    return out;
}

bool unchanged(const GridMeasure& a, const GridMeasure& b, double voxel) {
    const auto near = [&](const Vec3d& one, const Vec3d& other) { return (one - other).length() <= same_voxels * voxel; };
    if (a.box.empty() || b.box.empty()) return a.box.empty() == b.box.empty();
    return std::abs(a.mass - b.mass) <= same_share * a.mass && near(a.box.min(), b.box.min()) && near(a.box.max(), b.box.max()) && near(a.centre, b.centre);
}

/// Whether a box is one voxel thick: what lies in it is a picture, not something that starts anywhere.
bool is_picture(const openvdb::BBoxd& box, double voxel) {
    const auto size = box.extents();
    return !box.empty() && std::min({size.x(), size.y(), size.z()}) < 1.5 * voxel;
}

bool nothing_left(double mass_before, double mass_after) { return mass_before > 0 && mass_after <= nothing_share * mass_before; }

/// A grid before or after the carve, over all frames.
struct OverFrames {
    openvdb::BBoxd box;  ///< around the boxes of all frames
    double mass = 0;     ///< sum over the frames
    std::optional<double> highest;
    Vec3d moment{0};        ///< sum of mass times centre
    double steps = 0;       ///< sum of the mass's absolute changes from frame to frame
    std::size_t pairs = 0;  ///< number of neighbouring frames

    /// @param before  of the frame before; null if there is none
    void add(const GridMeasure& now, const GridMeasure* before) {
        if (!now.box.empty()) box.expand(now.box);
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

/// What a carve did to a grid.
struct GridResult {
    std::size_t frames = 0;
    OverFrames before, after;
    bool same = true;              ///< in all frames
    std::vector<int> lost;         ///< numbers of the frames where nothing is left
    std::size_t full = 0;          ///< number of frames where there was something
    double moved = 0;              ///< how far the centre moved in the first frame with content, voxels; of a picture 0
    std::optional<int> starts_at;  ///< number of that frame
    std::optional<std::pair<GridMeasure, GridMeasure>> last;

    /// @param neighbour  whether the frame before was added last
    void add(int frame, const Json& entry, bool neighbour) {
        const std::pair now(measure_in(entry.at("before")), measure_in(entry.at("after")));
        const double voxel = number_in(entry.at("voxel"));
        const bool follows = neighbour && last;
        before.add(now.first, follows ? &last->first : nullptr);
        after.add(now.second, follows ? &last->second : nullptr);
        ++frames;
        same = same && unchanged(now.first, now.second, voxel);
        if (now.first.mass > 0) {
            ++full;
            const bool none = nothing_left(now.first.mass, now.second.mass);
            if (none) lost.push_back(frame);
            if (!starts_at) {
                starts_at = frame;
                if (!none && !is_picture(now.first.box, voxel)) moved = (now.second.centre - now.first.centre).length() / voxel;
            }
        }
        last = now;
    }
    bool empty() const { return before.mass == 0; }
    bool gone() const { return nothing_left(before.mass, after.mass); }
    double change() const { return after.mass / before.mass - 1; }  ///< of the mass, as a share
};

using GridResults = std::vector<std::pair<std::string, GridResult>>;  ///< by grid name, in the order of the file

/// A share as text, with its sign: "-2.0 %".
std::string signed_percent(double share) {
    const double tenths = std::round(share * 1000);
    return fmt::format("{:+.1f} %", tenths == 0 ? 0.0 : tenths / 10);
}

std::string size_of(const openvdb::BBoxd& box) {
    const auto size = box.empty() ? Vec3d(0) : box.extents();
    return fmt::format("{:.3g} x {:.3g} x {:.3g}", size.x(), size.y(), size.z());
}

std::string line_of(const std::string& name, const GridResult& grid) {
    const auto size = size_of(grid.before.box);
    if (grid.gone()) return fmt::format("{} {} -> nothing", name, size);
    if (grid.same) return fmt::format("{} {}, nothing changed", name, size);
    auto out = fmt::format("{} {} -> {}, mass {}", name, size, size_of(grid.after.box), signed_percent(grid.change()));
    if (grid.after.highest) out += fmt::format(", highest {:.2f} of before", *grid.after.highest / *grid.before.highest);
    return out;
}

/// The frames that the entries are of, in the order of time; for a single entry of another name, the first frame.
std::vector<std::pair<std::size_t, const Json*>> in_time(const Json& frames, const std::vector<int>& sequence) {
    std::map<int, const Json*> by_number;
    for (const auto& [name, entry] : frames.items()) {
        int number = sequence.front();
        std::from_chars(name.data(), name.data() + name.size(), number);
        by_number[number] = &entry;
    }
    std::vector<std::pair<std::size_t, const Json*>> out;
    for (std::size_t place = 0; place < sequence.size(); ++place)
        if (const auto found = by_number.find(sequence[place]); found != by_number.end()) out.emplace_back(place, found->second);
    return out;
}

GridResults over_frames(const Json& frames, const std::vector<int>& sequence) {
    GridResults out;
    std::map<std::string, std::size_t> last_place;
    for (const auto& [place, entry] : in_time(frames, sequence))
        for (const auto& [name, grid] : entry->items()) {
            auto found = std::find_if(out.begin(), out.end(), [&wanted = name](const auto& each) { return each.first == wanted; });
            if (found == out.end()) found = out.emplace(out.end(), name, GridResult());
            const auto last = last_place.find(name);
            found->second.add(sequence[place], grid, last != last_place.end() && last->second + 1 == place);
            last_place[name] = place;
        }
    return out;
}

void warn_of_nothing_changed(const GridResults& grids, const Context& context) {
    std::vector<std::string> names;
    for (const auto& [name, grid] : grids)
        if (!grid.empty() && grid.same) names.push_back(name);
    if (!names.empty())
        context.warn(fmt::format(
            "the carve changed nothing in {}; if the lattice lies beside it, move or widen the lattice (`fit` of lattice.box; `rig`, `extent_u` and "
            "`extent_v` of lattice.build); if only the space beside it is carved, connect it as `field` of the solver, or raise the solver's `empty`",
            fmt::join(names, ", ")));
}

void warn_of_nothing_left(const GridResults& grids, const Context& context) {
    std::map<std::string, std::vector<std::string>> names;  // by frames
    for (const auto& [name, grid] : grids)
        if (!grid.lost.empty())
            names[grid.lost.size() == grid.full ? "" : (grid.lost.size() == 1 ? " in frame " : " in frames ") + FrameSet(grid.lost).text()].push_back(name);
    for (const auto& [where, lost] : names)
        context.warn(
            fmt::format("nothing is left of {}{}; carve less (`count` of seams, `amount` of a warp), or keep the carve off it (`protect` of the solver)",
                        fmt::join(lost, ", "), where));
}

void warn_of_mass(const GridResults& grids, const Context& context) {
    std::vector<std::string> changes;
    for (const auto& [name, grid] : grids)
        if (!grid.empty() && !grid.gone() && std::abs(grid.change()) >= much_mass) changes.push_back(fmt::format("{} {}", name, signed_percent(grid.change())));
    if (!changes.empty())
        context.warn(
            fmt::format("the carve changed the mass by a third or more: {}; carve less (`count` of seams, `amount` of a warp), keep the carve off the content "
                        "(`protect` of the solver), or "
                        "keep the mass of densities (`conserve`)",
                        fmt::join(changes, ", ")));
}

void warn_of_moved_start(const GridResults& grids, const Context& context) {
    const auto farthest =
        std::max_element(grids.begin(), grids.end(), [](const auto& one, const auto& other) { return one.second.moved < other.second.moved; });
    if (farthest == grids.end() || farthest->second.moved < far_voxels) return;
    const auto& [name, grid] = *farthest;
    context.warn(
        fmt::format("{} starts {:.1f} voxels from where it was, by its centre in frame {}; if its source must stay in place, set `anchor` of the solver", name,
                    grid.moved, *grid.starts_at));
}

}  // namespace

Json compared(const Volume& before, const Volume& after) {
    Json out = Json::object();
    for (std::size_t n = 0; n < before.grids.size(); ++n) {
        const auto& given = *before.grids[n];
        if (out.contains(given.getName()) || triplet_of(before, given)) continue;
        const auto first = measured(given);
        if (!first) continue;
        const auto second = after.grids.at(n) == before.grids[n] ? first : measured(*after.grids[n]);
        out[given.getName()] = {{"voxel", voxel_edge(given)}, {"before", to_json(*first)}, {"after", to_json(*second)}};
    }
    return out;
}

void tell_result(const Json& frames, Context& context) {
    const auto grids = over_frames(frames, context.frames());
    Json entry = Json::object();
    for (const auto& [name, grid] : grids) {
        entry[name] = {{"frames", grid.frames}, {"before", grid.before.to_report(grid.frames)}, {"after", grid.after.to_report(grid.frames)}};
        if (!grid.empty()) context.tell(line_of(name, grid));
    }
    context.report(carved_grids, entry);
    warn_of_nothing_changed(grids, context);
    warn_of_nothing_left(grids, context);
    warn_of_mass(grids, context);
    warn_of_moved_start(grids, context);
}

}  // namespace fluidcarve
