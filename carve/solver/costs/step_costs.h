#pragma once

#include "carve/simd/wide.h"
#include "carve/solver/costs/field_columns.h"
#include "carve/solver/costs/lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

/// Prices of a step, and of the edge that it makes.
struct StepPrice {
    float rigidity = 0;    ///< cost of any step
    float in_nothing = 0;  ///< cost of a step between two entries where the field is 0
    float weight = 0;      ///< cost per unit by which the field changes across the new edge

    /// Rigidity of a step, or of several, that puts two field values side by side.
    template <class Values>
    FLUIDCARVE_INLINE Values rigid(Values value, Values other) const {
        // Makes the price exceed any rigidity unless both values are about 0.
        constexpr float surely = 1e25f;
        const Values price = in_nothing + surely * (value * value + other * other),
                     most = Values{} + rigidity;
        return price < most ? price : most;
    }
};

/// Prices of the steps and edges of a volume.
struct StepPrices {
    std::array<float, 2> rigidity{};  ///< cost of any step, in space and in time
    bool free_in_nothing = false;     ///< steps between entries where the field is 0 are free of it
    float edge = 0;  ///< cost per unit by which the field changes across a new edge
};

/// What steps cost: nothing, a constant, or a price that depends on the field.
enum class Stepping { free, rigid, field };

/// Costs of steps: a seam pays for being at different entries in neighbouring columns (METHOD 8
/// "Rigidity", METHOD 7 "Forward costs" after Rubinstein, Shamir and Avidan 2008). Removing entry
/// `i + 1` of one column and entry `i` of its neighbour puts entry `i` of the first beside entry `i
/// + 1` of the other: a new edge in the field.
class StepCosts {
public:
    /// Steps are free.
    StepCosts() = default;
    /// @param field  of the columns; null: no field
    StepCosts(const StepPrices& prices, const FieldRun* field)
        : any_(field || prices.rigidity[0] > 0 || prices.rigidity[1] > 0), field_(field) {
        for (std::size_t n = 0; n < prices_.size(); ++n)
            prices_[n] = {prices.rigidity[n],
                          field && prices.free_in_nothing ? 0 : prices.rigidity[n], prices.edge};
    }

    explicit operator bool() const { return any_; }

    const StepPrice& price(bool in_time) const { return prices_[in_time ? 1 : 0]; }
    bool has_field() const { return field_ != nullptr; }
    /// The field at an entry.
    float value(std::size_t column, int entry) const { return field_[column].value(entry); }

    /// Cost of a step: the seam is at `entry` + 1 in column `high` and at `entry` in its neighbour
    /// `low`.
    float lift(std::size_t high, std::size_t low, int entry, bool in_time) const {
        return field_ ? lift(in_time, value(high, entry), value(low, entry + 1))
                      : price(in_time).rigidity;
    }
    /// Cost of a step that puts two values of the field beside each other.
    float lift(bool in_time, float value, float other) const {
        return price(in_time).rigid(value, other) + price(in_time).weight * std::abs(value - other);
    }
    /// The same for four steps at once.
    Lanes lift(bool in_time, float value, Lanes others) const {
        return price(in_time).rigid(Lanes{} + value, others) +
               price(in_time).weight * absolute(value - others);
    }
    /// Cost of the step between two entries, at most 1 apart, of neighbouring columns.
    float operator()(std::size_t column, int entry, std::size_t other, int entry_there,
                     bool in_time) const {
        return (*this)(field(column), entry, field(other), entry_there, in_time);
    }
    /// The same with the columns' field(), for repeated calls.
    float operator()(const FieldRun* column, int entry, const FieldRun* other, int entry_there,
                     bool in_time) const {
        if (entry == entry_there) return 0;
        if (!field_) return price(in_time).rigidity;
        const auto low = std::min(entry, entry_there);
        return entry > entry_there ? lift(in_time, column->value(low), other->value(low + 1))
                                   : lift(in_time, other->value(low), column->value(low + 1));
    }
    /// The field of a column; null: no field.
    const FieldRun* field(std::size_t column) const { return field_ ? field_ + column : nullptr; }
    /// The same costs, with column indices counted from `column`.
    StepCosts from(std::size_t column) const {
        auto out = *this;
        out.field_ = field(column);
        return out;
    }

private:
    bool any_ = false;
    std::array<StepPrice, 2> prices_{};
    const FieldRun* field_ = nullptr;
};

}  // namespace fluidcarve
