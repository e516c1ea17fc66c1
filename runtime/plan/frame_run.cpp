#include "runtime/plan/frame_run.h"

#include <algorithm>
#include <set>

namespace fluidcarve {

bool Wiring::failed_before(std::size_t node, const FrameRun& frame) const {
    return std::ranges::any_of(sources[node],
                               [&](std::size_t source) { return frame.failed[source] != 0; });
}

void Wiring::release(std::size_t node, FrameRun& frame) const {
    for (const auto source : sources[node])
        if (frame.readers[source].fetch_sub(1) == 1) frame.outputs[source].clear();
    if (readers[node].empty()) frame.outputs[node].clear();
}

Wiring wire(const Pipeline& pipeline, const Pass& pass) {
    Wiring out;
    out.units = pass.per_frame;
    out.units.insert(out.units.end(), pass.gathering.begin(), pass.gathering.end());
    out.sources.resize(pipeline.nodes.size());
    out.readers.resize(pipeline.nodes.size());
    for (const auto unit : out.units) {
        std::set<std::size_t> distinct;
        const bool gathers = std::ranges::find(pass.gathering, unit) != pass.gathering.end();
        // A node that retimes delivers from frames that it took in an earlier pass.
        if (pipeline.nodes[unit].retimes() && !gathers) continue;
        for (const auto& link : pipeline.nodes[unit].links())
            if (pipeline.nodes[link.node].rate == Rate::frame) distinct.insert(link.node);
        for (const auto source : distinct) {
            out.sources[unit].push_back(source);
            out.readers[source].push_back(unit);
        }
    }
    return out;
}

}  // namespace fluidcarve
