#pragma once

#include "graph/types/payload.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// How much a growing result holds.
struct ItemCount {
    std::size_t count = 0;      ///< items, such as seams
    std::size_t all_items = 0;  ///< 100 % of a count given as a percentage
};

/// A result that can be cut to a smaller count of items, or continued to a larger one. Example: the
/// seams of a solver, whose first seams do not depend on the count. The node must have exactly one
/// output.
struct Growth {
    std::string param;  ///< the parameter with the wanted count; not part of the cache key
    /// The part of that parameter that belongs to the cache key, as text.
    std::function<std::string(const void* params)> rest;
    std::function<ItemCount(const Payload& result)> item_count;  ///< of a result
    /// The wanted count. @param all_items  as ItemCount::all_items
    std::function<std::size_t(const void* params, std::size_t all_items)> wanted;
    /// The first `count` items of a result. Changes `entry`, the report entry of the whole result,
    /// to that of the cut one.
    std::function<Payload(const Payload& result, std::size_t count, nlohmann::ordered_json& entry)>
        first;
    /// The node's warnings that depend on the count, computed from its report entry; empty: none
    /// do.
    std::function<std::vector<std::string>(const nlohmann::ordered_json& entry)> warnings = nullptr;
    std::string item = "item";  ///< what is counted, for messages
    /// A true-or-false parameter: whether fewer items than wanted are enough, if there are no more.
    /// It is no part of the cache key of the result, which serves both. Empty: there is none.
    std::string best_effort = {};
    /// Whether a report entry says that there are no more items than the result holds; empty: none
    /// does.
    std::function<bool(const nlohmann::ordered_json& entry)> exhausted = nullptr;
};

}  // namespace fluidcarve
