#include "carve/time/pace.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace fluidcarve {
namespace {

constexpr double rounding = 1e-6;  ///< frames; moments nearer to a frame than this are that frame

/// The smallest step between frames of a sequence.
int least_step(const std::vector<int>& frames) {
    std::int64_t out = std::numeric_limits<int>::max();
    for (std::size_t n = 1; n < frames.size(); ++n)
        out = std::min(out, std::int64_t{frames[n]} - frames[n - 1]);
    return frames.size() > 1 ? static_cast<int>(out) : 1;
}

}  // namespace

Pace::Pace(const PaceRequest& request, std::vector<int> source) : source_(std::move(source)) {
    const double low = source_.front(), high = source_.back();
    int first = request.start.value_or(source_.front()), step = least_step(source_);
    double last = first;
    if (request.speed) {
        if (high > low) last = first + (high - low) / std::abs(*request.speed);
        points_ = *request.speed > 0 ? std::vector<Point>{{double(first), low}, {last, high}}
                                     : std::vector<Point>{{double(first), high}, {last, low}};
    } else if (request.count) {
        last = first + static_cast<double>(step) * (*request.count - 1);
        points_ = {{double(first), low}, {last, high}};
    } else {
        if (request.curve.empty()) throw Failure("no speed, number of frames or curve is stated");
        for (const auto& point : request.curve) {
            if (point.size() != 2)
                throw Failure("a point of 'curve' is [frame, frame of the source]");
            points_.push_back({point[0], point[1]});
        }
        for (const auto& [at, shows] : points_)
            if (shows < low || shows > high)
                throw Failure(
                    fmt::format("the curve leads to frame {:g} of the source, which has the frames "
                                "{:g} to {:g}",
                                shows, low, high));
        const double from = std::ceil(points_.front().at - rounding);
        if (std::abs(from) > std::numeric_limits<int>::max())
            throw Failure(fmt::format("the curve's frame {:g} is no frame number", from));
        first = static_cast<int>(from);
        last = points_.back().at;
        step = 1;
    }
    frames_ =
        even_frames(first, step, std::max(std::floor((last - first) / step + rounding) + 1, 1.0));
}

Moment Pace::moment(int frame) const {
    // The part of the pace that holds the frame, or else the nearest.
    auto end = std::ranges::find_if(points_, [&](const Point& point) { return point.at > frame; });
    if (end == points_.end()) --end;
    if (end == points_.begin() && points_.size() > 1) ++end;
    const auto& b = *end;
    const auto& a = end == points_.begin() ? b : *(end - 1);
    Moment out;
    if (b.at > a.at) out.rate = (b.shows - a.shows) / (b.at - a.at);
    const double shows = std::clamp(a.shows + out.rate * (frame - a.at), double(source_.front()),
                                    double(source_.back()));
    const auto after = std::ranges::upper_bound(source_, shows + rounding, std::less<>());
    out.place = static_cast<std::size_t>(after - source_.begin()) - 1;
    if (out.place + 1 == source_.size()) return out;
    const double from = source_[out.place],
                 share = (shows - from) / (source_[out.place + 1] - from);
    out.share = share < rounding ? 0 : share;
    return out;
}

}  // namespace fluidcarve
