#pragma once

#include "graph/pipeline.h"

#include <cstddef>
#include <optional>
#include <set>
#include <vector>

namespace fluidcarve {

/// The frames of each node of a run. Nodes behind one that retimes have other frames than the
/// readers.
class Timelines {
public:
    /// Frames of a node.
    struct Line {
        std::vector<int> frames;  ///< their numbers
        /// Per frame of the sequence: its index in `frames`; nothing: the node does not have it.
        std::vector<std::optional<std::size_t>> index;
    };

    Timelines() = default;
    /// @param left_out  frames that readers leave out
    Timelines(const Pipeline& pipeline, const std::set<int>& left_out);

    /// The frames of all nodes together, as numbers. `t` is an index in them.
    const std::vector<int>& frames() const { return frames_; }
    /// The frames that its inputs have.
    const Line& input_frames(std::size_t node) const { return lines_[input_frames_[node]]; }
    /// The frames in which it delivers.
    const Line& delivered(std::size_t node) const { return lines_[delivered_[node]]; }

private:
    std::vector<int> frames_;
    std::vector<Line> lines_;                            ///< each once
    std::vector<std::size_t> input_frames_, delivered_;  ///< per node: index in `lines_`
};

}  // namespace fluidcarve
