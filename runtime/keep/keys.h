#pragma once

#include "graph/pipeline.h"
#include "runtime/keep/content_hash.h"
#include "runtime/keep/file_hashes.h"

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Cache keys of a pipeline's results, known before anything runs. A key is a hash of the node's type and version, its parameters, the
/// content of the files that it reads (not their paths), and the keys of its inputs. Equal keys mean equal results. Thread-safe.
class Keys {
public:
    /// @param frames     frame numbers of the sequence, without the frames that readers leave out
    /// @param stands_in  per node: frame to the frame whose file it uses instead of its own
    /// @param wants      whether a gatherer takes the frame at a place (an index in `frames`)
    Keys(const Pipeline& pipeline, const std::vector<int>& frames, const std::map<std::size_t, std::map<int, int>>& stands_in, FileHashes& files,
         std::function<bool(std::size_t node, std::size_t place)> wants);
    /// Forgets all keys. To be called when frames or stand-ins change.
    void reset();

    /// Key of a node's result for the frame at a place. The place is ignored if the node delivers once.
    Key result(std::size_t node, std::size_t place);
    /// Key of the cache entry with that result. Differs from `result` only for growing results: one entry serves all counts.
    Key kept(std::size_t node, std::size_t place);
    /// Key of a gatherer's digest of a frame; without a digest, of its inputs in that frame.
    Key taken(std::size_t node, std::size_t place);
    /// Key of a gatherer's state after its last frame.
    Key gathered(std::size_t node);

    /// Paths of the files that a node reads for the frame at a place.
    std::vector<std::string> files(std::size_t node, std::size_t place) const;
    /// Hash of the content of these files; zero if one can't be read.
    Key contents(std::size_t node, std::size_t place);
    /// Hash of the plugin file that declares the node's type; nothing if the type is built in.
    std::optional<Key> plugin(std::size_t node) const;

private:
    /// Adds type, version and parameters to a hash. @param fields  the parameters to add; null: all
    void describe(ContentHash& hash, std::size_t node, const std::vector<std::string>* fields) const;
    /// Adds the keys of a node's inputs to a hash.
    /// @param fields     the inputs to add; null: all
    /// @param per_frame  true: only inputs that arrive per frame; false: only inputs that arrive once; nothing: both
    void add_inputs(ContentHash& hash, std::size_t node, std::size_t place, const std::vector<std::string>* fields, std::optional<bool> per_frame);

    const Pipeline& pipeline_;
    const std::vector<int>& frames_;
    const std::map<std::size_t, std::map<int, int>>& stands_in_;
    FileHashes& files_;
    const std::function<bool(std::size_t, std::size_t)> wants_;
    std::recursive_mutex mutex_;
    std::vector<std::vector<std::optional<Key>>> kept_, taken_;  ///< `[node][place]`
    std::vector<std::optional<Key>> gathered_;
};

/// Whether a parameter is part of the cache key: all but paths.
bool counts(const ParamSpec& param);

}  // namespace fluidcarve
