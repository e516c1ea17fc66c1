#pragma once

#include "carve/base/region.h"

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// What a node tells of its outputs before they are there, by names that nodes agree on. What is
/// not among them is not known.
using OutputFacts = std::map<std::string, int, std::less<>>;

/// Interface for a node's `foresee`, which looks at what is known of its inputs before a run
/// starts.
class Outlook {
public:
    virtual ~Outlook() = default;
    /// Where an input lies; null: not known, or not connected.
    virtual const Region* region(std::string_view input) const = 0;
    /// What is told of an input, connection by connection; empty: not connected.
    virtual const std::vector<OutputFacts>& told(std::string_view input) const = 0;
    /// Whether the node runs once for several frames.
    virtual bool once() const = 0;
    virtual std::size_t frames() const = 0;  ///< number of those that its inputs have

    /// Says where all outputs will lie; without a call they lie where all inputs lie together.
    virtual void lies(const Region& region) = 0;
    virtual void tell(const OutputFacts& facts) = 0;
    virtual void warn(const std::string& message) = 0;
    virtual void fault(const std::string& message) = 0;  ///< says why the node cannot run
};

}  // namespace fluidcarve
