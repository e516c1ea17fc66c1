#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/cache.h"
#include "runtime/keep/dependencies.h"
#include "runtime/keep/file_hashes.h"
#include "runtime/keep/grown_result.h"
#include "runtime/keep/keys.h"
#include "runtime/keep/node_log.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The results of a pipeline's nodes, found by node and frame: the store knows the entry of each
/// result in the Cache, and whether it is still valid. It holds results of former runs and of this
/// one. Thread-safe.
/// `t` is an index in the sequence of frames; it is ignored for nodes that deliver once.
class Store {
public:
    Store(const Pipeline& pipeline, const Dependencies& dependencies, Keys& keys, Cache& cache,
          FileHashes& files);

    /// Whether a result need not be computed: it is cached and, if it grows, large enough; or, for
    /// a writer, its files are up to date.
    bool knows(std::size_t node, std::size_t t);
    bool knows_digest(std::size_t node, std::size_t t);
    /// The same, but reads the whole entry; a damaged one does not count.
    bool knows_intact(std::size_t node, std::size_t t) {
        return knows(node, t) && cache_.intact(keys_.entry(node, t));
    }
    bool knows_intact_digest(std::size_t node, std::size_t t) {
        return knows_digest(node, t) && cache_.intact(keys_.digest(node, t));
    }
    /// How much of a growing result is kept; nothing: none of it is.
    std::optional<GrownResult> grown(std::size_t node);
    /// Warnings and report entries from the computation of a cached result.
    NodeLog log(std::size_t node, std::size_t t);
    NodeLog log_of_digest(std::size_t node, std::size_t t) const;

    /// Cached outputs; nothing if they are missing or damaged.
    std::optional<std::vector<Payload>> result(std::size_t node, std::size_t t);
    std::optional<Payload> digest(std::size_t node, std::size_t t);
    /// The cached part of a growing result, which may be too small, and its report entry.
    std::optional<std::pair<Payload, nlohmann::ordered_json>> part(std::size_t node);

    /// Caches the log of a body, and its outputs if the node is cached.
    void keep(std::size_t node, std::size_t t, const std::vector<Payload>& outputs,
              const NodeLog& log);
    void keep_digest(std::size_t node, std::size_t t, const Payload& digest, const NodeLog& log);
    /// Caches a growing result, unless the entry already holds more.
    /// @param part  whether the node is still working on it
    void keep_grown(std::size_t node, std::size_t t, const Payload& result, const NodeLog& log,
                    bool part);

    /// Paths of the files that a node may read for frame `t`.
    std::vector<std::string> inputs(std::size_t node, std::size_t t) const {
        return dependencies_.watched_files(node, t);
    }
    /// Paths of the files that a writer writes for frame `t`.
    std::vector<std::string> outputs(std::size_t node, std::size_t t) const;

private:
    /// Key of the cache entry of a result.
    Hash key(std::size_t node, std::size_t t) { return keys_.entry(node, t); }
    struct Whole {
        std::vector<Payload> outputs;
        NodeLog log;
    };
    /// A cached result; a growing one is cut to the wanted count.
    std::optional<Whole> whole(std::size_t node, std::size_t t);
    /// The header of an entry.
    nlohmann::ordered_json header_of(const NodeLog& log) const;
    void keep_files(std::size_t node, std::size_t t, const NodeLog& log);

    const Pipeline& pipeline_;
    const Dependencies& dependencies_;
    Keys& keys_;
    Cache& cache_;
    FileHashes& files_;
};

}  // namespace fluidcarve
