#include "nodes/solving/warp_report.h"

#include "carve/base/words.h"
#include "nodes/params/param_forms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace fluidcarve {

using Json = nlohmann::ordered_json;

double steepest(const Warp& warp) {
    return std::max(0.0, -static_cast<double>(warp.scaled(warp.bounds().slope).least));
}

std::pair<double, double> amounts_in(const Seams& set, const WarpAmount& amount) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (const int frame : set.frames)
        for (int k = 0; k < set.slices(); ++k) {
            const double here =
                amount.at(place_along(k, set.slices(), set.closed), frame, set.before());
            least = std::min(least, here);
            greatest = std::max(greatest, here);
        }
    return {least, greatest};
}

Json warp_report(const Seams& set, const WarpParams& params, const WarpAmount* amount) {
    Json out{{"axis", to_text(set.axis)},
             {"shape", {set.shape[0], set.shape[1], set.shape[2], set.frames.size()}}};
    if (!amount || !amount->varies()) out["amount"] = set.warp ? set.warp->scale() : 0.0;
    else if (params.amount) out["amount"] = to_text(*amount);
    else out["amounts"] = amounts_in(set, *amount);
    if (set.warp) out["factor"] = set.warp->factor();
    out["steepest"] = set.warp ? steepest(*set.warp) : 0.0;
    if (params.rest) out["rest"] = true;
    return out;
}

std::string no_room_text(const NoRoom& none, const WarpParams& params, const Seams& set,
                         const CarvedSpace& space) {
    const auto& window = none.window;
    const auto frame =
        params.static_ ? "in all frames together" : fmt::format("in frame {}", set.frames[none.t]);
    auto place = fmt::format(
        "({})", fmt::join(vertex_of(params.axis, fmt::format("{} to {}", window.first, window.last),
                                    std::to_string(none.lateral), std::to_string(none.k)),
                          ", "));
    if (!space.carved()) {
        const auto vertex = vertex_of(params.axis, window.first, none.lateral, none.k);
        const auto at = space.lattices()[space.place(none.t)]->position(
            openvdb::Vec3d(vertex[0], vertex[1], vertex[2]));
        place += fmt::format(", which begins at ({}),", numbers_text(at));
    }
    return fmt::format(
        "{}window [{}, {}]: {}: {} column {} has {} of {} intervals that are not protected, "
        "and each gives at most {:g} of itself; ask for less, widen the window or protect less",
        none.pair ? "pair_" : "", window.first, window.last,
        none.possible == 0
            ? "no amount is possible"
            : fmt::format("an amount of {:.6g} is possible, but no more", none.possible),
        frame, place, none.free, none.intervals, most_squeezed);
}

}  // namespace fluidcarve
