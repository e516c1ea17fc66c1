#pragma once

#include "carve/lattice/lattice.h"
#include "graph/types/node_check.h"
#include "graph/types/param.h"

#include <array>
#include <utility>

namespace fluidcarve {

/// The world axes of u, v and w.
enum class AxisOrder { xyz, xzy, yxz, yzx, zxy, zyx };

template <>
struct ChoiceNames<AxisOrder> {
    static constexpr std::array names = {
        std::pair{"xyz", AxisOrder::xyz}, std::pair{"xzy", AxisOrder::xzy},
        std::pair{"yxz", AxisOrder::yxz}, std::pair{"yzx", AxisOrder::yzx},
        std::pair{"zxy", AxisOrder::zxy}, std::pair{"zyx", AxisOrder::zyx}};
};

/// The parameters of `lattice.box`. Its declaration says what each means.
struct BoxParams {
    Auto<Vec3> min, max;
    Auto<double> spacing;
    AxisOrder axes = AxisOrder::xyz;
};

/// Finds parameters that do not go together, or with the input `fit`.
void check_params(const BoxParams& params, NodeCheck& check);

/// The numbers of the axes, from 0.
std::array<int, 3> axes_of(AxisOrder order);
/// I, J, K by the numbers along the world's axes.
std::array<int, 3> in_order(const std::array<int, 3>& axes, const std::array<int, 3>& counts);

/// I, J, K of a box whose `min`, `max` and `spacing` are stated.
std::array<int, 3> shape_of(const BoxParams& params);
/// The lattice in such a box.
Lattice stated_box(const BoxParams& params);

}  // namespace fluidcarve
