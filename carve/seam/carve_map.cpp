#include "carve/seam/carve_map.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/lattice/mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace fluidcarve {

namespace {

std::string text(const std::array<int, 3>& shape) {
    return fmt::format("{} x {} x {}", shape[0], shape[1], shape[2]);
}

/// Whether seams were found in a lattice. If their hash has another form, the lattice's
/// description decides, except for lattices that change.
bool found_in(const Seams& seams, const std::string& hash, const Lattice& lattice) {
    if (hash.starts_with(lattice_hash_prefix)) return hash == lattice.hash;
    return seams.lattice == lattice.description || hash != seams.lattice_hash;
}

void require_lattice(const Seams& seams, std::size_t t, const Lattice& lattice) {
    const auto hash = seams.lattice_hash_at(t);
    if (!found_in(seams, hash, lattice))
        throw Failure(fmt::format(
            "the seams were found in another lattice: theirs is a {} ({}), this one a {} ({})",
            seams.lattice, hash, lattice.description, lattice.hash));
}

std::size_t frame_index(int frame, const Seams& seams) {
    const auto found = std::ranges::find(seams.frames, frame);
    if (found == seams.frames.end())
        throw Failure(fmt::format("the seams do not hold frame {}; they hold {}", frame,
                                  FrameSet(seams.frames).text()));
    return static_cast<std::size_t>(found - seams.frames.begin());
}

}  // namespace

CarveMap::CarveMap(const Lattice& lattice, const std::vector<Ref<Seams>>& sets, int frame,
                   std::optional<std::size_t> count, std::span<const Softness> softness)
    : reach_(lattice.shape) {
    auto shape = lattice.shape;
    const auto used_of = [&](std::size_t n) {
        return count && n + 1 == sets.size() ? *count : sets[n]->size();
    };
    for (const auto& set : sets)
        if (set->in_time())
            throw Failure(
                "the seams are seams of frames (`axis: t`), which move no content within a frame; "
                "remap.grids carves them, alone");
    std::array<int, 3> origin{};
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto axis = dimension(sets[n]->axis);
        origin[axis] += sets[n]->shift_after(std::min(used_of(n), sets[n]->size()));
        below_[axis] = std::max(below_[axis], -origin[axis]);
    }
    origin = below_;
    for (std::size_t d = 0; d < 3; ++d) reach_[d] += below_[d];
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto& set = *sets[n];
        const auto t = frame_index(frame, set);
        require_lattice(set, t, lattice);
        if (set.shape != shape)
            throw Failure(fmt::format(
                "seam set {} of {} carves {} vertices, but {} leaves {}; list the sets in the "
                "order in which they were found",
                n + 1, sets.size(), text(set.shape),
                n == 0 ? std::string("the lattice") : fmt::format("set {}", n), text(shape)));
        const auto used = used_of(n);
        if (used > set.size())
            throw Failure(fmt::format("count asks for {} seams, but the seam set holds {}", used,
                                      set.size()));
        auto& begin = origin[dimension(set.axis)];
        if (used > 0) {
            auto& step = steps_.emplace_back(set, t, used, origin);
            if (n < softness.size() && softness[n] && !set.warp) soften(step, set, t, softness[n]);
            begin = step.start();
        }
        shape = set.shape_after(used);
        for (std::size_t d = 0; d < 3; ++d) reach_[d] = std::max(reach_[d], shape[d] + origin[d]);
    }
    behind_ = reach_[2] - below_[2] - lattice.shape[2];
}

Lattice CarveMap::extended(const Lattice& lattice) const {
    return fluidcarve::extended(lattice, below_, behind_);
}

bool CarveMap::soft() const {
    return std::ranges::any_of(steps_,
                               [](const CarveStep& step) { return step.soft() != nullptr; });
}

bool CarveMap::joins() const {
    return std::ranges::any_of(steps_,
                               [](const CarveStep& step) { return step.joins() != nullptr; });
}

void CarveMap::fade_rims(double vertices) {
    for (auto& step : steps_) {
        const auto require = [&](int size, const std::string& along) {
            if (size > 1 && size - 1 < 2 * vertices)
                throw Failure(
                    fmt::format("a fade over {:g} vertices from either rim needs {:g} vertices "
                                "along {}, but the lattice has {}; lower `rim_fade`",
                                vertices, std::ceil(2 * vertices) + 1, along, size));
        };
        const auto& columns = step.columns();
        if (!columns.around)
            require(columns.laterals, std::string(1, "uvw"[columns.lateral_axis()]));
        if (!columns.closed) require(columns.slices, std::string(1, "uvw"[columns.slice_axis()]));
        step.fade_rims(vertices);
    }
}

bool CarveMap::rims_fade() const {
    return std::ranges::any_of(steps_, [](const CarveStep& step) { return step.rims_fade(); });
}

bool CarveMap::trace(openvdb::BBoxd& range, bool& frees) const {
    bool moved = false;
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
        const auto& columns = step->columns();
        const auto [a, b, c] = columns.axes;
        const auto meets = [&](int dimension, double first, double last) {
            return range.max()[dimension] >= first - rim_slack &&
                   range.min()[dimension] <= last + rim_slack;
        };
        // A point between an unmoved and a moved entry moves in part.
        if (!meets(a, step->first_moved() - 1, std::min(step->last_moved() + 1, step->high())) ||
            !meets(b, columns.first_lateral, columns.end_lateral()) ||
            !meets(c, columns.first_slice, columns.end_slice()))
            continue;
        moved = true;
        frees = frees || step->may_free(range.min()[a], range.max()[a]);
        range.min()[a] = std::min(
            range.min()[a], std::max<double>(range.min()[a] - step->most_down(), step->origin()));
        range.max()[a] = std::max(range.max()[a], std::min<double>(range.max()[a] + step->most_up(),
                                                                   step->last_before()));
    }
    return moved;
}

openvdb::BBoxd CarveMap::whole() const {
    openvdb::BBoxd out(openvdb::Vec3d(0),
                       openvdb::Vec3d(reach_[0] - 1, reach_[1] - 1, reach_[2] - 1));
    if (!steps_.empty() && (steps_.front().columns().closed || steps_.front().turns()))
        out.max().z() = reach_[2];
    if (!steps_.empty() && steps_.front().columns().around) out.max().y() = reach_[1];
    return out;
}

openvdb::BBoxd CarveMap::moved() const {
    auto out = whole();
    // If several axes are carved, a step along one axis moves vertices over the full length of the
    // others.
    const bool one_axis = std::ranges::all_of(
        steps_, [&](const CarveStep& step) { return step.axis() == steps_.front().axis(); });
    if (steps_.empty() || !one_axis) return out;
    const int axis = steps_.front().axis();
    int first = steps_.front().first_moved(), last = 0;
    for (const auto& step : steps_) {
        first = std::min(first, step.first_moved());
        last = std::max(last, step.last_moved());
    }
    out.min()[axis] = std::max(0, first - 1);
    out.max()[axis] = std::min(last + 1, reach_[static_cast<std::size_t>(axis)] - 1);
    return out;
}

}  // namespace fluidcarve
