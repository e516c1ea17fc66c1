#include "nodes/remap/carve_map.h"

#include "graph/frames.h"
#include "graph/problem.h"
#include "nodes/lattice/mapping.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace fluidcarve {

namespace {

std::string text(const std::array<int, 3>& shape) { return fmt::format("{} x {} x {}", shape[0], shape[1], shape[2]); }

void require_lattice(const Seams& seams, const Lattice& lattice) {
    if (seams.lattice_hash != lattice.hash)
        throw Failure(fmt::format("the seams were found in another lattice: theirs is a {} ({}), this one a {} ({})", seams.lattice, seams.lattice_hash,
                                  lattice.description, lattice.hash));
}

std::size_t place_of(int frame, const Seams& seams) {
    const auto found = std::find(seams.frames.begin(), seams.frames.end(), frame);
    if (found == seams.frames.end()) throw Failure(fmt::format("the seams do not hold frame {}; they hold {}", frame, FrameSet(seams.frames).text()));
    return static_cast<std::size_t>(found - seams.frames.begin());
}

}  // namespace

CarveStep::CarveStep(const Seams& seams, std::size_t t, std::size_t count)
    : axis_(static_cast<int>(seams.axis)),
      before_(seams.carved()),
      laterals_(seams.lateral()),
      slices_(seams.shape[2]),
      inserts_(seams.kind == Seams::Kind::insert),
      count_(count),
      bounds_(count * seams.columns_per_frame()) {
    if (reach() > 65535) throw Failure(fmt::format("{} vertices along {} are more than 65535", reach(), to_text(seams.axis)));
    const auto columns = seams.columns_per_frame();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
        std::vector<std::uint16_t> entries(count), sorted;
        for (auto c = range.begin(); c < range.end(); ++c) {
            for (std::size_t n = 0; n < count; ++n) entries[n] = seams.seams[n].at[t * columns + c];
            if (inserts_) {
                sorted = entries;
                std::sort(sorted.begin(), sorted.end());
            } else {
                to_original(entries, sorted);
            }
            // The n-th removed entry is passed by n removals before it; the n-th new entry stands behind its original and n others.
            for (std::size_t n = 0; n < count; ++n) bounds_[c * count + n] = static_cast<std::uint16_t>(inserts_ ? sorted[n] + n + 1 : sorted[n] - n);
        }
    });
    first_moved_ = reach();
    for (std::size_t c = 0; c < columns && count > 0; ++c) first_moved_ = std::min<int>(first_moved_, bounds_[c * count]);
}

CarveMap::CarveMap(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& sets, int frame, std::optional<std::size_t> count)
    : reach_(lattice.shape) {
    auto shape = lattice.shape;
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto& set = *sets[n];
        require_lattice(set, lattice);
        if (set.shape != shape)
            throw Failure(fmt::format("seam set {} of {} carves {} vertices, but {} leaves {}; list the sets in the order in which they were found", n + 1,
                                      sets.size(), text(set.shape), n == 0 ? std::string("the lattice") : fmt::format("set {}", n), text(shape)));
        std::size_t used = set.seams.size();
        if (count && n + 1 == sets.size()) {
            if (*count > used) throw Failure(fmt::format("count asks for {} seams, but the seam set holds {}", *count, used));
            used = *count;
        }
        const auto t = place_of(frame, set);
        if (used > 0) steps_.emplace_back(set, t, used);
        shape = set.shape_after(used);
        for (std::size_t d = 0; d < 3; ++d) reach_[d] = std::max(reach_[d], shape[d]);
    }
}

bool CarveMap::trace(openvdb::BBoxd& range, bool& frees) const {
    bool moved = false;
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
        const int a = step->axis(), b = step->lateral_axis();
        const auto meets = [&](int dimension, double first, double last) {
            return range.max()[dimension] >= first - Mapping::slack && range.min()[dimension] <= last + Mapping::slack;
        };
        // A point between an entry and a moved one moves in part.
        if (!meets(a, step->first_moved() - 1, step->reach() - 1) || !meets(b, 0, step->laterals() - 1) || !meets(2, 0, step->slices() - 1)) continue;
        moved = true;
        if (step->inserts()) {
            range.min()[a] = std::min(range.min()[a], std::max(range.min()[a] - step->count(), 0.0));
        } else {
            frees = frees || range.max()[a] > step->after() - 1;
            range.max()[a] = std::max(range.max()[a], std::min<double>(range.max()[a] + step->count(), step->before() - 1));
        }
    }
    return moved;
}

openvdb::BBoxd CarveMap::moved() const {
    openvdb::BBoxd out(openvdb::Vec3d(0), openvdb::Vec3d(reach_[0] - 1, reach_[1] - 1, reach_[2] - 1));
    // With both axes carved, what one step moves reaches all along the other.
    const bool one_axis = std::all_of(steps_.begin(), steps_.end(), [&](const CarveStep& step) { return step.axis() == steps_.front().axis(); });
    if (steps_.empty() || !one_axis) return out;
    double first = steps_.front().first_moved();
    for (const auto& step : steps_) first = std::min<double>(first, step.first_moved());
    out.min()[steps_.front().axis()] = std::max(0.0, first - 1);
    return out;
}

}  // namespace fluidcarve
