#include "carve/solver/task/no_more.h"

#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

namespace {

/// Lattice coordinates of a vertex of the space that earlier seams leave. An inserted vertex stands
/// halfway between two.
openvdb::Vec3d original_vertex(const std::vector<CarveStep>& steps, openvdb::Vec3d at) {
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        const auto whole = [&](int axis) { return static_cast<int>(std::floor(at[axis])); };
        const int entry = whole(step->axis()) + step->start();
        at[step->axis()] +=
            step->start() - step->origin() +
            0.5 * step->displacement(entry,
                                     step->columns().first_lateral + whole(step->lateral_axis()),
                                     step->columns().first_slice + whole(step->slice_axis()));
    }
    return at;
}

/// where_no_more() of seams of frames.
/// @param vertex  without such a frame
std::string where_no_frame(const NoSeam& none, const SeamPart& part,
                           const std::array<int, 3>& vertex, const CarvedSpace& space) {
    const auto at =
        space.lattices().front()->position(openvdb::Vec3d(vertex[0], vertex[1], vertex[2]));
    const auto shown = fmt::format("vertex ({}), at ({}),", numbers_text(vertex), numbers_text(at));
    return fmt::format(
        "{}window [{}, {}]: {}", part.prefix(), part.window.first, part.window.last,
        none.at.free == 0
            ? fmt::format("all frames of {} are protected", shown)
            : fmt::format("of the {} frames left of {} {} {} unprotected, but out of reach "
                          "from the vertices beside",
                          none.at.vertices, shown, none.at.free, none.at.free == 1 ? "is" : "are"));
}

}  // namespace

std::string where_no_more(const NoSeam& none, const SeamTask& task, const SeamPart& part,
                          const CarvedSpace& space) {
    const int laterals = task.shape[lateral_dimension(task.axis)];
    const auto per_frame = static_cast<std::size_t>(laterals) *
                           static_cast<std::size_t>(task.shape[slice_dimension(task.axis)]);
    const auto t = none.at.column / per_frame;
    const int c = static_cast<int>(none.at.column % per_frame), lateral = c % laterals,
              k = c / laterals;
    const auto& window = part.window;
    if (task.axis == Axis::t)
        return where_no_frame(none, part, {static_cast<int>(t), lateral, k}, space);
    const auto& lattice = *space.lattices()[space.place(t)];
    const auto before = space.carve_map(t);
    const auto world = [&](int entry) {
        const auto vertex = vertex_of(task.axis, entry, lateral, k);
        const auto at = lattice.position(
            original_vertex(before.steps(), openvdb::Vec3d(vertex[0], vertex[1], vertex[2])));
        return fmt::format("({})", numbers_text(at));
    };
    const int last = window.first + none.found + none.at.vertices - 1;
    const auto span = fmt::format("{} to {}", window.first, last);
    const auto column = fmt::format(
        "column ({}), from {} to {},",
        fmt::join(vertex_of(task.axis, span, std::to_string(lateral), std::to_string(k)), ", "),
        world(window.first), world(last));
    return fmt::format(
        "{}window [{}, {}]: {} {}", part.prefix(), window.first, window.last,
        part.static_ ? "over all frames" : fmt::format("in frame {}", space.frames()[t]),
        none.at.free == 0 ? fmt::format("{} has no unprotected vertex left", column)
                          : fmt::format("of the {} vertices left in {} {} {} unprotected, but out "
                                        "of reach from the columns beside",
                                        none.at.vertices, column, none.at.free,
                                        none.at.free == 1 ? "is" : "are"));
}

std::string why_no_more(const NoSeam& none, const SeamTask& task, const SeamPart& part,
                        const CarvedSpace& space) {
    return fmt::format(
        "{} possible in {}; ask for fewer, widen the window or protect less{}",
        none.found == 0 ? "no seam is"
                        : fmt::format("{} of {} seams {}", none.found, task.count,
                                      none.found == 1 ? "is" : "are"),
        where_no_more(none, task, part, space),
        none.found == 0
            ? ""
            : "; `best_effort: true` takes as many as there are (--set NODE.best_effort=true)");
}

}  // namespace fluidcarve
