#include "carve/remap/voxels/joined_sides.h"

#include "carve/seam/step_columns.h"

namespace fluidcarve {

double JoinedSides::displacement(std::size_t n, const openvdb::Vec3d& at) const {
    const auto& step = map_.steps()[n];
    if (step.soft()) return block_.smooth(n, at);
    return StepColumns(step, at).displacement(static_cast<int>(std::floor(at[step.axis()])));
}

void JoinedSides::find(const openvdb::Vec3d& at) {
    sides_.assign(1, {at, 1, false});
    stretched_ = at;
    if (map_.steps().size() == 1) {
        // Most maps have one step: its sides are those of the point.
        const auto& step = map_.steps().front();
        if (!step.holds(at)) return;
        const double scale = step.scale(at);
        if (!step.carves(at, scale)) {
            sides_.front().nothing = step.frees(at);
            return;
        }
        const int axis = step.axis();
        stretched_[axis] = step.held(at[axis] + scale * displacement(0, at));
        step.joins()->sides(at, of_step_);
        sides_.resize(of_step_.size(), sides_.front());
        for (std::size_t n = 0; n < of_step_.size(); ++n) {
            sides_[n].at[axis] = step.held(at[axis] + scale * of_step_[n].by);
            sides_[n].weight = of_step_[n].weight;
        }
        return;
    }
    for (auto n = map_.steps().size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        const int axis = step.axis();
        if (step.holds(stretched_)) {
            const double scale = step.scale(stretched_);
            if (step.carves(stretched_, scale)) {
                stretched_[axis] =
                    step.held(stretched_[axis] + scale * displacement(n, stretched_));
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
            if (side.nothing || !step.holds(side.at) ||
                (!step.carves(side.at, scale) && !step.frees(side.at))) {
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
