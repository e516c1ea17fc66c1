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

/// What the results of a run depend on, as keys, known before anything runs: node type and version, parameters, what is in
/// the files that are read (never where they are), and the keys of all inputs. Equal keys: equal results. Safe from several threads.
class Keys {
public:
    /// @param frames     the sequence, frames left out removed
    /// @param stands_in  per node: frames that another frame's file serves
    /// @param wants      whether a gatherer takes the frame at a place
    Keys(const Pipeline& pipeline, const std::vector<int>& frames, const std::map<std::size_t, std::map<int, int>>& stands_in, FileHashes& files,
         std::function<bool(std::size_t node, std::size_t place)> wants);
    /// To be called once frames and stand-ins are known.
    void reset();

    /// Of what a node delivers for the frame at a place; of one that delivers once, whatever the place.
    Key result(std::size_t node, std::size_t place);
    /// Under which it is kept: the same, but for growing results, which are kept together however much is wished for.
    Key kept(std::size_t node, std::size_t place);
    /// Of what a gatherer takes of a frame: its digest, or its inputs.
    Key taken(std::size_t node, std::size_t place);
    /// Of all that a gatherer knows after its last frame.
    Key gathered(std::size_t node);

    /// The files that a node reads for the frame at a place.
    std::vector<std::string> files(std::size_t node, std::size_t place) const;
    /// What is in them; nothing if one can't be read.
    Key contents(std::size_t node, std::size_t place);
    /// What is in the plugin that a node's type comes from; nothing if it is built in.
    std::optional<Key> plugin(std::size_t node) const;

private:
    bool streams_in(std::size_t node) const;
    /// Type and parameters.
    void describe(ContentHash& hash, std::size_t node, const std::vector<std::string>* fields) const;
    /// @param fields  those that count; null: all. @param per_frame  nothing: both those that arrive per frame and those that arrive once
    void add_inputs(ContentHash& hash, std::size_t node, std::size_t place, const std::vector<std::string>* fields, std::optional<bool> per_frame);

    const Pipeline& pipeline_;
    const std::vector<int>& frames_;
    const std::map<std::size_t, std::map<int, int>>& stands_in_;
    FileHashes& files_;
    const std::function<bool(std::size_t, std::size_t)> wants_;
    std::recursive_mutex mutex_;
    std::vector<std::vector<std::optional<Key>>> kept_, taken_;  ///< per node and place
    std::vector<std::optional<Key>> gathered_;
};

/// A parameter that says what is computed: none that names a file.
bool counts(const ParamSpec& param);

}  // namespace fluidcarve
