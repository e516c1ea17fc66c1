#include "carve/time/time_map.h"

#include "carve/base/failure.h"
#include "carve/time/between.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <utility>

namespace fluidcarve {

std::vector<int> FramesCarved::left(const Auto<Count>& used, const std::vector<int>& frames) const {
    const int size = static_cast<int>(frames.size()), all = count.of(size),
              most = used ? std::abs(used->of(size)) : std::abs(all),
              by = paired ? 0 : std::clamp(all, -most, most);
    if (size + by < 1)
        throw Failure(fmt::format("count {} takes all of {} frames; at most {} can go",
                                  text_of(count), size, size - 1));
    const int step = step_of(frames);
    std::vector<int> out;
    for (int n = 0; n < size + by; ++n) out.push_back(frames.front() + step * n);
    return out;
}

namespace {

/// Seams of frames as seams along u: time takes the place of u, and each vertex along u that of a
/// frame.
Seams along_u(const Seams& seams) {
    auto out = seams;
    out.axis = Axis::u;
    out.around = false;
    out.shape = {seams.carved(), seams.lateral(), seams.slices()};
    out.frames.assign(seams.layers(), 0);
    return out;
}

const Lattice& required(const Seams& seams, const Lattice& lattice) {
    if (!seams.in_time())
        throw Failure("the seams are not seams of frames: they were found along " +
                      to_text(seams.axis));
    for (std::size_t t = 0; t < seams.frames.size(); ++t)
        if (seams.lattice_hash_at(t) != lattice.hash)
            throw Failure(fmt::format(
                "the seams were found in another lattice: theirs is a {}, this one a {}",
                seams.lattice, lattice.description));
    return lattice;
}

}  // namespace

TimeMap::TimeMap(const Seams& seams, const Lattice& lattice, std::size_t count, int fade)
    : shape_(seams.shape),
      mapping_(required(seams, lattice)),
      frames_(seams.carved() + (seams.paired() ? 0 : growth(seams.kind, static_cast<int>(count)))),
      source_frames_(seams.carved()),
      fade_(fade),
      closed_(seams.closed),
      around_(seams.around) {
    if (count > seams.size())
        throw Failure(
            fmt::format("count asks for {} seams, but the seam set holds {}", count, seams.size()));
    const auto turned = along_u(seams);
    for (std::size_t i = 0; i < seams.layers(); ++i) steps_.emplace_back(turned, i, count);
}

int TimeMap::source_of(std::size_t i, int j, int k, int n) const {
    n = std::clamp(n, 0, frames_ - 1);
    // A frame that is shown again stands between two; it is the one before.
    const int halves = steps_[i].displacement(n, j, k);
    return std::clamp(n + static_cast<int>(std::floor(0.5 * halves)), 0, source_frames_ - 1);
}

std::vector<TimeMap::Seen> TimeMap::seen(int n) const {
    // Raised cosine: the shares of neighbouring moments add up to 1.
    std::vector<float> weights;
    for (int m = 1 - fade_; m < fade_; ++m)
        weights.push_back(
            static_cast<float>((1 + std::cos(std::numbers::pi * m / fade_)) / (2 * fade_)));
    const auto [width, laterals, slices] = shape_;
    const auto layer = static_cast<std::size_t>(laterals) * static_cast<std::size_t>(slices),
               columns = static_cast<std::size_t>(width) * layer;
    std::map<int, std::size_t> whole;  // how many vertices show an offset
    const auto offset_of = [&](std::size_t column, int m) {
        const auto i = column / layer;
        const int j = static_cast<int>(column % layer) % laterals,
                  k = static_cast<int>(column % layer) / laterals,
                  at = std::clamp(n + m, 0, frames_ - 1);
        return source_of(i, j, k, at) - at;
    };
    std::map<int, Seen> out;
    for (std::size_t c = 0; c < columns; ++c) {
        ++whole[offset_of(c, 0)];
        for (int m = 1 - fade_; m < fade_; ++m) {
            const int place = std::clamp(n + offset_of(c, m), 0, source_frames_ - 1);
            auto& seen = out[place];
            if (seen.share.empty()) seen = {place, std::vector<float>(columns)};
            seen.share[c] += weights[static_cast<std::size_t>(m + fade_ - 1)];
        }
    }
    const int most =
        std::ranges::max_element(whole, {}, &std::pair<const int, std::size_t>::second)->first;
    out.at(std::clamp(n + most, 0, source_frames_ - 1)).outside = 1;
    std::vector<Seen> all;
    for (auto& [place, seen] : out) all.push_back(std::move(seen));
    return all;
}

float TimeMap::share_at(const Seen& seen, const openvdb::Vec3d& world) const {
    const auto located =
        mapping_.slabs() ? mapping_.locate(world) : std::optional(mapping_.coordinates(world));
    if (!located) return seen.outside;
    const std::array closes{false, around_, closed_};
    std::array<std::size_t, 3> low{}, high{};
    std::array<float, 3> part{};
    for (int d = 0; d < 3; ++d) {
        const auto n = static_cast<std::size_t>(d);
        const int last = shape_[n] - 1;
        const double at = closes[n] ? (*located)[d] : std::clamp((*located)[d], 0.0, double(last));
        const int below = static_cast<int>(fade_ > 1 ? std::floor(at) : std::floor(at + 0.5));
        const auto vertex = [&](int of) {
            return static_cast<std::size_t>(of > last ? closes[n] ? of - last - 1 : last : of);
        };
        low[n] = vertex(below);
        high[n] = vertex(below + 1);
        part[n] = fade_ > 1 ? static_cast<float>(at - below) : 0;
    }
    const auto laterals = static_cast<std::size_t>(shape_[1]),
               slices = static_cast<std::size_t>(shape_[2]);
    float out = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        float weight = 1;
        std::array<std::size_t, 3> at{};
        for (std::size_t n = 0; n < 3; ++n) {
            const bool above = (corner >> n & 1) != 0;
            at[n] = above ? high[n] : low[n];
            weight *= above ? part[n] : 1 - part[n];
        }
        if (weight > 0) out += weight * seen.share[(at[0] * slices + at[2]) * laterals + at[1]];
    }
    return out;
}

Volume TimeMap::frame(const Sequence& source, int n) const {
    const auto all = seen(n);
    auto out = source.at(static_cast<std::size_t>(all.front().place)).volume;
    for (std::size_t last = 1; last < all.size(); ++last) {
        const auto next = source.at(static_cast<std::size_t>(all[last].place)).volume;
        out = volume_mixed(
            out, next,
            [&](const openvdb::Vec3d& world) {
                // Of those so far and this one.
                float before = 0;
                for (std::size_t m = 0; m < last; ++m) before += share_at(all[m], world);
                const float share = share_at(all[last], world);
                return share > 0 ? share / (before + share) : 0.0;
            },
            all[last].outside > 0 ? next : out);
    }
    return out;
}

}  // namespace fluidcarve
