#include "carve/time/sequence.h"

#include "carve/base/failure.h"
#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/same_transform.h"
#include "carve/volume/volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

namespace fluidcarve {

void Sequence::add(const Volume& source, const Ref<VectorGrid>& velocity, int number,
                   const Limits& limits) {
    auto frame = source;
    // The velocity goes along as the last grid: mostly it is one of the source's, and its tree is
    // kept once.
    if (velocity) frame.grids.push_back(velocity);
    frames_.add(std::make_shared<Volume>(std::move(frame)), number, limits);
    for (const auto& grid : source.grids)
        if (grid.header().isType<FloatGrid>()) box_.expand(grid.active_box());
    has_velocity_ = velocity != nullptr;
}

SequenceFrame Sequence::at(std::size_t place) const {
    SequenceFrame out{*frames_.at(place), nullptr};
    if (!has_velocity_) return out;
    out.velocity = openvdb::gridConstPtrCast<VectorGrid>(out.volume.grids.back());
    out.volume.grids.pop_back();
    return out;
}

std::optional<std::pair<FloatGrid::ConstPtr, FloatGrid::ConstPtr>> shown_in(const Volume& a,
                                                                            const Volume& b) {
    std::optional<std::pair<FloatGrid::ConstPtr, FloatGrid::ConstPtr>> out;
    std::uint64_t most = 0;
    for (const auto& each : a.grids) {
        const openvdb::GridBase::ConstPtr grid = each;
        const auto old = openvdb::gridConstPtrCast<FloatGrid>(grid),
                   now = openvdb::gridConstPtrCast<FloatGrid>(b.find(grid->getName()));
        if (!old || !now || old->transform() != now->transform() ||
            !cubes_along_axes(old->transform()))
            continue;
        const bool density =
            old->getName() == "density" || old->getGridClass() == openvdb::GRID_LEVEL_SET;
        const auto voxels = density ? ~std::uint64_t{0} : old->activeVoxelCount();
        if (voxels <= most) continue;
        most = voxels;
        out.emplace(old, now);
    }
    return out;
}

std::optional<std::pair<MovingFrame, MovingFrame>> moving_in(const SequenceFrame& a,
                                                             const SequenceFrame& b) {
    const auto shown = shown_in(a.volume, b.volume);
    if (!shown) return std::nullopt;
    const auto moving = [](const FloatGrid::ConstPtr& grid, const SequenceFrame& frame) {
        return MovingFrame{grid, frame.velocity ? collocated(frame.velocity) : nullptr};
    };
    return std::pair(moving(shown->first, a), moving(shown->second, b));
}

int step_of(const std::vector<int>& frames) {
    const auto gap = [&](std::size_t n) { return std::int64_t{frames[n]} - frames[n - 1]; };
    const auto step = frames.size() > 1 ? gap(1) : 1;
    for (std::size_t n = 1; n < frames.size(); ++n)
        if (gap(n) != step)
            throw Failure(
                fmt::format("all frames are needed, but between {} and {} some are left out: state "
                            "`frames` without a gap; where a file is missing, `missing: hold` of "
                            "the reader then fills it",
                            frames[n - 1], frames[n]));
    return static_cast<int>(std::min<std::int64_t>(step, std::numeric_limits<int>::max()));
}

}  // namespace fluidcarve
