#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Moves payloads into and out of the ports of a pipeline's nodes.
struct PortIo {
    using Outputs = std::vector<std::vector<Payload>>;  ///< `[node][output]`

    const Pipeline& pipeline;
    const Registry& registry;

    /// Sets a node's input ports.
    /// @param held  outputs of nodes that run once
    /// @param frame  outputs of a frame; null: inputs that arrive per frame stay empty
    void connect(std::size_t node, void* ports, const Outputs& held, const Outputs* frame) const;
    /// The nodes of which a node reads outputs, or states checksums of outputs in its files.
    std::set<std::size_t> sources(std::size_t node) const;
    /// The reverse, for all nodes.
    std::vector<std::set<std::size_t>> readers() const;
    /// Whether an input of `reader` is connected to this output of a node.
    bool reads(std::size_t reader, std::size_t node, std::string_view output) const;
    std::vector<Payload> collect(std::size_t node, const void* ports) const;
    std::uint64_t bytes(const std::vector<Payload>& payloads) const;  ///< in memory

private:
    /// The value that an input gets: the whole payload, converted if necessary, or a part of it.
    Payload value_of(const Link& link, const Payload& payload, const InputSpec& spec) const;
};

}  // namespace fluidcarve
