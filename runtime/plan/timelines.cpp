#include "runtime/plan/timelines.h"

#include "carve/base/frame_set.h"

#include <algorithm>

namespace fluidcarve {

Timelines::Timelines(const Pipeline& pipeline, const std::set<int>& left_out) {
    std::vector<bool> retimed;  // per node, in order
    std::set<int> all;
    const auto add = [&](const FrameSet& frames, bool made) {
        Line line;
        for (const auto frame : frames.frames())
            if (made || !left_out.contains(frame)) line.frames.push_back(frame);
        const auto found = std::ranges::find(lines_, line.frames, &Line::frames);
        const auto at = static_cast<std::size_t>(found - lines_.begin());
        all.insert(line.frames.begin(), line.frames.end());
        if (found == lines_.end()) lines_.push_back(std::move(line));
        return at;
    };
    for (const auto& node : pipeline.nodes) {
        bool behind = false;
        for (const auto& link : node.links())
            behind =
                behind || (retimed[link.node] && pipeline.nodes[link.node].rate == Rate::frame);
        retimed.push_back(behind || node.retimes());
        input_frames_.push_back(add(node.input_frames, behind));
        delivered_.push_back(add(node.frames, retimed.back()));
    }
    frames_.assign(all.begin(), all.end());
    for (auto& line : lines_) {
        line.index.resize(frames_.size());
        for (std::size_t n = 0, t = 0; n < line.frames.size(); ++n) {
            while (frames_[t] != line.frames[n]) ++t;
            line.index[t] = n;
        }
    }
}

}  // namespace fluidcarve
