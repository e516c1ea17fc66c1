#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Math.h>
#include <openvdb/math/Vec3.h>

#include <algorithm>
#include <type_traits>

namespace fluidcarve {

/// Whether values of a grid can be averaged. Integers, booleans and masks can't: they are carved,
/// never interpolated.
template <class Value>
inline constexpr bool can_blend =
    std::is_floating_point_v<typename openvdb::VecTraits<Value>::ElementType>;

/// The value of an inserted entry between two others: their mean, or the lower one's value if they
/// can't be averaged.
template <class Value>
Value inserted_value(const Value& low, const Value& high) {
    if constexpr (can_blend<Value>)
        return Value((low + high) * typename openvdb::VecTraits<Value>::ElementType(0.5));
    else return static_cast<void>(high), low;
}

/// Whether an interpolated voxel must be active although the nearest source voxel is not: its
/// value shows that active voxels contribute to it. OpenVDB's tools skip inactive voxels and would
/// lose the value.
template <class Value>
bool shows(const Value& value, const Value& nearest, const Value& background) {
    return can_blend<Value> && value != background && value != nearest;
}

/// A value of a grid, or one component of it, and whether it is active.
template <class Value>
struct ValueAndState {
    Value value;
    bool on;
};

/// A weighted sum of values. If they can't be averaged, or the sum is not finite, the value of the
/// highest weight. Active if a value of the highest weight is active, or if any value is active
/// and the sum is not the background.
template <class Value>
class Blend {
    using Element = typename openvdb::VecTraits<Value>::ElementType;
    using Sum = std::conditional_t<
        !can_blend<Value>, Value,
        std::conditional_t<openvdb::VecTraits<Value>::IsVec, openvdb::Vec3d, double>>;

public:
    void add(const ValueAndState<Value>& sample, double weight) {
        const auto& [value, on] = sample;
        if constexpr (can_blend<Value>) {
            // The first value is assigned, not added to 0: that would lose the sign of -0.
            if (heaviest_ == 0) sum_ = Sum(value) * weight;
            else sum_ += Sum(value) * weight;
        } else if (weight > heaviest_) {
            sum_ = value;
        }
        if (weight > heaviest_) heavy_ = value;
        if (weight >= heaviest_) on_ = on || (weight == heaviest_ && on_);
        any_ = any_ || (on && weight > 0);
        heaviest_ = std::max(heaviest_, weight);
    }
    Value value() const {
        if constexpr (can_blend<Value>) {
            const Value out(sum_);
            return openvdb::math::isFinite(out) ? out : heavy_;
        } else {
            return sum_;
        }
    }
    bool on(const Value& background) const {
        return on_ || (can_blend<Value> && any_ && value() != background);
    }

    ValueAndState<Value> result(const Value& background) const { return {value(), on(background)}; }

private:
    Sum sum_{};
    Value heavy_{};  ///< the value of the highest weight
    bool on_ = false, any_ = false;
    double heaviest_ = 0;
};

}  // namespace fluidcarve
