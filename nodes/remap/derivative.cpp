#include "nodes/remap/derivative.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace fluidcarve {

using openvdb::Mat3d;
using openvdb::Vec3d;

SmoothDisplacement::SmoothDisplacement(const CarveStep& step)
    : axis_(step.axis()), laterals_(step.laterals()), slices_(step.slices()), closed_(step.closed()), last_entry_(step.after() - 1) {
    const int reach = step.count();
    first_ = std::clamp(step.first_moved() - 1 - reach, 0, last_entry_);
    last_ = first_;
    for (int k = 0; k < slices_; ++k)
        for (int lateral = 0; lateral < laterals_; ++lateral) last_ = std::max(last_, std::min(step.bounds(lateral, k).back() + reach + 1, last_entry_));

    const auto size = static_cast<std::size_t>(last_ - first_) + 1, laterals = static_cast<std::size_t>(laterals_);
    entries_.resize(size * laterals * static_cast<std::size_t>(slices_));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, laterals * static_cast<std::size_t>(slices_), 64), [&](const tbb::blocked_range<std::size_t>& range) {
        // Sums of half vertices over all entries before one, from the first that counts.
        const int from = std::max(first_ - reach, 0), to = std::min(last_ + reach, last_entry_);
        std::vector<int> before(static_cast<std::size_t>(to - from) + 2);
        const auto sum = [&](int entry) { return before[static_cast<std::size_t>(entry - from)]; };
        for (auto column = range.begin(); column < range.end(); ++column) {
            const int lateral = static_cast<int>(column % laterals), k = static_cast<int>(column / laterals);
            const auto bounds = step.bounds(lateral, k);
            Vec3d vertex(0, 0, k);
            vertex[step.lateral_axis()] = lateral;
            const double scale = step.scale(vertex);
            std::size_t passed = CarveStep::passed(from, bounds);
            for (int e = from; e <= to; ++e) {
                while (passed < bounds.size() && bounds[passed] <= e) ++passed;
                before[static_cast<std::size_t>(e - from) + 1] = sum(e) + step.displacement(e, passed, bounds);
            }
            for (int e = first_; e <= last_; ++e) {
                const int beside = std::min({reach, e, last_entry_ - e});
                entries_[column * size + static_cast<std::size_t>(e - first_)] =
                    static_cast<float>(0.5 * scale * (sum(e + beside + 1) - sum(e - beside)) / (2 * beside + 1));
            }
        }
    });
}

double SmoothDisplacement::entry(int entry, int lateral, int k) const {
    const auto size = static_cast<std::size_t>(last_ - first_) + 1;
    const auto column = static_cast<std::size_t>(lateral) + static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k);
    return entries_[column * size + static_cast<std::size_t>(std::clamp(entry, first_, last_) - first_)];
}

SmoothDisplacement::Value SmoothDisplacement::at(const Vec3d& at) const {
    const int lateral_axis = 1 - axis_;
    const std::array<int, 3> low{static_cast<int>(at[axis_]), static_cast<int>(at[lateral_axis]), static_cast<int>(at.z())};
    const std::array<double, 3> part{at[axis_] - low[0], at[lateral_axis] - low[1], at.z() - low[2]};
    Value out{0, Vec3d(0)};
    if (low[0] + 2 < first_) return out;

    const auto value = [&](const std::array<int, 3>& vertex) { return entry(vertex[0], vertex[1], closed_ ? (vertex[2] + slices_) % slices_ : vertex[2]); };
    const std::array<int, 3> last{last_entry_, laterals_ - 1, slices_ - 1};
    for (unsigned n = 0; n < 8; ++n) {
        double weight = 1;
        auto corner = low;
        for (std::size_t d = 0; d < 3; ++d) {
            corner[d] += n >> d & 1 ? 1 : 0;
            weight *= n >> d & 1 ? part[d] : 1 - part[d];
        }
        if (weight == 0) continue;
        out.d += weight * value(corner);
        for (std::size_t d = 0; d < 3; ++d) {
            auto below = corner, above = corner;
            --below[d];
            ++above[d];
            if (d < 2 || !closed_) {
                below[d] = std::max(below[d], 0);
                above[d] = std::min(above[d], last[d]);
            }
            if (below[d] == above[d]) continue;
            const int axis = d == 0 ? axis_ : d == 1 ? lateral_axis : 2;
            out.gradient[axis] += weight * (value(above) - value(below)) / (above[d] - below[d]);
        }
    }
    return out;
}

CarveDerivative::CarveDerivative(const Mapping& mapping, const CarveMap& map) : mapping_(mapping), map_(map) {
    smooth_.reserve(map.steps().size());
    for (const auto& step : map.steps()) smooth_.emplace_back(step);
}

std::optional<Mat3d> CarveDerivative::operator()(const Vec3d& at) const {
    auto source = at;
    auto slope = Mat3d::identity();
    for (auto n = smooth_.size(); n > 0; --n) {
        const auto& step = map_.steps()[n - 1];
        const int axis = step.axis();
        if (!step.holds(source)) continue;
        if (source[axis] > step.end(step.scale(source))) {
            if (step.inserts()) continue;
            return std::nullopt;
        }
        const auto [d, gradient] = smooth_[n - 1].at(source);
        source[axis] += d;
        slope.setRow(axis, slope.row(axis) + slope.transpose() * gradient);
    }
    if (slope == Mat3d::identity() && (source == at || !mapping_.slabs())) return std::nullopt;
    return position_slope(source) * slope * position_slope(at).inverse();
}

openvdb::BBoxd CarveDerivative::range() const {
    const auto& reach = map_.reach();
    const bool closed = !map_.empty() && map_.steps().front().closed();
    return {Vec3d(0), Vec3d(reach[0] - 1, reach[1] - 1, closed ? reach[2] : reach[2] - 1)};
}

Mat3d CarveDerivative::position_slope(const Vec3d& at) const {
    // `g` is linear along u and along v, and along w from plane to plane.
    double plane = std::floor(at.z());
    if (const auto* const slabs = mapping_.slabs()) plane = std::min(plane, slabs->size() - 1.0);
    const auto here = mapping_.position(at), low = mapping_.position({at.x(), at.y(), plane});
    Mat3d out;
    out.setCol(0, mapping_.position(at + Vec3d(1, 0, 0)) - here);
    out.setCol(1, mapping_.position(at + Vec3d(0, 1, 0)) - here);
    out.setCol(2, mapping_.position({at.x(), at.y(), plane + 1}) - low);
    return out;
}

}  // namespace fluidcarve
