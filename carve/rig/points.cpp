#include "carve/rig/points.h"

#include "carve/base/failure.h"
#include "carve/base/values.h"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <vector>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

using Points = std::vector<Vec3>;

}  // namespace

std::vector<Vec3d> points_at(const std::map<int, std::vector<Vec3d>>& keys, int frame) {
    const auto after = keys.lower_bound(frame);
    if (after == keys.begin() || (after != keys.end() && after->first == frame))
        return after->second;
    const auto before = std::prev(after);
    if (after == keys.end()) return before->second;
    if (before->second.size() != after->second.size())
        throw Failure(
            fmt::format("the rig has {} points in frame {}, but {} in frame {}: between two frames "
                        "of different numbers it is not known",
                        before->second.size(), before->first, after->second.size(), after->first));
    const double part = (static_cast<double>(frame) - before->first) /
                        (static_cast<double>(after->first) - before->first);
    auto out = before->second;
    for (std::size_t n = 0; n < out.size(); ++n) out[n] += part * (after->second[n] - out[n]);
    return out;
}

}  // namespace fluidcarve
