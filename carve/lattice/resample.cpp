#include "carve/lattice/resample.h"

#include "carve/base/failure.h"
#include "carve/lattice/lattice.h"
#include "carve/rig/path.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

/// Walks along a rig in equal steps from its start.
class Walk {
public:
    explicit Walk(const Rig& rig) : path_(rig), closed_(rig.closed) {}

    const Path& path() const { return path_; }

    /// All places up to the end of the path, or within one round of a closed rig.
    std::vector<Path::Place> places(double step) const {
        // Tolerance: a spacing typed with few digits must not cost an open rig its last plane.
        const double end = path_.end() + (closed_ ? 0 : 1e-3 * step);
        std::vector<Path::Place> out{Path::Place{}};
        while (out.size() <= static_cast<std::size_t>(most_vertices)) {
            const auto next = path_.step(out.back(), step);
            if (!next || path_.travelled(*next) > end) break;
            out.push_back(*next);
        }
        return out;
    }

    /// By how much `steps` steps pass the end of the path, measured as Path::travelled.
    double excess(double step, int steps) const {
        Path::Place place;
        for (int n = 0; n < steps; ++n) {
            const auto next = path_.step(place, step);
            if (!next) return (steps - n) * path_.end();
            place = *next;
        }
        return path_.travelled(place) - path_.end();
    }

    /// The step length with which `steps` steps end exactly at the end of the path. Found by
    /// bisection, accelerated by secants.
    /// @param guess  a first estimate, world units
    /// @return nothing if there is no such length
    std::optional<double> fitting(int steps, double guess) const {
        double low = guess, high = guess;
        while (excess(low, steps) > 0 && low > 1e-6 * guess) low /= 1.25;
        while (excess(high, steps) <= 0 && high < 1e6 * guess) high *= 1.25;
        double at_low = excess(low, steps), at_high = excess(high, steps);
        const double enough = 4e-16 * path_.end();
        for (int tries = 0; tries < 300 && high - low > 2e-16 * high && -at_low > enough; ++tries) {
            const double secant = low - at_low * (high - low) / (at_high - at_low);
            const double middle =
                tries % 3 == 2 || !(secant > low && secant < high) ? (low + high) / 2 : secant;
            const double value = excess(middle, steps);
            (value > 0 ? high : low) = middle;
            (value > 0 ? at_high : at_low) = value;
        }
        return -at_low <= 1e-9 * path_.end() / steps ? std::optional(low) : std::nullopt;
    }

private:
    Path path_;
    bool closed_;
};

/// A rig, moved by `-place`: near the origin, numbers are finer.
Rig moved_back(Rig rig, const Vec3d& place) {
    for (auto& point : rig.points) point -= place;
    if (rig.oval) rig.oval->center -= place;
    return rig;
}

/// How many planes a closed rig has.
/// @param places  of the planes that stand at the spacing
template <class Places>
int planes_around(const Path& path, const Places& places, double spacing) {
    const double rest = (path.at(places.back()) - path.at({})).length() / spacing;
    const auto out =
        static_cast<int>(places.size() - 1 + static_cast<std::size_t>(std::lround(rest)));
    if (out < 3)
        throw Failure(
            fmt::format("the closed rig is {:g} around; at a spacing of {:g} that makes "
                        "fewer than three planes",
                        path.length(), spacing));
    return out;
}

}  // namespace

Resampled resampled(const Rig& rig, double spacing, std::optional<int> planes) {
    const auto place = rig.oval ? rig.oval->center : rig.points.front();
    const Walk walk(moved_back(rig, place));
    const auto& path = walk.path();
    auto places = walk.places(spacing);
    if (places.size() > static_cast<std::size_t>(most_vertices))
        throw Failure(
            fmt::format("the rig, {0:g} long, needs more than {1} planes at a spacing of {2:g}; "
                        "{1} is the most",
                        path.length(), most_vertices, spacing));
    Resampled out;
    out.step = spacing;
    if (rig.closed || (planes && places.size() != static_cast<std::size_t>(*planes))) {
        if (!planes) planes = planes_around(path, places, spacing);
        const auto step = walk.fitting(rig.closed ? *planes : *planes - 1, path.length() / *planes);
        if (!step)
            throw Failure(
                fmt::format("no step divides the rig, {}, evenly into {} planes: it turns back "
                            "within less than the spacing of {:g}; smooth it, or take "
                            "another spacing",
                            to_text(rig), *planes, spacing));
        out.step = *step;
        places.resize(1);
        while (places.size() < static_cast<std::size_t>(*planes))
            places.push_back(*path.step(places.back(), out.step));
    }
    if (places.size() < 2)
        throw Failure(
            fmt::format("the rig, {:g} long, stays within one spacing, {:g}, of its start; take a "
                        "smaller spacing",
                        path.length(), spacing));
    for (std::size_t n = 0; n < places.size(); ++n) {
        out.points.push_back(path.at(places[n]));
        if (n > 0) out.chords.push_back(path.direction(places[n - 1], places[n]));
    }
    if (rig.closed) out.chords.push_back((out.points.front() - out.points.back()).unit());
    for (auto& point : out.points) point += place;
    return out;
}

}  // namespace fluidcarve
