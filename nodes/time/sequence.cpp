#include "nodes/time/sequence.h"

#include "nodes/field/collocate.h"
#include "nodes/field/same_transform.h"

namespace fluidcarve {

void Sequence::add(const Volume& source, const Ref<VectorGrid>& velocity, const Context& context) {
    if (!store_) store_.emplace(context.memory_budget(), context.work_folder());
    auto frame = source;
    // The velocity goes along as the last grid: mostly it is one of the source's, and its tree is kept once.
    if (velocity) frame.grids.push_back(velocity);
    store_->add(std::make_shared<Volume>(std::move(frame)));
    numbers_.push_back(context.frame());
    has_velocity_ = velocity != nullptr;
}

SequenceFrame Sequence::at(std::size_t place) const {
    SequenceFrame out{*store_->at(place), nullptr};
    if (!has_velocity_) return out;
    out.velocity = openvdb::gridConstPtrCast<VectorGrid>(out.volume.grids.back());
    out.volume.grids.pop_back();
    return out;
}

std::optional<std::pair<MovingFrame, MovingFrame>> shown_in(const SequenceFrame& a, const SequenceFrame& b) {
    std::optional<std::pair<MovingFrame, MovingFrame>> out;
    std::uint64_t most = 0;
    for (const auto& grid : a.volume.grids) {
        const auto old = openvdb::gridConstPtrCast<FloatGrid>(grid), now = openvdb::gridConstPtrCast<FloatGrid>(b.volume.find(grid->getName()));
        if (!old || !now || old->transform() != now->transform() || !cubes_along_axes(old->transform())) continue;
        const bool density = old->getName() == "density" || old->getGridClass() == openvdb::GRID_LEVEL_SET;
        const auto voxels = density ? ~std::uint64_t{0} : old->activeVoxelCount();
        if (voxels <= most) continue;
        most = voxels;
        const auto velocity = [](const SequenceFrame& frame) { return frame.velocity ? collocated(frame.velocity) : nullptr; };
        out.emplace(MovingFrame{old, velocity(a)}, MovingFrame{now, velocity(b)});
    }
    return out;
}

}  // namespace fluidcarve
