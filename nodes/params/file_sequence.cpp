#include "nodes/params/file_sequence.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/volume/volume.h"
#include "formats/file/full_path.h"
#include "formats/image/image.h"
#include "graph/types/node_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace fluidcarve {
namespace {

bool there(const InputPath& path, int frame) {
    std::error_code ignored;
    return std::filesystem::exists(path.at(frame), ignored);
}

bool same_place(const std::string& a, const std::string& b) { return full_path(a) == full_path(b); }

/// The frame whose file a frame uses: its own, else the nearest before, else the nearest after.
int held(const InputPath& path, const std::vector<int>& frames, int frame) {
    const auto at = std::ranges::lower_bound(frames, frame);
    const auto is_there = [&](int each) { return there(path, each); };
    if (at != frames.end() && is_there(*at)) return *at;
    const auto before = std::find_if(std::make_reverse_iterator(at), frames.rend(), is_there);
    if (before != frames.rend()) return *before;
    const auto after = std::find_if(at, frames.end(), is_there);
    return after == frames.end() ? frame : *after;
}

/// States that no frame's file is there.
void all_missing(const InputPath& path, Survey& survey) {
    const auto& frames = survey.frames();
    const auto needed =
        std::ranges::find_if(frames, [&](int frame) { return survey.needs(frame); });
    const auto first = needed == frames.end() ? frames.front() : *needed;
    // A relative path was looked for beside its pipeline, then in the current folder.
    const auto file = path.at(first), here = PathPattern(path.text()).at(first);
    survey.missing(
        first,
        fmt::format(
            "{} does not exist{}{}", file,
            same_place(file, here) ? "" : fmt::format(", nor does {} in the current folder", here),
            frames.size() == 1 || !path.per_frame() ? "" : ", nor does any other frame"));
}

/// The last frame up to this one whose file is there, else the first.
/// @param present  rising, not empty
int file_for(const std::vector<int>& present, int frame) {
    const auto after = std::ranges::upper_bound(present, frame);
    return after == present.begin() ? *after : *std::prev(after);
}

}  // namespace

void check_missing(const InputPath& path, Missing missing, NodeCheck& check) {
    if (missing != Missing::error && !path.per_frame())
        check.fault("missing",
                    fmt::format("'{}' is for sequences; the path has no frame token such as ####",
                                ParamTraits<Missing>::text(missing)));
}

void survey_files(const InputPath& path, Missing missing, Survey& survey,
                  const std::function<void(int frame, int file)>& look) {
    const auto& frames = survey.frames();
    std::vector<int> present;
    std::ranges::copy_if(frames, std::back_inserter(present),
                         [&](int frame) { return there(path, frame); });
    if (present.empty() && !frames.empty()) return all_missing(path, survey);
    const auto look_at = [&](int frame, int file) {
        if (!survey.needs(frame)) return;
        try {
            look(frame, file);
        } catch (const Failure& failure) {
            survey.missing(frame, failure.what());
        }
    };
    std::optional<int> stood_in;  // the stand-in of the previous frame, already looked at
    for (const int frame : frames) {
        const int file = file_for(present, frame);
        if (file == frame) {
            look_at(frame, file);
        } else if (missing == Missing::skip) {
            survey.leave_out(frame);
        } else if (missing == Missing::error) {
            survey.missing(frame, fmt::format("{} does not exist", path.at(frame)));
        } else {
            survey.stands_in(frame, file);
            if (!survey.needs(frame) || stood_in == file) continue;
            look_at(frame, file);
            stood_in = file;
        }
    }
}

bool survey_grids(std::string_view input, Survey& survey,
                  const std::function<bool(std::size_t t)>& wants,
                  const std::function<void(const std::vector<std::string>& names)>& check) {
    const auto& frames = survey.frames();
    for (std::size_t t = 0; t < frames.size(); ++t) {
        if (!survey.needs(frames[t]) || !wants(t)) continue;
        const auto* const known = survey.receives(frames[t], input);
        if (!known || !known->grids) continue;
        try {
            check(*known->grids);
        } catch (const Failure& failure) {
            survey.missing(frames[t], failure.what());
            return false;
        }
    }
    return true;
}

void survey_channels(const std::optional<std::vector<std::string>>& channels, Survey& survey) {
    survey_grids(
        "source", survey, [](std::size_t) { return true; },
        [&](const auto& there) { require_channels(channels, there); });
}

void require_grid(std::string_view input, const std::string& name,
                  const std::vector<std::string>& there) {
    if (!find_name(there, name))
        throw Failure(
            fmt::format("'{}' has no grid '{}'{}", input, name, did_you_mean(name, there)));
}

std::string file_of(const InputPath& path, Missing missing, const Context& context) {
    return path.at(missing == Missing::hold ? held(path, context.frames(), context.frame())
                                            : context.frame());
}

}  // namespace fluidcarve
