#include "carve/solver/task/task.h"

#include "carve/base/failure.h"
#include "carve/base/values.h"
#include "carve/solver/search/find_seams.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace fluidcarve {

namespace {

/// The number of vertices along the axis, for the end of a message.
std::string vertices_along(Axis axis, int size, bool carved) {
    if (axis == Axis::t) return fmt::format("{} frames: 0 to {}", size, size - 1);
    return fmt::format("{} vertices along {}{}: 0 to {}", size, to_text(axis), once_carved(carved),
                       size - 1);
}

/// The whole that an axis spans, for messages.
const char* whole_of(Axis axis) { return axis == Axis::t ? "sequence" : "lattice"; }

/// The window that a parameter states.
/// @param first  the lowest vertex that may be carved
Window window_of(const std::string& name, const Auto<VertexRange>& stated, Axis axis, int first,
                 int size, bool carved) {
    if (!stated) return {first, size - 1};
    const auto out = stated->of(size);
    const auto text = to_text(*stated);
    if (out.first < first)
        throw Failure(
            fmt::format("{} {} holds the rig, vertex 0, where the lattice's columns meet, so that "
                        "nothing can be taken or added; begin at 1",
                        name, text));
    if (out.last > size - 1)
        throw Failure(fmt::format("{} {} leaves the {}, which has {}", name, text, whole_of(axis),
                                  vertices_along(axis, size, carved)));
    return out;
}

/// Requires that removals leave a vertex along the axis; with `best_effort` the task sees to it.
void require_vertex_left(const SolverParams& params, int size, bool carved) {
    const int removed = -params.count.of(size);
    // Vertices outside a window stay.
    const auto window = params.window ? params.window->of(size) : Window{0, size - 1};
    const bool all = window.first == 0 && window.last == size - 1;
    if (params.best_effort || removed < size || !all) return;
    const auto count = to_text(params.count);
    const auto what = [&](bool one) {
        return params.axis == Axis::t ? std::string(one ? "frame" : "frames")
                                      : fmt::format("{} along {}{}", one ? "vertex" : "vertices",
                                                    to_text(params.axis), once_carved(carved));
    };
    if (size == 1)
        throw Failure(fmt::format("count {} removes the only {}; none can go", count, what(true)));
    throw Failure(fmt::format("count {} removes {} {} {}; at most {} can go", count,
                              removed == size ? "all" : "more than the", size, what(false),
                              size - 1));
}

/// The windows of a task.
struct WindowOfTask {
    const SolverParams& params;
    int first;  ///< lowest vertex that may be carved
    bool carved;

    /// A part of the task, with its window.
    /// @param task  with `best_effort`, gets fewer seams if the window has no room for more
    SeamPart part(SeamPart part, const Auto<VertexRange>& stated, SeamTask& task) const {
        const int size = task.size;
        auto& window = part.window;
        window = window_of(part.prefix() + "window", stated, params.axis, first, size, carved);
        // One vertex stays.
        const int room = std::min(room_in(part.kind, window, size, task.finest),
                                  part.kind == Seams::Kind::remove ? size - 1 : size);
        if (params.best_effort && room < task.count) {
            task.count = room;
            task.limit = fmt::format("{}window [{}, {}]: it has room to {} {}", part.prefix(),
                                     window.first, window.last, to_text(part.kind), room);
        }
        const bool inner = window.first == 1 && window.last == size - 2;
        if (params.axis == Axis::t && inner && task.count > room)
            throw Failure(fmt::format(
                "{} seams do not fit: window [{}, {}] has room to {} {}, since the first and the "
                "last frame stay; ask for fewer",
                task.count, window.first, window.last, to_text(part.kind), room));
        require_room(part.kind, task.count, window, size, task.finest);
        return part;
    }
};

}  // namespace

std::string once_carved(bool carved) {
    return carved ? " once the seams of `after` are carved" : "";
}

