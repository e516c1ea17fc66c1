#include "nodes/params/carve_inputs.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace fluidcarve {

const char* const part_of_warp =
    "the last input of `seams` is a warp, which has no seams to count and is carved as a whole; "
    "leave `count` out, or set the warp's `amount`";

const char* const only_remapped =
    "these are seams of frames (`axis: t`): remap.grids, remap.points and remap.mesh carve them, "
    "seams.write writes them, and no other node takes them";

std::optional<std::size_t> seams_of(const Auto<Count>& asked, const Seams& last) {
    if (!asked) return std::nullopt;
    if (last.warp) {
        if (asked->value == 0) return 0;
        throw Failure(part_of_warp);
    }
    const int count = asked->of(last.before());
    if (count != 0 && kind_asked(count) == Seams::Kind::remove && last.kind == Seams::Kind::insert)
        throw Failure(fmt::format("count {} removes, but the seams insert", count));
    return static_cast<std::size_t>(std::abs(count));
}

namespace {

/// Whether seams, or a warp, are the same in all frames.
bool is_still(const Seams& seams) {
    if (const auto& warp = seams.warp) {
        const auto first = warp->values(0);
        for (std::size_t t = 1; t < warp->frames(); ++t)
            if (!std::ranges::equal(warp->values(t), first)) return false;
        return true;
    }
    const auto columns = static_cast<std::ptrdiff_t>(seams.columns_per_frame());
    for (const auto* const window : {&seams.seams, &seams.pairs})
        for (const auto& seam : *window)
            if (!std::equal(seam.at.begin() + columns, seam.at.end(), seam.at.begin()))
                return false;
    return true;
}

/// Requires seams that are the same in all frames, for a source that is the same in all frames: it
/// is carved only once.
void require_still(const Seams& seams) {
    if (!is_still(seams))
        throw Failure(
            fmt::format("the source is one file for all frames, but the {} from frame to frame; "
                        "read it by a path with a frame token",
                        seams.warp ? "warp changes" : "seams change"));
}

}  // namespace

CarveMap carve_map(const Lattice& lattice, const std::vector<Ref<Seams>>& seams,
                   const Auto<Count>& count, const Context& context, const JoinParams& join) {
    if (!context.per_frame())
        for (const auto& set : seams) require_still(*set);
    return carve_map(lattice, seams, count, context.frame(), join);
}

CarveMap carve_map(const Lattice& lattice, const std::vector<Ref<Seams>>& seams,
                   const Auto<Count>& count, int frame, const JoinParams& join) {
    std::vector<Softness> softness;
    for (const auto& set : seams) softness.push_back(softness_of(join, *set));
    return {lattice, seams, frame, seams_of(count, *seams.back()), softness};
}

}  // namespace fluidcarve
