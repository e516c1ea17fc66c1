#include "runtime/tell/outcome.h"

#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {

std::string done_text(const Outcome& outcome) {
    const auto frames = counted(outcome.frames, "frame");
    const auto out =
        outcome.idle ? fmt::format("done: nothing had to be done, all is there already: {}", frames)
                     : fmt::format("done: {} in {:.1f} s", frames, outcome.seconds);
    return outcome.paths.empty() ? out
                                 : fmt::format("{} -> {}", out, fmt::join(outcome.paths, ", "));
}

std::string interrupted_text(bool kept) {
    return kept ? "interrupted; run it again to continue"
                : "interrupted; with --no-cache the next run begins anew";
}

bool nothing_to_do(const std::vector<NodeDemand>& demands) {
    return std::ranges::any_of(demands,
                               [](const NodeDemand& demand) { return demand.needed > 0; }) &&
           std::ranges::all_of(demands, [](const NodeDemand& demand) {
               return demand.computed == 0 && demand.consumed_inputs == 0;
           });
}

std::vector<std::string> written_paths(const Pipeline& pipeline,
                                       const std::vector<NodeDemand>& demands) {
    std::vector<std::string> out;
    for (std::size_t n = 0; n < demands.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (demands[n].needed == 0) continue;
        for (const auto& [param, path] : node.written())
            if (std::ranges::find(out, path.text()) == out.end()) out.push_back(path.text());
    }
    return out;
}

std::optional<std::size_t> written_frames(const Pipeline& pipeline,
                                          const std::vector<NodeDemand>& demands) {
    std::optional<std::size_t> out;
    for (std::size_t n = 0; n < demands.size(); ++n) {
        if (demands[n].needed == 0) continue;
        for (const auto& [param, path] : pipeline.nodes[n].written())
            if (path.per_frame()) out = std::max(out.value_or(0), demands[n].needed);
    }
    return out;
}

}  // namespace fluidcarve
