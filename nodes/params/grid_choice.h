#pragma once

#include "graph/types/param.h"

#include <array>
#include <optional>
#include <string>
#include <utility>

namespace fluidcarve {

/// What a grid holds.
enum class GridKind { scalar, vector };

template <>
struct ChoiceNames<GridKind> {
    static constexpr std::array names = {std::pair{"float", GridKind::scalar},
                                         std::pair{"vector", GridKind::vector}};
};

/// An entry of the parameter `grids` of vdb.read.
struct GridChoice {
    std::string name;  ///< name in the file; empty: the name of the output
    GridKind kind = GridKind::scalar;
};

/// Written as `float`, or `{name: vel, type: vector}`.
template <>
struct ParamTraits<GridChoice> {
    static Shape shape();
    static std::optional<GridChoice> parse(const Value& value, ValueReader& reader);
    static std::string text(const GridChoice& choice);
};

}  // namespace fluidcarve
