#include "graph/infer_timelines.h"

#include "carve/base/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace fluidcarve {

namespace {

/// The frames that the inputs of a node have, which must be the same; of none, the sequence.
FrameSet frames_taken(const Node& node, const std::vector<Node*>& nodes, const FrameSet& sequence,
                      Problems& problems) {
    const Node* first = nullptr;
    for (const auto& link : node.links()) {
        const auto& source = *nodes[link.node];
        if (source.rate != Rate::frame) continue;
        if (!first) first = &source;
        else if (source.frames.frames() != first->frames.frames())
            add(problems, node.mark,
                fmt::format("'{}' has the frames {}, but '{}' has {}: take both from "
                            "before the change of time, or both from behind it",
                            first->name, first->frames.text(), source.name, source.frames.text()));
    }
    return first ? first->frames : sequence;
}

}  // namespace

FrameSet infer_timelines(const std::vector<Node*>& nodes, const FrameSet& sequence,
                         Problems& problems) {
    auto all = sequence.frames();
    for (auto* const node : nodes) {
        node->input_frames = frames_taken(*node, nodes, sequence, problems);
        node->frames = node->input_frames;
        if (!node->retimes()) continue;
        try {
            node->frames = FrameSet(node->traits.retimes(node->input_frames.frames()));
        } catch (const Failure& failure) {
            add(problems, node->mark, failure.what());
        }
        const auto& made = node->frames.frames();
        std::vector<int> united;
        std::ranges::set_union(all, made, std::back_inserter(united));
        all = std::move(united);
    }
    return FrameSet(std::move(all));
}

}  // namespace fluidcarve
