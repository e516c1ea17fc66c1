#pragma once

#include "carve/simd/eight.h"
#include "carve/solver/costs/step_costs.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

/// The steps of a lower bound (search/bound.h) on a single column. Arrays of floats and messages
/// have whole_eights() of a column's entries, so that vectors fill them; values behind the entries
/// are arbitrary.

/// A message keeps the upper half of each float's bits.
inline float from_upper(std::uint16_t bits) {
    return std::bit_cast<float>(std::uint32_t{bits} << 16);
}

/// Values of a column, with room for one more value before the first and behind the last.
class ColumnValues {
public:
    explicit ColumnValues(std::size_t width) : values_(whole_eights(width) + 16) {}
    float* data() { return values_.data() + 8; }
    const float* data() const { return values_.data() + 8; }

private:
    std::vector<float> values_;
};

/// The messages and costs of one line at a column.
struct ColumnLine {
    float* front;         ///< message from the columns before
    float* ahead;         ///< message from the columns behind
    std::uint16_t* kept;  ///< a message in upper halves
    bool read_ahead;      ///< first `kept` is read into `ahead`
    bool keep_front;      ///< then `front` is written to `kept`
    float* part;          ///< becomes the line's part of the costs, with the message from before
    float least = 0;      ///< becomes the smallest value of `part`
};

/// Divides a column's costs, and all messages to it, in equal parts among the lines that go through
/// it.
/// @param share  that each line gets
void divide_column(std::span<ColumnLine> lines, const float* costs, std::size_t width, float share);

/// The message to a line's next column: for each entry there, the least value of an entry within
/// 1, plus the cost of the step, as in StepCosts::lift().
/// @param part         of the column that sends; its values before the first and behind the last
///   become infinite
/// @param here, there  the field of both columns; null: all steps cost alike
/// @param least        the smallest value of `part`, which is subtracted from the message
void send_to_column(float* part, const float* here, const float* there, const StepPrice& price,
                    float least, std::size_t width, float* message);

}  // namespace fluidcarve
