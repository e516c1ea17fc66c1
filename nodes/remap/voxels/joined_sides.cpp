#include "nodes/remap/voxels/joined_sides.h"

#include "nodes/seams/step_columns.h"

namespace fluidcarve {

double JoinedSides::displacement(std::size_t n, const openvdb::Vec3d& at) const {
    const auto& step = map_.steps()[n];
    if (step.soft()) return block_.smooth(n, at);
    return StepColumns(step, at[step.lateral_axis()], at.z()).displacement(static_cast<int>(std::floor(at[step.axis()])));
}

void JoinedSides::find(const openvdb::Vec3d& at) {
    sides_.assign(1, {at, 1, false});
    stretched_ = at;
    doubled_ = false;
    for (auto n = map_.steps().size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        const int axis = step.axis();
        if (step.holds(stretched_)) {
            const double scale = step.scale(stretched_);
            if (step.carves(stretched_, scale)) {
                if (step.joins()) doubled_ = doubled_ || step.joins()->doubles(stretched_);
                stretched_[axis] = step.held(stretched_[axis] + scale * displacement(n, stretched_));
            }
        }
        next_.clear();
        for (const auto& side : sides_) {
            const double scale = step.holds(side.at) ? step.scale(side.at) : 0;
            const auto add = [&](double by, double weight) {
                auto to = side;
                to.at[axis] = step.held(side.at[axis] + scale * by);
                to.weight *= weight;
                next_.push_back(to);
            };
            if (side.nothing || !step.holds(side.at) || (!step.carves(side.at, scale) && !step.frees(side.at))) {
                next_.push_back(side);
            } else if (!step.carves(side.at, scale)) {
                next_.push_back({side.at, side.weight, true});
            } else if (!step.joins()) {
                add(displacement(n, side.at), 1);
            } else {
                step.joins()->sides(side.at, of_step_);
                for (const auto& each : of_step_) add(each.by, each.weight);
            }
        }
        sides_.swap(next_);
    }
}

}  // namespace fluidcarve
