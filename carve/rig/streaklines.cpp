#include "carve/rig/streaklines.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

using Line = std::vector<Vec3d>;

constexpr double most_points = 1e6;  // of a line

void join(Line& line, const Vec3d& point, double apart) {
    if (line.empty() || (point - line.back()).length() >= apart) line.push_back(point);
}

/// The streakline of a frame, extended along the path that the oldest set takes in later frames.
Line continued(const std::vector<Streakline>& streaklines, std::size_t t, double apart) {
    Line out;
    for (const auto& point : streaklines[t].points) join(out, point, apart);
    for (auto later = t + 1; later < streaklines.size() && !streaklines[later].points.empty() &&
                             streaklines[later].oldest == streaklines[t].oldest;
         ++later)
        join(out, streaklines[later].points.back(), apart);
    return out;
}

double length_of(const Line& line) {
    double out = 0;
    for (std::size_t n = 1; n < line.size(); ++n) out += (line[n] - line[n - 1]).length();
    return out;
}

/// Resamples a line in equal steps to a stated length. Beyond its end the line continues straight,
/// in the direction from its start to its end: a line's last few points sway more than the whole
/// line.
Line drawn(const Line& line, double length, std::size_t steps) {
    const auto chord = line.back() - line.front(), last = line.back() - line[line.size() - 2];
    const auto onwards = (chord.length() > last.length() ? chord : last).unit();
    Line out{line.front()};
    std::size_t piece = 1;
    double start = 0, size = (line[1] - line[0]).length();  // of the piece that ends at `piece`
    for (std::size_t n = 1; n <= steps; ++n) {
        const double along = length * static_cast<double>(n) / static_cast<double>(steps);
        while (along > start + size && piece + 1 < line.size()) {
            start += size;
            ++piece;
            size = (line[piece] - line[piece - 1]).length();
        }
        out.push_back(along > start + size ? line.back() + (along - start - size) * onwards
                                           : line[piece - 1] + (along - start) / size *
                                                                   (line[piece] - line[piece - 1]));
    }
    return out;
}

/// Gives each frame without a line the line of the nearest frame with one.
void fill(std::vector<Line>& lines) {
    const auto known = lines;
    for (std::size_t t = 0; t < lines.size(); ++t)
        for (std::size_t by = 1; lines[t].empty() && by < lines.size(); ++by) {
            if (by <= t) lines[t] = known[t - by];
            if (lines[t].empty() && t + by < lines.size()) lines[t] = known[t + by];
        }
}

/// Weighted means over the frames around each, with a tent's weights. Beyond the first and the last
/// frame nothing moves.
std::vector<Line> steadied(const std::vector<Line>& lines, int reach) {
    std::vector<Line> out(lines.size(), Line(lines.front().size(), Vec3d(0)));
    const auto last = static_cast<int>(lines.size()) - 1;
    for (int t = 0; t <= last; ++t)
        for (int by = -reach; by <= reach; ++by) {
            const auto& line = lines[static_cast<std::size_t>(std::clamp(t + by, 0, last))];
            const double share = (reach + 1.0 - std::abs(by)) / ((reach + 1.0) * (reach + 1.0));
            for (std::size_t n = 0; n < line.size(); ++n)
                out[static_cast<std::size_t>(t)][n] += share * line[n];
        }
    return out;
}

}  // namespace

std::vector<Line> moving_lines(const std::vector<Streakline>& streaklines, const LineShape& shape) {
    std::vector<Line> lines;
    double longest = 0;
    for (std::size_t t = 0; t + 1 < streaklines.size(); ++t) {
        lines.push_back(continued(streaklines, t, shape.apart));
        if (lines.back().size() < 2) lines.back().clear();
        longest = std::max(longest, length_of(lines.back()));
    }
    if (longest == 0) return {};
    const double length = shape.length.value_or(longest),
                 steps = std::max(1.0, std::round(length / shape.apart));
    if (steps >= most_points)
        throw Failure(
            fmt::format("a rig of the length {:g} has {:.0f} points that are {:g} apart: state a "
                        "larger 'apart' or a smaller 'length'",
                        length, steps + 1, shape.apart));
    for (auto& line : lines)
        if (!line.empty()) line = drawn(line, length, static_cast<std::size_t>(steps));
    fill(lines);
    return steadied(lines, shape.steady);
}

double largest_distance(const Line& a, const Line& b) {
    double out = 0;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n)
        out = std::max(out, (a[n] - b[n]).length());
    return out;
}

}  // namespace fluidcarve
