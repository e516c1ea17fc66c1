#include "graph/frames_of_inputs.h"

#include "graph/confinement.h"
#include "graph/types/frame_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace fluidcarve {
namespace {

/// The frames of an input whose files are there, at least one. Else adds a problem and returns nothing.
std::optional<FrameSet> frames_of(const FramedInput& input, Problems& problems) {
    if (!Confinement::of_program().refusal(input.path.at(1)).empty()) return std::nullopt;
    try {
        auto frames = frames_there(input.path);
        if (frames && !frames->frames().empty()) return frames;
        add(problems, input.mark,
            frames ? fmt::format("frames: auto finds no file of any frame of {}", input.path.text())
                   : fmt::format("frames: auto looks into one folder, and {} has a frame token in its folder; name the frames", input.path.text()));
    } catch (const Failure& failure) {
        add(problems, input.mark, fmt::format("frames: auto: {}", failure.what()));
    }
    return std::nullopt;
}

}  // namespace

std::optional<FrameSet> frames_of_inputs(const std::vector<FramedInput>& inputs, const Mark& frames, Problems& problems) {
    if (inputs.empty())
        return add(problems, frames, "frames: auto takes the frames whose files are there, but no input has a frame token such as ####; leave `frames` out"),
               std::nullopt;
    std::optional<std::vector<int>> common;
    std::vector<std::string> each;
    for (const auto& input : inputs) {
        const auto there = frames_of(input, problems);
        if (!there) return std::nullopt;
        std::vector<int> both;
        if (common) std::ranges::set_intersection(*common, there->frames(), std::back_inserter(both));
        common = common ? std::move(both) : there->frames();
        each.push_back(fmt::format("'{}' has {}", input.node, there->text()));
    }
    if (common->empty())
        return add(problems, frames, fmt::format("frames: auto takes the frames that all inputs have, and there is none: {}", fmt::join(each, ", "))),
               std::nullopt;
    return FrameSet(std::move(*common));
}

}  // namespace fluidcarve
