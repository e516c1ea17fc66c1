#pragma once

#include "graph/types/node_type.h"

#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The check of a pipeline's node, for a node that looks into a text of its own, such as a program: every NodeCheck that a
/// pipeline's builder hands out is one.
class PlacedCheck : public NodeCheck {
public:
    using NodeCheck::fault;
    virtual void fault(const Mark& at, const std::string& message) = 0;
    /// The names of a named input's connections, as stated.
    virtual std::vector<std::string> names(std::string_view input) const = 0;
};

}  // namespace fluidcarve
