#pragma once

#include "graph/types/growth.h"
#include "graph/types/node_type.h"

#include <cstddef>
#include <string>
#include <utility>

namespace fluidcarve {

/// The growth of a node's result, by the node's static functions of the same names: `rest`,
/// `item_count`, `wanted`, `first` and `warnings`.
/// @tparam Params  of the node, or of one derived from it
/// @param param    as Growth::param
/// @param item     as Growth::item
template <class Node, class Params = typename Declare<Node>::Params>
Growth growth_of(std::string param, std::string item) {
    return {
        .param = std::move(param),
        .rest = [](const void* params) { return Node::rest(*static_cast<const Params*>(params)); },
        .item_count = &Node::item_count,
        .wanted =
            [](const void* params, std::size_t all_items) {
                return Node::wanted(*static_cast<const Params*>(params), all_items);
            },
        .first = &Node::first,
        .warnings = &Node::warnings,
        .item = std::move(item)};
}

}  // namespace fluidcarve
