#include "carve/time/time_map.h"

#include "carve/base/each_in_parallel.h"
#include "carve/base/failure.h"
#include "carve/points/point_vectors.h"
#include "carve/time/between.h"
#include "carve/time/mesh_between.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace fluidcarve {

namespace {

/// Vertices that one thread takes.
constexpr std::size_t vertices_at_once = 4096;

/// Converts seams of frames to seams along u: time takes the place of u, and each vertex along u
/// the place of a frame.
Seams along_u(const Seams& seams) {
    auto out = seams;
    out.axis = Axis::u;
    out.around = false;
    out.shape = {seams.before(), seams.laterals(), seams.slices()};
    out.frames.assign(seams.layers(), 0);
    return out;
}

const Lattice& required(const Seams& seams, const Lattice& lattice) {
    if (!seams.in_time())
        throw Failure("the seams are not seams of frames: they were found along " +
                      to_text(seams.axis));
    bool same = seams.shape == lattice.shape && seams.closed == lattice.closed &&
                seams.around == lattice.around;
    for (std::size_t t = 0; t < seams.frames.size() && same; ++t)
        same = seams.lattice_hash_at(t) == lattice.hash;
    if (!same)
        throw Failure(
            fmt::format("the seams were found in another lattice: theirs is a {}, this one a {}",
                        seams.lattice, lattice.description));
    return lattice;
}

/// Weights of the moments around one: a raised cosine, so that overlapping windows add up to 1.
/// @return `2 fade - 1` weights, the middle one for the moment itself
std::vector<float> weights_of(int fade) {
    std::vector<float> out;
    for (int m = 1 - fade; m < fade; ++m)
        out.push_back(static_cast<float>((1 + std::cos(std::numbers::pi * m / fade)) / (2 * fade)));
    return out;
}

/// Of each place in the source, how many vertices show it now, and whether any does soon.
struct ShownPlaces {
    std::vector<std::size_t> now;
    std::vector<char> soon;
};

/// @param place_at  what a vertex shows in so many frames
template <class PlaceAt>
ShownPlaces shown_places(std::size_t vertices, std::size_t places, int fade,
                         const PlaceAt& place_at) {
    ShownPlaces out{std::vector<std::size_t>(places), std::vector<char>(places)};
    tbb::enumerable_thread_specific<ShownPlaces> counts(out);
    each_in_parallel(vertices, vertices_at_once, [&](std::size_t c) {
        auto& count = counts.local();
        ++count.now[place_at(c, 0)];
        for (int m = 1 - fade; m < fade; ++m) count.soon[place_at(c, m)] = 1;
    });
    for (const auto& count : counts)
        for (std::size_t place = 0; place < places; ++place) {
            out.now[place] += count.now[place];
            out.soon[place] |= count.soon[place];
        }
    return out;
}

}  // namespace

TimeMap::TimeMap(const Seams& seams, const Lattice& lattice, std::size_t count,
                 const TimeJoin& join)
    : shape_(seams.shape),
      mapping_(required(seams, lattice)),
      frames_(seams.before() + (seams.paired() ? 0 : growth(seams.kind, static_cast<int>(count)))),
      source_frames_(seams.before()),
      join_(join),
      closed_(seams.closed),
      around_(seams.around) {
    if (count > seams.size())
        throw Failure(
            fmt::format("count asks for {} seams, but the seam set holds {}", count, seams.size()));
    const auto turned = along_u(seams);
    for (std::size_t i = 0; i < seams.layers(); ++i) steps_.emplace_back(turned, i, count);
}

int TimeMap::source_of(std::size_t vertex, int n) const {
    const auto laterals = static_cast<std::size_t>(shape_[1]),
               layer = laterals * static_cast<std::size_t>(shape_[2]), column = vertex % layer;
    // A repeated frame stands between two source frames; it shows the one before.
    const int halves = steps_[vertex / layer].displacement(n, static_cast<int>(column % laterals),
                                                           static_cast<int>(column / laterals));
    return std::clamp(n + static_cast<int>(std::floor(0.5 * halves)), 0, source_frames_ - 1);
}

int TimeMap::source_of(std::size_t vertex, int n, int behind) const {
    return std::clamp(source_of(vertex, n + behind) - behind, 0, source_frames_ - 1);
}

std::size_t TimeMap::vertices() const {
    return static_cast<std::size_t>(shape_[0]) * static_cast<std::size_t>(shape_[1]) *
           static_cast<std::size_t>(shape_[2]);
}

