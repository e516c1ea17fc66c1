#include "graph/old_files.h"

#include "carve/base/failure.h"
#include "formats/file/confinement.h"
#include "formats/file/frame_files.h"

#include <fmt/format.h>

#include <vector>

namespace fluidcarve {

void note_old_files(Pipeline& pipeline) {
    const auto look_at = [&](const PathPattern& output, const FrameSet& frames) {
        if (!output.per_frame() ||
            !Confinement::of_program().refusal(output.at(frames.frames().front())).empty())
            return;
        auto others = frames_there(output).value_or(FrameSet()).frames();
        std::erase_if(others, [&](int frame) { return frames.contains(frame); });
        if (others.empty()) return;
        const bool one = others.size() == 1;
        pipeline.notes.push_back(fmt::format(
            "{} has {} {} from before: this sequence does not have {}, and the {}", output.text(),
            one ? "a file of frame" : "files of frames", FrameSet(others).text(),
            one ? "it" : "them", one ? "file stays" : "files stay"));
    };
    for (const auto& node : pipeline.nodes)
        for (const auto& spec : node.type->params) try {
                if (!node.params) continue;  // a node with faults
                if (spec.writes_file()) look_at(spec.path(node.params.get()), node.frames);
            } catch (const Failure&) {
                // An unreadable folder is reported when a file is written to it.
            }
}

}  // namespace fluidcarve
