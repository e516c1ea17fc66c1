#include "carve/remap/voxels/joined_sides.h"

#include "carve/seam/step_columns.h"

#include <cmath>

namespace fluidcarve {

double JoinedSides::displacement(std::size_t n, const openvdb::Vec3d& at) const {
    const auto& step = map_.steps()[n];
    if (step.soft()) return block_.smooth(n, at);
    return StepColumns(step, at).displacement(static_cast<int>(std::floor(at[step.axis()])));
}

namespace {

/// Moves a point by what a step squeezes or stretches there.
/// @param by  displacement of a point
template <class Displacement>
void stretch(const CarveStep& step, const Displacement& by, openvdb::Vec3d& at) {
    if (!step.holds(at)) return;
    const double scale = step.rim_scale(at);
    if (step.carves(at, scale)) at[step.axis()] = step.clamped(at[step.axis()] + scale * by(at));
}

/// Adds the sides that a side shows through a step.
/// @param of_step  memory
template <class Displacement>
void pass_step(const CarveStep& step, const Displacement& by, const JoinedSides::Side& side,
               std::vector<Joins::Side>& of_step, std::vector<JoinedSides::Side>& to) {
    const int axis = step.axis();
    const double scale = step.holds(side.at) ? step.rim_scale(side.at) : 0;
    const auto add = [&](double moved, double weight) {
        auto next = side;
        next.at[axis] = step.clamped(side.at[axis] + scale * moved);
        next.weight *= weight;
        to.push_back(next);
    };
    if (side.nothing || !step.holds(side.at) ||
        (!step.carves(side.at, scale) && !step.frees(side.at))) {
        to.push_back(side);
    } else if (!step.carves(side.at, scale)) {
        to.push_back({side.at, side.weight, true});
    } else if (!step.joins()) {
        add(by(side.at), 1);
    } else {
        step.joins()->sides(side.at, of_step);
        for (const auto& each : of_step) add(each.by, each.weight);
    }
}

}  // namespace

void JoinedSides::find(const openvdb::Vec3d& at) {
    sides_.assign(1, {at, 1, false});
    stretched_ = at;
    if (map_.steps().size() == 1) {
        // Most maps have one step: its sides are those of the point.
        const auto& step = map_.steps().front();
        if (!step.holds(at)) return;
        const double scale = step.rim_scale(at);
        if (!step.carves(at, scale)) {
            sides_.front().nothing = step.frees(at);
            return;
        }
        const int axis = step.axis();
        stretched_[axis] = step.clamped(at[axis] + scale * displacement(0, at));
        step.joins()->sides(at, of_step_);
        sides_.resize(of_step_.size(), sides_.front());
        for (std::size_t n = 0; n < of_step_.size(); ++n) {
            sides_[n].at[axis] = step.clamped(at[axis] + scale * of_step_[n].by);
            sides_[n].weight = of_step_[n].weight;
        }
        return;
    }
    for (auto n = map_.steps().size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        const auto by = [&](const openvdb::Vec3d& of) { return displacement(n, of); };
        stretch(step, by, stretched_);
        next_.clear();
        for (const auto& side : sides_) pass_step(step, by, side, of_step_, next_);
        sides_.swap(next_);
    }
}

}  // namespace fluidcarve