TimeMap::Moments TimeMap::moments(int n) const {
    const int fade = fade_at(n);
    const auto weights = weights_of(fade);
    Moments out;
    out.at.resize(vertices());
    each_in_parallel(out.at.size(), vertices_at_once, [&](std::size_t c) {
        // Sums differences from the present frame, so that whole moments stay whole.
        const int now = source_of(c, n);
        float sum = 0;
        for (int m = 1 - fade; m < fade; ++m)
            sum += weights[static_cast<std::size_t>(m + fade - 1)] *
                   static_cast<float>(source_of(c, n, m) - now);
        out.at[c] = static_cast<float>(now) + sum;
    });
    auto sorted = out.at;
    const auto middle = sorted.begin() + std::ssize(sorted) / 2;
    std::ranges::nth_element(sorted, middle);
    out.outside = std::round(*middle);
    return out;
}

std::vector<TimeMap::Seen> TimeMap::seen(int n) const {
    const int fade = fade_at(n);
    const auto weights = weights_of(fade);
    const auto places = static_cast<std::size_t>(source_frames_);
    const auto place_at = [&](std::size_t vertex, int m) {
        return static_cast<std::size_t>(source_of(vertex, n, m));
    };
    const auto shown = shown_places(vertices(), places, fade, place_at);
    std::vector<Seen> out;
    std::vector<std::size_t> index(places);
    std::size_t before = 0;
    for (std::size_t place = 0; place < places; ++place) {
        const auto now = shown.now[place];
        if (!shown.soon[place]) continue;
        index[place] = out.size();
        out.push_back({static_cast<int>(place), std::vector<float>(vertices()), 0});
        // The median of the source frames that the vertices show.
        if (before <= vertices() / 2 && before + now > vertices() / 2) out.back().outside = 1;
        before += now;
    }
    each_in_parallel(vertices(), vertices_at_once, [&](std::size_t c) {
        for (int m = 1 - fade; m < fade; ++m)
            out[index[place_at(c, m)]].share[c] += weights[static_cast<std::size_t>(m + fade - 1)];
    });
    return out;
}

std::optional<TimeMap::Corners> TimeMap::corners_at(const openvdb::Vec3d& world,
                                                    bool nearest) const {
    const auto located =
        mapping_.slabs() ? mapping_.locate(world) : std::optional(mapping_.coordinates(world));
    if (!located) return std::nullopt;
    const std::array closes{false, around_, closed_};
    std::array<std::size_t, 3> low{}, high{};
    std::array<float, 3> part{};
    for (int d = 0; d < 3; ++d) {
        const auto n = static_cast<std::size_t>(d);
        const int last = shape_[n] - 1;
        const double at = std::clamp((*located)[d], 0.0, closes[n] ? last + 1.0 : last);
        const int below = static_cast<int>(std::floor(nearest ? at + 0.5 : at));
        const auto vertex = [&](int of) {
            return static_cast<std::size_t>(of <= last ? of : closes[n] ? of - last - 1 : last);
        };
        low[n] = vertex(below);
        high[n] = vertex(below + 1);
        part[n] = nearest ? 0 : static_cast<float>(at - below);
    }
    const auto laterals = static_cast<std::size_t>(shape_[1]),
               slices = static_cast<std::size_t>(shape_[2]);
    Corners out{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        float weight = 1;
        std::array<std::size_t, 3> at{};
        for (std::size_t n = 0; n < 3; ++n) {
            const bool above = (corner >> n & 1) != 0;
            at[n] = above ? high[n] : low[n];
            weight *= above ? part[n] : 1 - part[n];
        }
        out.vertex[corner] = (at[0] * slices + at[2]) * laterals + at[1];
        out.weight[corner] = weight;
    }
    return out;
}

double TimeMap::at(const Moments& moments, const openvdb::Vec3d& world) const {
    const auto corners = corners_at(world, false);
    if (!corners) return double(moments.outside);
    // Sums differences from the first corner, so that whole moments stay whole.
    const double first = moments.at[corners->vertex[0]];
    double out = first;
    for (std::size_t c = 1; c < 8; ++c)
        out += double(corners->weight[c]) * (moments.at[corners->vertex[c]] - first);
    return out;
}

RateAt TimeMap::rate(int n) const {
    const int before = std::max(n - 1, 0), after = std::min(n + 1, frames_ - 1);
    if (before == after || !join_.moved || join_.fade == 1) return nullptr;
    return [this, from = moments(before), to = moments(after), frames = after - before](
               const openvdb::Vec3d& world) { return (at(to, world) - at(from, world)) / frames; };
}

