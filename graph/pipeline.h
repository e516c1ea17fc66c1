#pragma once

#include "graph/document.h"
#include "graph/types/load_plugin.h"
#include "graph/types/registry.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// How often a node delivers.
enum class Rate {
    fixed,     ///< `static`: once, from files and parameters alone
    sequence,  ///< once, after all frames
    frame,     ///< for every frame
};
std::string to_text(Rate rate);

/// One end of a connection.
struct Link {
    std::size_t node = 0;    ///< index in Pipeline::nodes
    std::size_t output = 0;  ///< index in Node::outputs
};

/// A node of a pipeline, its type resolved, its parameters parsed, its inputs connected.
struct Node {
    std::string name;
    Mark mark;
    const NodeType* type = nullptr;
    std::shared_ptr<const void> params;                 ///< null in a pipeline with problems
    std::vector<OutputSpec> outputs;                    ///< the type's, then those that a parameter names
    std::vector<std::vector<Link>> inputs;              ///< per InputSpec of the type
    std::vector<std::vector<std::string>> input_names;  ///< per InputSpec: the names of a named input's links
    bool kept = false;                                  ///< its results go to the work folder; of a writer: files that are current stay
    bool digests_kept = false;                          ///< what it digests of each frame does
    bool gathers = false;                               ///< takes all frames, in order, before it delivers
    Rate rate = Rate::fixed;                            ///< of its outputs, or of its run if it has none
    bool per_frame_input = false;                       ///< some input arrives per frame
};

/// A checked pipeline: typed, acyclic, complete. Nodes stand in an order in which each comes after its inputs.
struct Pipeline {
    std::string name;                ///< the file, as given
    std::vector<std::string> files;  ///< it and those that it extends
    FrameSet frames;                 ///< the sequence
    std::vector<Node> nodes;
    PluginFiles plugins;  ///< of node types that are not built in

    const Node* find(std::string_view name) const;
    std::vector<std::string> node_names() const;
    /// Whether a node delivers files and nothing else.
    bool writes(std::size_t node) const;
    /// Nodes whose outputs nobody reads: writers, and whatever hangs loose.
    std::vector<std::size_t> leaves() const;
    /// `nodes` and all that they need, as one flag per node.
    std::vector<bool> upstream_of(const std::vector<std::size_t>& nodes) const;
};

/// Who uses a file that is about to be written: "'sim' reads it", "it is the pipeline"; empty if nobody does.
std::string user_of(const Pipeline& pipeline, const std::string& path);

/// Checks a document against the registry. Opens no data.
/// @return the pipeline; meaningless if problems were added
Pipeline build_pipeline(const Document& document, const Registry& registry, Problems& problems);

}  // namespace fluidcarve
