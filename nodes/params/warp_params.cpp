#include "nodes/params/warp_params.h"

#include "carve/base/failure.h"
#include "carve/seam/seams.h"
#include "carve/warp/find_warp.h"
#include "formats/seam_file/warp_amount_file.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

namespace fluidcarve {

namespace {

/// Curves of a ring must meet within this, in vertices.
constexpr double most_gap = 1e-3;

/// A window that a pipeline states.
struct Named {
    std::string name;  ///< its parameter
    VertexRange stated;
};

std::vector<Named> stated_windows(const WarpParams& params) {
    std::vector<Named> out;
    if (params.window) out.push_back({"window", *params.window});
    if (!params.pair_window) return out;
    if (params.pair_window->below) out.push_back({"pair_window", *params.pair_window->below});
    out.push_back({"pair_window", params.pair_window->above});
    return out;
}

/// The fault of the places of a window and its pair, if any. @param in  converts a range to
/// vertices
template <class In>
std::optional<std::string> places_fault(const WarpParams& params, const In& in) {
    if (!params.window || !params.pair_window) return std::nullopt;
    const auto& [above, below] = *params.pair_window;
    const auto window = in(*params.window), upper = in(above);
    if (window && upper)
        if (auto fault = pair_fault(*window, *params.window, *upper, above, true)) return fault;
    const auto lower = below ? in(*below) : std::nullopt;
    return window && lower ? pair_below_fault(*window, *params.window, *lower, *below)
                           : std::nullopt;
}

/// Requires that a window can be squeezed by `squeezed` vertices.
/// @param name  of the window's parameter
void require_squeezable(const std::string& name, const Window& window, double squeezed,
                        const std::string& where) {
    const double room = most_squeezed * (window.size() - 1);
    if (squeezed <= room) return;
    throw Failure(
        fmt::format("the amount squeezes {} [{}, {}] by {:.6g} vertices{}, but at most {:.6g} are "
                    "possible, {:g} of its {} intervals; ask for less{}",
                    name, window.first, window.last, squeezed, where, room, most_squeezed,
                    window.size() - 1, name == "window" ? " or widen the window" : " or widen it"));
}

/// Requires that all windows have room for an amount, and the lattice, too.
/// @param size  vertices along the axis
void require_room(const WarpParams& params, int size, double amount, const std::string& where) {
    require_squeezable("window", window_of(params.window, size), -amount, where);
    if (const auto& pair = params.pair_window) {
        const double each = pair->below ? amount / 2 : amount;
        require_squeezable("pair_window", pair->above.of(size), each, where);
        if (pair->below) require_squeezable("pair_window", pair->below->of(size), each, where);
    } else if (size + amount > most_vertices) {
        throw Failure(
            fmt::format("an amount of {:.6g}{} makes more than {} vertices along {}; ask for less",
                        amount, where, most_vertices, to_text(params.axis)));
    }
}

/// Requires that the amounts of a ring meet.
void require_ring(const WarpAmount& amount, int frame, int size) {
    const double first = amount.at(0, frame, size), last = amount.at(1, frame, size);
    if (std::abs(first - last) > most_gap)
        throw Failure(
            fmt::format("the lattice is closed, but 'amount' is {:.6g} where it begins and "
                        "{:.6g} where it ends, which is the same plane, in frame {}; give the "
                        "curve the same amount at 0 and at 1",
                        first, last, frame));
}

std::optional<std::string> one_vertex(const std::string& name, const Window& window) {
    if (window.size() > 1) return std::nullopt;
    return fmt::format("{} [{}, {}] has one vertex; a warp needs at least two", name, window.first,
                       window.last);
}

void check_windows(const WarpParams& params, NodeCheck& check) {
    if (params.pair_window && check.stated("anchor"))
        check.fault("anchor",
                    "with a 'pair_window' neither end of the lattice moves: leave 'anchor' out");
    // Shares are vertices only once the lattice is known.
    for (const auto& [name, stated] : stated_windows(params))
        if (const auto window = stated.vertices())
            if (const auto fault = one_vertex(name, *window)) check.fault(name, *fault);
    if (params.pair_window && !params.window)
        check.fault("pair_window", "parameter 'pair_window' needs a 'window' beside it");
    if (const auto fault =
            places_fault(params, [](const VertexRange& range) { return range.vertices(); }))
        check.fault("pair_window", *fault);
}

/// Checks where the amount is stated, and of which kind it is.
void check_amount(const WarpParams& params, NodeCheck& check) {
    const bool from_file = !params.amount_file.text().empty();
    if (!params.amount && !from_file)
        check.fault("amount",
                    "warp.solve needs an 'amount', such as -7.25, -10% or {along: w, at: [[0, 0], "
                    "[1, -12]]}, or a CSV file with one in 'amount_file'");
    if (params.amount && from_file)
        check.fault(
            "amount_file",
            "'amount_file' states the amount, and 'amount' does so, too; leave one of the two out");
    if (params.rest && check.connections("after") == 0)
        check.fault("rest",
                    "'rest' needs `after`: the seams that are carved before, so that the warp "
                    "makes the rest of 'amount'");
    if (params.rest && (from_file || (params.amount && params.amount->varies())))
        check.fault("rest",
                    "'rest' is of a single 'amount', not of a curve, since seams are alike in all "
                    "planes and frames; leave one of the two out");
    if (params.rest && params.pair_window)
        check.fault("rest",
                    "with a 'pair_window' the size stays, so that there is no rest; leave one of "
                    "the two out");
    if (params.amount_file.per_frame())
        check.fault("amount_file",
                    "parameter 'amount_file' can't have a frame token: one file holds the amounts "
                    "of all frames, in a column 'time'");
}

/// Checks that the amount goes with the axis and with static seams.
void check_curve(const WarpParams& params, NodeCheck& check) {
    if (params.static_ && params.amount && params.amount->varies_along(WarpAmount::Along::time))
        check.fault("static",
                    "a static warp is the same in all frames, but 'amount' changes over time; "
                    "leave one of the two out");
    if (params.axis == Axis::t)
        check.fault("axis",
                    "a warp is in space; to make a sequence faster or slower as a whole, use "
                    "time.retime");
    if (params.axis == Axis::w && params.amount &&
        params.amount->varies_along(WarpAmount::Along::w))
        check.fault("amount",
                    "'amount' changes along w, which is the axis that is warped; state one amount, "
                    "or let it change over time");
}

}  // namespace

void check_params(const WarpParams& params, NodeCheck& check) {
    check_anchor(params.anchor, check);
    check_windows(params, check);
    check_amount(params, check);
    check_curve(params, check);
    if (params.factor && *params.factor != 1 && *params.factor != 2 && *params.factor != 4)
        check.fault("factor", fmt::format("parameter 'factor' must be auto, 1, 2 or 4, not {}",
                                          *params.factor));
    if (check.stated("field_weight") && check.connections("field") == 0)
        check.fault("field_weight",
                    "parameter 'field_weight' needs a `field`, in which edges are seen");
}

WarpAmount amount_of(const WarpParams& params) {
    if (params.amount) return *params.amount;
    const auto path = params.amount_file.at(0);
    auto out = read_amounts(path);
    if (params.axis == Axis::w && out.varies_along(WarpAmount::Along::w))
        throw Failure(path +
                          ": its amounts change along w, which is the axis that is warped; leave "
                          "out the column of places",
                      Failure::Kind::input);
    if (params.static_ && out.varies_along(WarpAmount::Along::time))
        throw Failure(path +
                          ": its amounts change over time, but a static warp is the same in all "
                          "frames; leave out the column 'time', or 'static'",
                      Failure::Kind::input);
    return out;
}

Window window_of(const Auto<VertexRange>& window, int size) {
    return window ? window->of(size) : Window{0, size - 1};
}

double place_along(int k, int slices, bool closed) {
    const int planes = closed ? slices : slices - 1;
    return planes > 0 ? static_cast<double>(k) / planes : 0;
}

void require_fits(const WarpParams& params, const WarpAmount& amount,
                  const std::array<int, 3>& shape, bool closed, const std::vector<int>& frames,
                  const std::string& space) {
    const int size = shape[dimension(params.axis)];
    const auto vertices =
        fmt::format("{} vertices along {}{}: 0 to {}", size, to_text(params.axis), space, size - 1);
    for (const auto& [name, stated] : stated_windows(params)) {
        const auto window = stated.of(size);
        if (window.last > size - 1)
            throw Failure(fmt::format("{} {} leaves the lattice, which has {}", name,
                                      to_text(stated), vertices));
        if (const auto fault = one_vertex(name, window)) throw Failure(*fault);
    }
    if (const auto fault = places_fault(
            params, [&](const VertexRange& range) { return std::optional(range.of(size)); }))
        throw Failure(*fault);
    if (params.anchor.vertex > size - 1)
        throw Failure(fmt::format("anchor {} lies beyond the lattice, which has {}",
                                  params.anchor.vertex, vertices));
    if (size < 2)
        throw Failure(fmt::format("a warp needs two vertices along {}{}, but there is one",
                                  to_text(params.axis), space));
    for (const int frame : frames) {
        for (int k = 0; k < shape[2]; ++k) {
            const double wanted = amount.at(place_along(k, shape[2], closed), frame, size);
            require_room(params, size, wanted,
                         amount.varies() ? fmt::format(" at plane {} in frame {}", k, frame)
                                         : std::string());
            if (!amount.varies_along(WarpAmount::Along::w)) break;
        }
        if (closed && amount.varies_along(WarpAmount::Along::w)) require_ring(amount, frame, size);
        if (!amount.varies_along(WarpAmount::Along::time)) break;
    }
}

}  // namespace fluidcarve
