#pragma once

#include <openvdb/Types.h>
#include <algorithm>

#include <type_traits>

namespace fluidcarve {

/// Whether values of a grid can be averaged. Whole numbers, booleans and masks are carved, never interpolated.
template <class Value>
inline constexpr bool can_blend = std::is_floating_point_v<typename openvdb::VecTraits<Value>::ElementType>;

/// What an inserted entry between two others holds: their mean, or the lower one's value.
template <class Value>
Value inserted_value(const Value& low, const Value& high) {
    if constexpr (can_blend<Value>) return Value((low + high) * typename openvdb::VecTraits<Value>::ElementType(0.5));
    else return static_cast<void>(high), low;
}

/// A weighted sum of values; of values that can't be averaged, the heaviest. Active if the heaviest value is, or one
/// as heavy.
template <class Value>
class Blend {
    using Element = typename openvdb::VecTraits<Value>::ElementType;
    using Sum = std::conditional_t<!can_blend<Value>, Value, std::conditional_t<openvdb::VecTraits<Value>::IsVec, openvdb::Vec3d, double>>;

public:
    void add(const Value& value, bool on, double weight) {
        if constexpr (can_blend<Value>) {
            // Assigned first, not added to 0: that would lose the sign of -0.
            if (heaviest_ == 0) sum_ = Sum(value) * weight;
            else sum_ += Sum(value) * weight;
        } else if (weight > heaviest_) {
            sum_ = value;
        }
        if (weight >= heaviest_) on_ = on || (weight == heaviest_ && on_);
        heaviest_ = std::max(heaviest_, weight);
    }
    Value value() const { return Value(sum_); }
    bool on() const { return on_; }

private:
    Sum sum_{};
    bool on_ = false;
    double heaviest_ = 0;
};

}  // namespace fluidcarve
