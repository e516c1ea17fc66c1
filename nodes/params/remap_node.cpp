#include "nodes/params/remap_node.h"

#include "carve/base/failure.h"
#include "nodes/params/join_params.h"

#include <fmt/format.h>

namespace fluidcarve {

void RemapNode::check(const Params& params, NodeCheck& check) {
    check_rim_fade(params.rim, check);
    check_join(params, check);
}

NodeTraits RemapNode::traits(const Params& params) {
    return {.gathers = params.in_time.has_value(),
            .retimes = [&params](const std::vector<int>& frames) {
                return params.in_time->left(params.count, frames);
            }};
}

void RemapNode::foresee_frames(const Params& params, const std::string& idle,
                               bool transform_vectors, Outlook& ahead) {
    if (!idle.empty())
        ahead.fault(
            fmt::format("'{}' has no effect on seams of frames (`axis: t`), which move "
                        "nothing within a frame: leave it out",
                        idle));
    if (ahead.once())
        ahead.fault(
            "has a source that is the same in all frames: there are no frames to take out or to "
            "repeat; leave this node out");
    if (ahead.receives("seams").size() > 1)
        ahead.fault(
            "takes seams of frames (`axis: t`) alone: carve them by a node of their own, and "
            "its result by the others");
    try {
        const auto how = time_join_of(params, false);
        if (transform_vectors && (how.fade == 1 || !how.moved))
            ahead.fault(
                "'transform_vectors' has no effect where frames are cut or blended, since time "
                "keeps its pace there: leave it out, or state `join: squeeze`");
    } catch (const Failure& failure) {
        ahead.fault(failure.what());
    }
}

void RemapNode::finish_frames(const Params& params, const Seams& seams, Context& context) {
    frames_.finish(seams, seams_of(params.count, seams).value_or(seams.size()),
                   traits(params).retimes(frames_.numbers()), params, context.limits().memory);
}

}  // namespace fluidcarve
