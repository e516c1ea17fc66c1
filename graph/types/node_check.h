#pragma once

#include "graph/text/problem.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Interface for a node's own `check`, which finds faults that the declaration can't express.
class NodeCheck {
public:
    virtual ~NodeCheck() = default;
    /// Whether the pipeline states this input or parameter.
    virtual bool stated(std::string_view field) const = 0;
    /// Number of connections of an input.
    virtual std::size_t connections(std::string_view input) const = 0;
    /// Names of the connections of a named input, in the order of the file.
    virtual std::vector<std::string> names(std::string_view input) const = 0;
    /// Adds a problem at the field, else at the node.
    virtual void fault(std::string_view field, const std::string& message) = 0;
    /// Adds a problem inside a field's text, such as a program.
    virtual void fault(const Mark& at, const std::string& message) = 0;
    /// Adds a warning at the field, else at the node.
    virtual void warn(std::string_view field, const std::string& message) = 0;
};

}  // namespace fluidcarve
