#include "nodes/params/pace_params.h"

#include "carve/base/failure.h"
#include "formats/geometry_file/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fluidcarve {

namespace {

/// The fault of a point of a curve, if any.
/// @param before  the point before it; null: it is the first
std::optional<std::string> fault_of(const std::vector<double>& point,
                                    const std::vector<double>* before) {
    if (point.size() != 2) return "a point of 'curve' is [frame, frame of the source]";
    if (std::abs(point[0]) > farthest_frame)
        return fmt::format("{:g} can't number a frame; {:g} is the last", point[0], farthest_frame);
    if (before && point[0] <= (*before)[0])
        return fmt::format("the frames of 'curve' must rise, but {:g} follows {:g}", point[0],
                           (*before)[0]);
    return std::nullopt;
}

/// Whether a word begins as a number does.
bool numeric(std::string_view word) {
    return std::isdigit(static_cast<unsigned char>(word.front())) != 0 ||
           std::string_view("+-.").find(word.front()) != std::string_view::npos;
}

std::vector<std::vector<double>> read_pace_curve(const std::string& path) {
    constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;
    FileText file(InputFile(path, {.what = "a curve of frames", .most = most_bytes}));
    std::vector<std::vector<double>> out;
    bool first = true;
    for (auto words = file.next_cells(); !words.empty(); words = file.next_cells()) {
        const bool names = first && !std::ranges::any_of(words, numeric);
        first = false;
        if (names) continue;
        if (words.size() != 2)
            file.fault(
                fmt::format("a line needs two numbers, the frame and the frame of the "
                            "source, but this one has {} columns",
                            words.size()));
        std::vector<double> point{file.number(words[0]), file.number(words[1])};
        if (const auto fault = fault_of(point, out.empty() ? nullptr : &out.back()))
            file.fault(*fault);
        out.push_back(std::move(point));
    }
    if (out.empty())
        file.fault_in_all(
            "there are no points in it: a curve needs at least one line of two numbers, the frame "
            "and the frame of the source");
    return out;
}

}  // namespace

void check_pace(const PaceParams& params, NodeCheck& check) {
    const bool from_file = !params.curve_file.text().empty(),
               curved = from_file || !params.curve.empty();
    const int stated = int(params.speed.has_value()) + int(params.count.has_value()) +
                       int(!params.curve.empty()) + int(from_file);
    if (stated == 0)
        check.fault("type",
                    "needs a 'speed', a number of 'frames', or a 'curve' (or a 'curve_file')");
    if (stated > 1)
        check.fault("type",
                    "takes one of 'speed', 'frames', 'curve' and 'curve_file', not several");
    if (params.speed && *params.speed == 0)
        check.fault(
            "speed",
            "'speed' must not be 0; to hold a frame, state a curve such as [[1, 7], [24, 7]]");
    if (params.start && curved)
        check.fault("start", "a curve says itself which frame is the first; leave 'start' out");
    if (params.curve_file.per_frame())
        check.fault("curve_file",
                    "'curve_file' can't have a frame token: one file holds the whole curve");
    for (std::size_t n = 0; n < params.curve.size(); ++n)
        if (const auto fault = fault_of(params.curve[n], n == 0 ? nullptr : &params.curve[n - 1]))
            return check.fault("curve", *fault);
}

Pace pace_of(const PaceParams& params, const std::vector<int>& frames) {
    PaceRequest request = params;
    if (!params.curve_file.text().empty()) request.curve = read_pace_curve(params.curve_file.at(0));
    return {request, frames};
}

}  // namespace fluidcarve
