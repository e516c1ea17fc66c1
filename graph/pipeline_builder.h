#pragma once

#include "carve/base/frame_set.h"
#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/types/registry.h"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fluidcarve {

/// One connection as written: `node` or `node.port`.
struct Reference {
    Mark mark;
    std::string node;
    std::string port;  ///< empty: the main output
};

/// A node during the checks.
struct UnfinishedNode {
    Node node;
    const Value* value = nullptr;                    ///< the node's map in the document
    std::vector<std::vector<Reference>> references;  ///< `[input][connection]`
    bool unsure = false;  ///< the rate is unknown because of a problem here or upstream
};

/// Builds a pipeline from a document, step by step.
class PipelineBuilder {
public:
    PipelineBuilder(const Document& document, const Registry& registry, Problems& problems)
        : document_(document), registry_(registry), problems_(problems) {}

    Pipeline build();

private:
    FrameSet read_frames();
    FrameSet auto_frames();
    void read_node(const Value::Field& field);

    /// Suggests the nearest type, else the types of the family, else the command that lists all
    /// types.
    std::string near_type(const std::string& name) const;
    void read_params(UnfinishedNode& unfinished);

    /// Adds the reasons for which nodes can't run.
    void add_foreseen(const Pipeline& pipeline);

    /// Decides whether results are cached: the node's `cache` field, else the type.
    void read_cache(UnfinishedNode& unfinished);
    void read_references(UnfinishedNode& unfinished, std::size_t n);
    void connect(UnfinishedNode& unfinished);
    std::optional<Link> resolve(const Reference& reference, const UnfinishedNode& unfinished,
                                std::size_t input);

    /// Sorts the nodes so that each comes after its inputs. If there is a cycle, adds a problem
    /// and returns false.
    bool order();

    /// @param nodes  each reads the next; the last reads the first
    void report_cycle(std::vector<std::size_t> nodes);
    void infer_rates();

    /// Checks the paths of writers. A writer that runs per frame needs a frame token, unless there
    /// is one frame and it reads no sequence; a writer that runs once can't have one. No file may
    /// be written twice or overwrite an input.
    void check_paths(const FrameSet& frames);

    /// If a reader upstream of a writer reads a sequence as one file, adds the problem there.
    /// @param mark  of the writer's path @return whether there is such a reader
    bool blame_reader(const Node& writer, const Mark& mark, const FrameSet& frames);

    /// Checks that other nodes write the files of all WrittenPaths.
    void check_written(const FrameSet& frames);

    /// Checks that all files lie where the program may read and write.
    void check_confinement(const FrameSet& frames);

    const Document& document_;
    const Registry& registry_;
    Problems& problems_;
    std::vector<UnfinishedNode> nodes_;
    std::map<std::string, std::size_t> index_;  ///< name to index in `nodes_`
    /// All node names in the file, also of nodes with an unknown type.
    std::set<std::string> known_;
    /// Nodes that read a file per frame, and nodes downstream of them.
    std::set<std::string> sequences_;
    std::vector<std::string> notes_;  ///< Pipeline::notes
};

}  // namespace fluidcarve
