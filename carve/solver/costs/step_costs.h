#pragma once

#include "carve/solver/costs/field_columns.h"
#include "carve/solver/costs/lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

/// What steps cost: nothing, always the same, or what the field says.
enum class Stepping { free, rigid, field };

/// Costs of steps: a seam pays for being at different entries in neighbouring columns (METHOD 8
/// "Rigidity", METHOD 7 "Forward costs" after Rubinstein, Shamir and Avidan 2008). Removing entry
/// `i + 1` of one column and entry `i` of its neighbour puts entry `i` of the first beside entry `i
/// + 1` of the other: a new edge in the field.
class StepCosts {
public:
    /// Steps are free.
    StepCosts() = default;
    /// @param rigidity  cost of any step, in space and in time
    /// @param field     of the columns; null: no field
    /// @param weight    cost per unit by which the field changes across the new edge
    StepCosts(const std::array<float, 2>& rigidity, const FieldRun* field, float weight)
        : any_(field || rigidity[0] > 0 || rigidity[1] > 0),
          rigidity_(rigidity),
          field_(field),
          weight_(weight) {}

    explicit operator bool() const { return any_; }

    bool has_field() const { return field_ != nullptr; }
    /// The field at an entry.
    float value(std::size_t column, int entry) const { return field_[column].value(entry); }

    /// Cost of a step: the seam is at `entry` + 1 in column `high` and at `entry` in its neighbour
    /// `low`.
    float lift(std::size_t high, std::size_t low, int entry, bool in_time) const {
        return field_ ? lift(in_time, value(high, entry), value(low, entry + 1))
                      : rigidity_[in_time ? 1 : 0];
    }
    /// Cost of a step that puts two values of the field beside each other.
    float lift(bool in_time, float value, float other) const {
        return rigidity_[in_time ? 1 : 0] + weight_ * std::abs(value - other);
    }
    /// The same for four steps at once.
    Lanes lift(bool in_time, float value, Lanes others) const {
        return rigidity_[in_time ? 1 : 0] + weight_ * absolute(value - others);
    }
    /// Cost of the step between two entries, at most 1 apart, of neighbouring columns.
    float operator()(std::size_t column, int entry, std::size_t other, int entry_there,
                     bool in_time) const {
        return (*this)(field(column), entry, field(other), entry_there, in_time);
    }
    /// The same with the columns' field(), for who asks again and again.
    float operator()(const FieldRun* column, int entry, const FieldRun* other, int entry_there,
                     bool in_time) const {
        if (entry == entry_there) return 0;
        if (!field_) return rigidity_[in_time ? 1 : 0];
        const auto low = std::min(entry, entry_there);
        return entry > entry_there ? lift(in_time, column->value(low), other->value(low + 1))
                                   : lift(in_time, other->value(low), column->value(low + 1));
    }
    /// The field of a column; null: no field.
    const FieldRun* field(std::size_t column) const { return field_ ? field_ + column : nullptr; }
    /// The same costs, with columns counted from another one.
    StepCosts from(std::size_t column) const { return {rigidity_, field(column), weight_}; }

private:
    bool any_ = false;
    std::array<float, 2> rigidity_{};
    const FieldRun* field_ = nullptr;
    float weight_ = 0;
};

}  // namespace fluidcarve