template <class T>
T TimeMap::moved(const FrameSource<T>& source, int n) const {
    const auto moments = this->moments(n);
    const auto moment_at = [&](const openvdb::Vec3d& world) { return at(moments, world); };
    const auto [least, most] = std::ranges::minmax(moments.at);
    const auto first = static_cast<std::size_t>(std::floor(least)),
               last = static_cast<std::size_t>(std::ceil(most));
    auto before = source.at(first), out = before;
    for (auto place = first; place < last; ++place) {
        const auto next = source.at(place + 1);
        const auto from = static_cast<double>(place);
        const bool outside = double(moments.outside) > from;
        const auto between = source.between(
            before, next, place,
            [&](const openvdb::Vec3d& world) {
                return std::clamp(moment_at(world) - from, 0.0, 1.0);
            },
            outside);
        // Places that show an earlier moment are complete.
        const ShareAt later = [&](const openvdb::Vec3d& world) {
            return moment_at(world) > from ? 1.0 : 0.0;
        };
        out = place == first ? between : source.mixed(out, between, later, outside, nullptr);
        before = next;
    }
    return out;
}

template <class T>
T TimeMap::blended(const FrameSource<T>& source, int n) const {
    const auto all = seen(n);
    auto out = source.at(static_cast<std::size_t>(all.front().place));
    for (std::size_t last = 1; last < all.size(); ++last) {
        const auto next = source.at(static_cast<std::size_t>(all[last].place));
        // Total share of the source frames before this one, and the share of this one.
        const auto shares = [&](const openvdb::Vec3d& world) {
            const auto corners = corners_at(world, join_.fade == 1);
            std::array<float, 2> sums{};
            for (std::size_t m = 0; m <= last; ++m) {
                float share = corners ? 0 : all[m].outside;
                for (std::size_t c = 0; corners && c < 8; ++c)
                    if (corners->weight[c] > 0)
                        share += corners->weight[c] * all[m].share[corners->vertex[c]];
                sums[m == last ? 1 : 0] += share;
            }
            return sums;
        };
        out = source.mixed(
            out, next,
            [&](const openvdb::Vec3d& world) {
                const auto [before, now] = shares(world);
                return now > 0 ? now / (before + now) : 0.0;
            },
            all[last].outside > 0,
            // Each point has a number of its own, and changes over where the total share before is
            // below it.
            [&](const openvdb::Vec3d& world) { return 1.0 - shares(world)[0]; });
    }
    return out;
}

template <class T>
T TimeMap::frame(const FrameSource<T>& source, int n) const {
    return join_.moved ? moved(source, n) : blended(source, n);
}

template Volume TimeMap::frame(const FrameSource<Volume>&, int) const;
template Points TimeMap::frame(const FrameSource<Points>&, int) const;
template Mesh TimeMap::frame(const FrameSource<Mesh>&, int) const;

FrameSource<Volume> frame_source(const Sequence& sequence, const Motions& motions) {
    return {[&](std::size_t place) { return sequence.at(place).volume; },
            [&](const Volume& a, const Volume& b, std::size_t place, const ShareAt& share,
                bool second) {
                return volume_between(a, b, share, second ? b : a, motions.from(place).get(),
                                      Transport::semi_lagrangian);
            },
            [](const Volume& a, const Volume& b, const ShareAt& share, bool second,
               const ShareAt& of_points) {
                return volume_mixed(a, b, share, second ? b : a, of_points);
            }};
}

FrameSource<Points> frame_source(const NumberedFrames<Points>& list) {
    return {[&](std::size_t place) { return *list.at(place); },
            [](const Points& a, const Points& b, std::size_t, const ShareAt& share, bool second) {
                const auto name = velocity_name(a);
                return points_between(a, b, share, second ? b : a,
                                      {name, name.empty() ? 0 : point_scale(a, b, name)});
            },
            [](const Points& a, const Points& b, const ShareAt& share, bool second,
               const ShareAt& of_points) {
                return points_mixed(a, b, of_points ? of_points : share, second ? b : a);
            }};
}

FrameSource<Mesh> frame_source(const NumberedFrames<Mesh>& list) {
    return {[&](std::size_t place) { return *list.at(place); },
            [](const Mesh& a, const Mesh& b, std::size_t, const ShareAt& share, bool second) {
                return mesh_between(a, b, share, second ? b : a);
            },
            [](const Mesh& a, const Mesh& b, const ShareAt& share, bool second, const ShareAt&) {
                return mesh_between(a, b, share, second ? b : a);
            }};
}

}  // namespace fluidcarve
