#include "nodes/remap/carve_map.h"

#include "graph/frames.h"
#include "graph/problem.h"
#include "nodes/lattice/mapping.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

std::string text(const std::array<int, 3>& shape) { return fmt::format("{} x {} x {}", shape[0], shape[1], shape[2]); }

void require_lattice(const Seams& seams, std::size_t t, const Lattice& lattice) {
    const auto hash = seams.lattice_hash_at(t);
    if (hash != lattice.hash)
        throw Failure(fmt::format("the seams were found in another lattice: theirs is a {} ({}), this one a {} ({})", seams.lattice, hash, lattice.description,
                                  lattice.hash));
}

std::size_t place_of(int frame, const Seams& seams) {
    const auto found = std::find(seams.frames.begin(), seams.frames.end(), frame);
    if (found == seams.frames.end()) throw Failure(fmt::format("the seams do not hold frame {}; they hold {}", frame, FrameSet(seams.frames).text()));
    return static_cast<std::size_t>(found - seams.frames.begin());
}

/// One column's entries of the first `count` seams of a window.
/// @param sorted  becomes their original indices, rising
void sort_entries(const std::vector<Seams::Seam>& seams, Seams::Kind kind, std::size_t count, std::size_t column, std::vector<std::uint16_t>& entries,
                  std::vector<std::uint16_t>& sorted) {
    entries.clear();
    for (std::size_t n = 0; n < count; ++n) entries.push_back(seams[n].at[column]);
    if (kind == Seams::Kind::remove) return to_original(entries, sorted);
    sorted = entries;
    std::sort(sorted.begin(), sorted.end());
}

}  // namespace

CarveStep::CarveStep(const Seams& seams, std::size_t t, std::size_t count, const std::array<int, 2>& origin)
    : axis_(static_cast<int>(seams.axis)),
      before_(seams.carved()),
      laterals_(seams.lateral()),
      slices_(seams.shape[2]),
      first_lateral_(origin[static_cast<std::size_t>(1 - axis_)]),
      origin_(origin[static_cast<std::size_t>(axis_)]),
      start_(origin_ + seams.shift_after(count)),
      inserts_(seams.kind == Seams::Kind::insert),
      paired_(seams.paired()),
      closed_(seams.closed),
      count_(count),
      bounds_((paired_ ? 2 : 1) * count * seams.columns_per_frame()) {
    if (high() > most_vertices) throw Failure(fmt::format("{} vertices along {} are more than {}", high() + 1, to_text(seams.axis), most_vertices + 1));
    const auto columns = seams.columns_per_frame();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
        std::vector<std::uint16_t> entries, sorted;
        for (auto c = range.begin(); c < range.end(); ++c) {
            auto* out = bounds_.data() + c * (bounds_.size() / columns);
            const auto add = [&](const std::vector<Seams::Seam>& window, bool inserts, int shift) {
                sort_entries(window, inserts ? Seams::Kind::insert : Seams::Kind::remove, count, t * columns + c, entries, sorted);
                // The n-th removed entry is passed by n removals before it; the n-th new entry stands behind its original and n others.
                for (int n = 0; n < static_cast<int>(count); ++n) *out++ = static_cast<std::uint16_t>(shift + (inserts ? sorted[n] + n + 1 : sorted[n] - n));
            };
            add(seams.seams, inserts_, start_);
            if (paired_) add(seams.pairs, !inserts_, start_ + (inserts_ ? this->count() : -this->count()));
        }
    });
    first_moved_ = start_ == origin_ ? high() + 1 : low();
    last_moved_ = paired_ ? 0 : high();
    for (std::size_t c = 0; c < columns && count > 0; ++c) {
        const auto* const column = bounds_.data() + c * (bounds_.size() / columns);
        first_moved_ = std::min<int>(first_moved_, column[0]);
        // From the last removal on, or behind the last new entry, all is as it was.
        if (paired_) last_moved_ = std::max<int>(last_moved_, column[2 * count - 1] - (inserts_ ? 1 : 0));
    }
}

void CarveStep::soften(const Seams& seams, std::size_t t, const Softness& softness) {
    const int reach = static_cast<int>(std::ceil(softness.frames)), last = static_cast<int>(seams.frames.size()) - 1;
    std::vector<CarveStep> others;
    others.reserve(2 * static_cast<std::size_t>(reach));
    std::vector<const CarveStep*> steps;
    std::array<int, 2> origin{};
    origin[static_cast<std::size_t>(axis_)] = origin_;
    origin[static_cast<std::size_t>(1 - axis_)] = first_lateral_;
    for (int n = -reach; n <= reach; ++n) {
        const int near = std::clamp(static_cast<int>(t) + n, 0, last);
        if (near != static_cast<int>(t)) steps.push_back(&others.emplace_back(seams, static_cast<std::size_t>(near), count_, origin));
        else steps.push_back(this);
    }
    soft_ = std::make_shared<const SmoothDisplacement>(SmoothDisplacement::soft(steps, windows(seams), softness));
    first_moved_ = start_ == origin_ ? soft_->first() + 1 : low();
    if (paired_) last_moved_ = soft_->last() - 1;
}

