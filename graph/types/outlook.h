#pragma once

#include "carve/base/region.h"

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Facts about a node's outputs before a run, by names that nodes agree on. Missing facts are
/// unknown.
using OutputFacts = std::map<std::string, int, std::less<>>;

/// Interface for a node's `foresee`, which reads what is known about its inputs before a run
/// starts.
class Outlook {
public:
    virtual ~Outlook() = default;
    /// The region of an input; null: unknown, or not connected.
    virtual const Region* region(std::string_view input) const = 0;
    /// The facts about an input, one entry per connection; empty: not connected.
    virtual const std::vector<OutputFacts>& receives(std::string_view input) const = 0;
    /// Whether the node runs once for several frames.
    virtual bool once() const = 0;
    virtual std::size_t frames() const = 0;  ///< number of frames of its inputs

    /// States the region of all outputs; without a call, it is the union of the inputs' regions.
    virtual void lies(const Region& region) = 0;
    /// States facts about all outputs.
    virtual void delivers(const OutputFacts& facts) = 0;
    virtual void warn(const std::string& message) = 0;
    virtual void fault(const std::string& message) = 0;  ///< says why the node cannot run
};

}  // namespace fluidcarve
