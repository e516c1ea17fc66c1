#pragma once

#include "carve/base/frame_set.h"
#include "graph/document.h"
#include "graph/types/load_plugin.h"
#include "graph/types/registry.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// How often a node delivers its outputs.
enum class Rate {
    fixed,     ///< called `static` in texts: once, from files and parameters alone
    sequence,  ///< once, after all frames
    frame,     ///< for every frame
};
std::string to_text(Rate rate);

/// One end of a connection.
struct Link {
    std::size_t node = 0;    ///< index in Pipeline::nodes
    std::size_t output = 0;  ///< index in Node::outputs
    std::string part = {};   ///< the part of the output (Selection); empty: all of it
};

/// A node of a pipeline with resolved type, parsed parameters and connected inputs.
struct Node {
    std::string name;
    Mark mark;
    const NodeType* type = nullptr;
    std::shared_ptr<const void> params;  ///< null in a pipeline with problems
    std::vector<OutputSpec> outputs;     ///< outputs of the type, then outputs named by a parameter
    std::vector<std::vector<Link>> inputs;              ///< `[input of the type][link]`
    std::vector<std::vector<std::string>> input_names;  ///< `[input of the type][link]`: names of a
                                                        ///< named input's links, else empty texts
    bool kept = false;  ///< results are cached in the work folder; for a writer: up-to-date files
                        ///< are not rewritten
    bool digests_kept = false;     ///< digests of frames are cached in the work folder
    bool gathers = false;          ///< takes all frames, in order, before it delivers
    NodeTraits traits;             ///< of the type with these parameters
    Rate rate = Rate::fixed;       ///< how often it delivers, or runs if it has no outputs
    bool per_frame_input = false;  ///< at least one input arrives per frame
    FrameSet input_frames;         ///< the frames that its inputs have
    FrameSet frames;  ///< the frames in which it delivers: those taken, unless it retimes them
    /// Of a writer: what its files state, except checksums (state_provenance)
    Provenance provenance;
    /// Of a writer: outputs upstream whose checksums its files state, too.
    std::vector<Link> checksummed;

    std::vector<Problem> warnings;  ///< warnings of its check

    /// The links of all inputs, in order.
    std::vector<Link> links() const;

    /// A path that it writes, with its parameter.
    struct Written {
        const ParamSpec& param;
        const PathPattern& path;
    };
    /// The paths that it writes, without empty ones. The parameters must be there.
    std::vector<Written> written() const;

    bool streams_in() const { return gathers && per_frame_input; }  ///< it gathers frame by frame
    /// Whether its outputs have other frames than its inputs.
    bool retimes() const { return traits.retimes && streams_in(); }
};

/// A checked pipeline: typed, acyclic, complete. Each node comes after the nodes that it reads.
struct Pipeline {
    std::string name;                ///< the file, as given
    std::vector<std::string> files;  ///< the file and the files that it extends
    FrameSet frames;                 ///< the sequence, and the frames of nodes that retime it
    std::string holes;  ///< of `frames: auto`: which frames are missing between the others, in
                        ///< words; empty: none
    std::vector<std::string> notes;  ///< surprising facts about the sequence or existing files, a
                                     ///< sentence each
    std::vector<Node> nodes;
    PluginFiles plugins;     ///< plugin file of each node type that is not built in
    bool provenance = true;  ///< whether written files state what made them

    const Node* find(std::string_view name) const;
    std::vector<std::string> node_names() const;
    /// Whether a node only writes files: it has no outputs.
    bool writes(std::size_t node) const;
    /// Nodes whose outputs no node reads: writers and unconnected nodes.
    std::vector<std::size_t> leaves() const;
    /// `nodes` and everything upstream of them, as one flag per node of the pipeline.
    std::vector<bool> upstream_of(const std::vector<std::size_t>& nodes) const;
};

/// What a link takes, as in the file: "density" of `sim.density`; a node's first output by its
/// name.
const std::string& taken_by(const Pipeline& pipeline, const Link& link);

/// All warnings of `check`: about the sequence, existing files, nodes, and, if others write, nodes
/// whose outputs no node takes. Messages begin with "warning:".
Problems warnings_of(const Pipeline& pipeline);

}  // namespace fluidcarve