std::vector<SmoothDisplacement::Span> CarveStep::windows(const Seams& seams) const {
    const double whole = origin_ - start_, net = inserts_ ? -count() : count();
    const auto last_of = [&](const Window& window, bool inserts) { return window.last + (inserts ? count() : -count()); };
    if (!paired_) {
        const auto window = seams.window.value_or(Window{0, before_ - 1});
        return {{{start_ + window.first, start_ + last_of(window, inserts_)}, whole, whole + net}};
    }
    std::array<Window, 2> out{Window{high(), low()}, Window{high(), low()}};
    if (seams.window && seams.pair_window) {
        const int moved = start_ + (inserts_ ? count() : -count());
        out = {Window{start_ + seams.window->first, start_ + last_of(*seams.window, inserts_)},
               Window{moved + seams.pair_window->first, moved + last_of(*seams.pair_window, !inserts_)}};
    } else {
        // Those of a foreign file begin and end where seams do.
        for (std::size_t c = 0; c < bounds_.size(); c += 2 * count_)
            for (std::size_t n = 0; n < 2; ++n) {
                out[n].first = std::min<int>(out[n].first, bounds_[c + n * count_]);
                out[n].last = std::max<int>(out[n].last, bounds_[c + (n + 1) * count_ - 1]);
            }
    }
    return {{out[0], 0, net}, {out[1], net, 0}};
}

CarveMap::CarveMap(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& sets, int frame, std::optional<std::size_t> count,
                   const Softness& softness)
    : reach_(lattice.shape) {
    auto shape = lattice.shape;
    const auto used_of = [&](std::size_t n) { return count && n + 1 == sets.size() ? *count : sets[n]->seams.size(); };
    std::array<int, 2> origin{};
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto axis = static_cast<std::size_t>(sets[n]->axis);
        origin[axis] += sets[n]->shift_after(std::min(used_of(n), sets[n]->seams.size()));
        below_[axis] = std::max(below_[axis], -origin[axis]);
    }
    origin = below_;
    for (std::size_t d = 0; d < 2; ++d) reach_[d] += below_[d];
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto& set = *sets[n];
        const auto t = place_of(frame, set);
        require_lattice(set, t, lattice);
        if (set.shape != shape)
            throw Failure(fmt::format("seam set {} of {} carves {} vertices, but {} leaves {}; list the sets in the order in which they were found", n + 1,
                                      sets.size(), text(set.shape), n == 0 ? std::string("the lattice") : fmt::format("set {}", n), text(shape)));
        const auto used = used_of(n);
        if (used > set.seams.size()) throw Failure(fmt::format("count asks for {} seams, but the seam set holds {}", used, set.seams.size()));
        auto& begin = origin[static_cast<std::size_t>(set.axis)];
        if (used > 0) {
            auto& step = steps_.emplace_back(set, t, used, origin);
            if (softness) step.soften(set, t, softness);
            begin = step.start();
        }
        shape = set.shape_after(used);
        for (std::size_t d = 0; d < 3; ++d) reach_[d] = std::max(reach_[d], shape[d] + (d < 2 ? origin[d] : 0));
    }
}

Lattice CarveMap::extended(const Lattice& lattice) const { return extended_below(lattice, below_); }

bool CarveMap::soft() const {
    return std::any_of(steps_.begin(), steps_.end(), [](const CarveStep& step) { return step.soft() != nullptr; });
}

void CarveMap::fade(double vertices) {
    for (auto& step : steps_) {
        const auto require = [&](int size, const std::string& along) {
            if (size > 1 && size - 1 < 2 * vertices)
                throw Failure(fmt::format("a fade over {:g} vertices from either rim needs {:g} vertices along {}, but the lattice has {}; lower `fade`",
                                          vertices, std::ceil(2 * vertices) + 1, along, size));
        };
        require(step.laterals(), step.axis() == 0 ? "v" : "u");
        if (!step.closed()) require(step.slices(), "w");
        step.fade(vertices);
    }
}

bool CarveMap::fades() const {
    return std::any_of(steps_.begin(), steps_.end(), [](const CarveStep& step) { return step.fades(); });
}

bool CarveMap::trace(openvdb::BBoxd& range, bool& frees) const {
    bool moved = false;
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
        const int a = step->axis(), b = step->lateral_axis();
        const auto meets = [&](int dimension, double first, double last) {
            return range.max()[dimension] >= first - Mapping::slack && range.min()[dimension] <= last + Mapping::slack;
        };
        // A point between an entry and a moved one moves in part.
        if (!meets(a, step->first_moved() - 1, std::min(step->last_moved() + 1, step->high())) || !meets(b, step->first_lateral(), step->last_lateral()) ||
            !meets(2, 0, step->slices() - (step->closed() ? 0 : 1)))
            continue;
        moved = true;
        frees = frees || (step->start() > step->origin() && range.min()[a] < step->start()) ||
                (step->last() < step->last_before() && range.max()[a] > step->last());
        // What a vertex of the carved space comes from lies at most so far below and above.
        const int shift = step->start() - step->origin(), below = shift + (step->inserts() ? step->count() : 0),
                  above = (step->inserts() ? 0 : step->count()) - shift;
        range.min()[a] = std::min(range.min()[a], std::max<double>(range.min()[a] - std::max(below, 0), step->origin()));
        range.max()[a] = std::max(range.max()[a], std::min<double>(range.max()[a] + std::max(above, 0), step->last_before()));
    }
    return moved;
}

openvdb::BBoxd CarveMap::moved() const {
    openvdb::BBoxd out(openvdb::Vec3d(0), openvdb::Vec3d(reach_[0] - 1, reach_[1] - 1, reach_[2] - 1));
    if (!steps_.empty() && steps_.front().closed()) out.max().z() = reach_[2];
    // With both axes carved, what one step moves reaches all along the other.
    const bool one_axis = std::all_of(steps_.begin(), steps_.end(), [&](const CarveStep& step) { return step.axis() == steps_.front().axis(); });
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