SeamTask task_of(const SolverParams& params, const CarvedSpace& space, int finest) {
    const auto form = space.form();
    if (*std::ranges::min_element(form.shape) < 1)
        throw Failure(fmt::format("the seams of `after` leave nothing to carve: {} vertices",
                                  fmt::join(form.shape, " x ")));
    return task_of(params, form, space.carved(), finest);
}

SeamTask task_of(const SolverParams& params, const LatticeForm& form, bool carved, int finest) {
    require_ends(params, form);
    SeamTask out;
    out.axis = params.axis;
    out.finest = finest;
    out.shape = form.shape;
    const int size = params.axis == Axis::t ? form.frames : out.shape[dimension(params.axis)],
              count = params.count.of(size);
    out.size = size;
    require_vertex_left(params, size, carved);
    out.asked = out.count = std::abs(count);
    if (const int thickness = params.thickness.value_or(1); thickness > size)
        throw Failure(fmt::format("thickness {} is wider than the {}, which has {}; lower it",
                                  thickness, whole_of(params.axis),
                                  vertices_along(params.axis, size, carved)));
    const bool at_rig = form.around && params.axis != Axis::t;
    const WindowOfTask window{params, at_rig ? 1 : 0, carved};
    out.seams = window.part({kind_asked(count), {}, params.static_}, params.window, out);
    if (params.anchor.vertex > size - 1)
        throw Failure(fmt::format("anchor {} lies beyond the lattice, which has {}",
                                  params.anchor.vertex, vertices_along(params.axis, size, carved)));
    if (params.pair_window) {
        out.pairs = window.part({opposite(out.seams.kind), {}, params.pair_static, true},
                                params.pair_window, out);
        if (const auto fault = pair_fault(out.seams.window, *params.window, out.pairs->window,
                                          *params.pair_window, false))
            throw Failure(*fault);
    }
    return out;
}

void require_ends(const SolverParams& params, const LatticeForm& form) {
    if (form.closed && params.axis == Axis::w && !params.pair_window)
        throw Failure(
            "the rig is closed, so that w has no end to take from or to add to: give a `window` "
            "and a `pair_window` beside it, between which the content moves round, or leave the "
            "rig open (`closed: false`)");
    if (!form.around || params.axis == Axis::t) return;
    if (params.axis == Axis::v)
        throw Failure(
            "the lattice goes around its rig, so that v closes and has no end to take from: carve "
            "`axis: u`");
    if (params.axis == Axis::w)
        throw Failure(
            "the lattice goes around its rig, which stays in place: carve `axis: u`, or make a "
            "lattice along the rig by lattice.build and carve its w");
    if (params.anchor != Anchor{})
        throw Failure(
            fmt::format("anchor {} would move the rig, which the lattice goes around and where all "
                        "its columns meet: leave `anchor` out, so that the rig stays in place",
                        to_text(params.anchor)));
}

Columns columns_of(const SeamTask& task, const CarvedSpace& space) {
    const auto& lattice = *space.lattices().front();
    return {task.shape[lateral_dimension(task.axis)], task.shape[slice_dimension(task.axis)],
            task.axis == Axis::t ? task.shape[0] : static_cast<int>(space.frames().size()),
            lattice.closed && task.axis != Axis::w, lattice.around};
}

Seams empty_seams(const SolverParams& params, const SeamTask& task, const CarvedSpace& space) {
    const auto& lattice = *space.lattices().front();
    Seams out;
    out.axis = task.axis;
    out.kind = task.seams.kind;
    out.closed = lattice.closed;
    out.around = lattice.around;
    out.shape = task.shape;
    out.frames = space.frames();
    out.lattice = lattice.description;
    if (params.window) out.window = task.seams.window;
    if (task.pairs) out.pair_window = task.pairs->window;
    out.anchor = params.anchor;
    std::vector<std::string> hashes;
    for (const auto& of_frame : space.lattices()) hashes.push_back(of_frame->hash);
    const bool same =
        std::ranges::all_of(hashes, [&](const auto& hash) { return hash == hashes.front(); });
    out.lattice_hash = same ? hashes.front() : fmt::format("{}", fmt::join(hashes, ","));
    return out;
}

}  // namespace fluidcarve
