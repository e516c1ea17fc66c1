#pragma once

#include "formats/file/content_hash.h"
#include "graph/pipeline.h"
#include "runtime/keep/dependencies.h"

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Cache keys of a pipeline's results, known before anything runs. A key is a hash of what the
/// result depends on (Dependencies), with the keys of the results that it reads in place of their
/// nodes. Equal keys mean equal results. Thread-safe.
class Keys {
public:
    /// @param takes  whether a gathering node takes frame `t` (an index in the sequence)
    Keys(const Pipeline& pipeline, const Dependencies& dependencies,
         std::function<bool(std::size_t node, std::size_t t)> takes);

    /// Key of a node's result for frame `t`; `t` is ignored if the node delivers once.
    Hash result(std::size_t node, std::size_t t);
    /// Key of the cache entry with that result. Differs from `result` only for growing results: one
    /// entry serves all counts.
    Hash entry(std::size_t node, std::size_t t);
    /// Key of a gathering node's digest of a frame; without a digest, of its inputs in that frame.
    Hash digest(std::size_t node, std::size_t t);
    /// Key of a gathering node's state after its last frame.
    Hash gathered(std::size_t node);

private:
    /// Adds the keys of a node's inputs to a hash.
    /// @param fields     the inputs to add; null: all
    /// @param per_frame  true: only inputs that arrive per frame; false: only inputs that arrive
    ///   once; nothing: both
    void add_inputs(Hasher& hash, const Dependencies::OfNode& of, std::size_t t,
                    const std::vector<std::string>* fields, std::optional<bool> per_frame);

    const Pipeline& pipeline_;
    const Dependencies& dependencies_;
    const std::function<bool(std::size_t, std::size_t)> takes_;
    std::recursive_mutex mutex_;
    std::vector<std::vector<std::optional<Hash>>> entries_, digests_;  ///< `[node][t]`
    std::vector<std::optional<Hash>> gathered_;
};

}  // namespace fluidcarve
