#pragma once

#include "formats/file/content_hash.h"
#include "graph/pipeline.h"
#include "runtime/keep/file_hashes.h"
#include "runtime/plan/timelines.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Paths of the files that a node reads for a frame number: those that its parameters name, and
/// its FurtherDependencies::files.
std::vector<std::string> named_files(const Node& node, int frame);

/// What the results of a pipeline's nodes depend on. Cache keys are hashes of it (Keys), and by it
/// a run can say what changed since the last one (History). Thread-safe.
class Dependencies {
public:
    /// A parameter. Paths do not count as dependencies; the content of the files does.
    struct Param {
        std::string name, text;
        /// The part that belongs to the cache key: all of it, except the count of a growing result
        /// (Growth::rest); nothing of Growth::best_effort.
        std::optional<std::string> rest;
    };
    /// A connected input; each connection of a list is one Input.
    struct Input {
        std::string name, link_name;  ///< names of the port, and of the link at a named input
        std::size_t source = 0;       ///< the node that it reads
        std::string output;  ///< name of the source's output, or of the part of its first one
    };
    /// Dependencies that are the same in all frames.
    struct OfNode {
        std::string type;
        int version = 1;
        std::optional<Hash> plugin;  ///< hash of the plugin file that declares the type, whose
                                     ///< author may have forgotten to raise the version
        std::vector<Param> params;   ///< with a FurtherDependencies::version as `VERSION`
        std::vector<Input> inputs;
    };

    /// @param stands_in  per node: frame to the frame whose file it uses instead of its own
    Dependencies(const Pipeline& pipeline, const Timelines& timelines,
                 const std::map<std::size_t, std::map<int, int>>& stands_in, FileHashes& files)
        : pipeline_(pipeline), timelines_(timelines), stands_in_(stands_in), files_(files) {}

    /// The frames of all nodes together, as numbers.
    const std::vector<int>& frames() const { return timelines_.frames(); }
    /// The frames that a node takes, as numbers.
    const std::vector<int>& frames_of(std::size_t node) const {
        return timelines_.input_frames(node).frames;
    }
    OfNode of(std::size_t node) const;
    /// Paths of the files that a node reads for frame `t` (an index in `frames`).
    std::vector<std::string> files(std::size_t node, std::size_t t) const;
    /// Hash of the content of these files; zero if one can't be read.
    Hash contents(std::size_t node, std::size_t t) const;
    /// These files, and the missing ones for which they stand in: if one of the latter appears, the
    /// node may read it.
    std::vector<std::string> watched_files(std::size_t node, std::size_t t) const;

private:
    /// Number of the frame whose files a node reads for frame `t`.
    int read_frame(std::size_t node, std::size_t t) const;

    const Pipeline& pipeline_;
    const Timelines& timelines_;
    const std::map<std::size_t, std::map<int, int>>& stands_in_;
    FileHashes& files_;
};

}  // namespace fluidcarve
