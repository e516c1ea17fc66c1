#include "graph/frames_of_inputs.h"

#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "formats/file/frame_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace fluidcarve {
namespace {

/// The frames of an input whose files are there, at least one. Else adds a problem and returns
/// nothing.
std::optional<FrameSet> frames_of(const FramedInput& input, Problems& problems) {
    if (!Confinement::of_program().refusal(input.path.at(1)).empty()) return std::nullopt;
    try {
        auto frames = frames_there(input.path);
        if (frames && !frames->frames().empty()) return frames;
        add(problems, input.mark,
            frames ? fmt::format("frames: auto finds no file of any frame of {}", input.path.text())
                   : fmt::format("frames: auto looks into one folder, and {} has a frame token in "
                                 "its folder; name the frames",
                                 input.path.text()));
    } catch (const Failure& failure) {
        add(problems, input.mark, fmt::format("frames: auto: {}", failure.what()));
    }
    return std::nullopt;
}

}  // namespace

std::optional<FrameSet> frames_of_inputs(const std::vector<FramedInput>& inputs, const Mark& frames,
                                         Problems& problems) {
    if (inputs.empty())
        return add(problems, frames,
                   "frames: auto takes the frames whose files are there, but no input has a frame "
                   "token such as ####; leave `frames` out"),
               std::nullopt;
    std::optional<std::vector<int>> common;
    std::vector<std::string> each;
    for (const auto& input : inputs) {
        const auto there = frames_of(input, problems);
        if (!there) return std::nullopt;
        std::vector<int> both;
        if (common)
            std::ranges::set_intersection(*common, there->frames(), std::back_inserter(both));
        common = common ? std::move(both) : there->frames();
        each.push_back(fmt::format("'{}' has {}", input.node, there->text()));
    }
    if (common->empty())
        return add(problems, frames,
                   fmt::format(
                       "frames: auto takes the frames that all inputs have, and there is none: {}",
                       fmt::join(each, ", "))),
               std::nullopt;
    return FrameSet(std::move(*common));
}

std::string holes_in(const FrameSet& frames) {
    constexpr std::size_t most_told = 1000;
    const auto& there = frames.frames();
    bool regular = there.size() > 2;
    std::vector<int> missing;
    for (std::size_t n = 1; n < there.size(); ++n) {
        regular = regular && there[n] - there[n - 1] == there[1] - there[0];
        for (int frame = there[n - 1] + 1; frame < there[n] && missing.size() < most_told; ++frame)
            missing.push_back(frame);
    }
    if (missing.empty() || regular) return {};
    return fmt::format("frames: auto takes {}: of {} to {}, {} {} missing",
                       counted(there.size(), "frame"), there.front(), there.back(),
                       FrameSet(missing).text(), missing.size() == 1 ? "is" : "are");
}

std::string note_on_odd_frames(const PathPattern& input) {
    if (!Confinement::of_program().refusal(input.at(1)).empty()) return {};
    const auto odd = odd_frames_there(input);
    if (odd.empty()) return {};
    return fmt::format(
        "{} {} of {}, and left out: a frame is a whole number with as many digits as the token "
        "says",
        fmt::join(odd, ", "), odd.size() == 1 ? "is no frame" : "are no frames", input.text());
}

}  // namespace fluidcarve
