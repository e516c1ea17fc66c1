#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The provenance of the files of a run. Thread-safe.
class FileProvenance {
public:
    /// @param held  `[node][output]`: results of nodes that run once
    FileProvenance(const Pipeline& pipeline, const Registry& registry,
                   const std::vector<std::vector<Payload>>& held)
        : pipeline_(pipeline), registry_(registry), held_(held) {}

    /// Node::provenance of a writer, with the checksums of the results that its files are made
    /// from, which must be held by now.
    Provenance of(std::size_t writer);

private:
    const Pipeline& pipeline_;
    const Registry& registry_;
    const std::vector<std::vector<Payload>>& held_;
    std::mutex mutex_;
    std::map<std::pair<std::size_t, std::size_t>, std::string> checksums_;  ///< by node and output
};

}  // namespace fluidcarve
