#include "tests/bench/similarity.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace {

struct Patch {
    int size;        ///< vertices, along each dimension that has more than one
    int frames = 1;  ///< how many it lasts
};

constexpr std::array in_space{Patch{5}, Patch{9}, Patch{15}};
constexpr Patch in_time{7, 5};

/// Patches less full than this are left out.
constexpr float least_lit = 0.3f;

/// Running means of `size` values along a dimension. Rims go on as they end.
/// @param in      `[outer][length][stride]`
/// @param closed  the dimension is a ring
void mean_along(std::span<const float> in, std::span<float> out, std::size_t length, std::size_t stride, int size, bool closed) {
    const int end = static_cast<int>(length), radius = size / 2;
    const auto place = [&](int n) { return stride * static_cast<std::size_t>(closed ? (n % end + end) % end : std::clamp(n, 0, end - 1)); };
    std::vector<double> sum(stride);
    for (std::size_t base = 0; base < in.size(); base += length * stride) {
        std::fill(sum.begin(), sum.end(), 0.0);
        for (int n = -radius; n <= radius; ++n)
            for (std::size_t s = 0; s < stride; ++s) sum[s] += in[base + place(n) + s];
        for (int n = 0; n < end; ++n) {
            const auto *const enters = &in[base + place(n + radius + 1)], *const leaves = &in[base + place(n - radius)];
            auto* const mean = &out[base + place(n)];
            for (std::size_t s = 0; s < stride; ++s) {
                mean[s] = static_cast<float>(sum[s] / size);
                sum[s] += static_cast<double>(enters[s]) - leaves[s];
            }
        }
    }
}

/// Means over the patch around each sample. @param spare  of the same size; its content is lost
void mean_over(const Samples& like, Patch patch, std::vector<float>& values, std::vector<float>& spare) {
    const std::array lengths{like.shape[0], like.shape[1], like.shape[2], like.frames};
    std::size_t stride = 1;
    for (std::size_t d = 0; d < lengths.size(); ++d) {
        if (const int size = d < 3 ? patch.size : patch.frames; lengths[d] > 1 && size > 1) {
            mean_along(values, spare, lengths[d], stride, size, (d == 1 && like.around) || (d == 2 && like.closed));
            values.swap(spare);
        }
        stride *= lengths[d];
    }
}

/// Squared differences to what is `shift` further along u; beyond its ends there is nothing.
void squared_differences(const Samples& of, const Samples& among, int shift, std::vector<float>& out) {
    const int width = static_cast<int>(of.shape[0]), end = static_cast<int>(among.shape[0]);
    const int first = std::clamp(-shift, 0, width), last = std::clamp(end - shift, first, width);
    for (std::size_t r = 0; r < of.rows(); ++r) {
        const auto *const mine = of.row(r), *const theirs = among.row(r);
        auto* const square = out.data() + r * of.shape[0];
        for (int i = 0; i < first; ++i) square[i] = mine[i] * mine[i];
        for (int i = first; i < last; ++i) square[i] = (mine[i] - theirs[i + shift]) * (mine[i] - theirs[i + shift]);
        for (int i = last; i < width; ++i) square[i] = mine[i] * mine[i];
    }
}

/// Root mean square distances of the patches of `of` to the nearest patch of `among` at the same v, w and time, by kind of patch.
std::vector<double> nearest(const Samples& of, const Samples& among, float visible, const std::vector<Patch>& patches, int reach) {
    struct Work {
        std::vector<float> squares, means, spare;
        std::vector<std::vector<float>> best;
    };
    const auto size = of.values.size();
    // The least of all shifts is the same in whatever order they come.
    tbb::enumerable_thread_specific<Work> works([&] {
        const std::vector<float> none(size);
        return Work{none, none, none, {patches.size(), std::vector<float>(size, std::numeric_limits<float>::infinity())}};
    });
    tbb::parallel_for(-reach, reach + 1, [&](int shift) {
        auto& work = works.local();
        squared_differences(of, among, shift, work.squares);
        for (std::size_t p = 0; p < patches.size(); ++p) {
            work.means = work.squares;
            mean_over(of, patches[p], work.means, work.spare);
            std::ranges::transform(work.best[p], work.means, work.best[p].begin(), [](float a, float b) { return std::min(a, b); });
        }
    });

    std::vector<double> out;
    std::vector<float> lit(size), spare(size);
    for (std::size_t p = 0; p < patches.size(); ++p) {
        std::ranges::transform(of.values, lit.begin(), [&](float value) { return value > visible ? 1.0f : 0.0f; });
        mean_over(of, patches[p], lit, spare);
        double sum = 0, count = 0;
        for (std::size_t n = 0; n < size; ++n) {
            if (lit[n] <= least_lit) continue;
            auto least = std::numeric_limits<float>::infinity();
            for (const auto& work : works) least = std::min(least, work.best[p][n]);
            sum += least;
            ++count;
        }
        out.push_back(std::sqrt(sum / count));
    }
    return out;
}

struct Similarity {
    std::vector<double> coherence, completeness;
};

Similarity similarity(const Samples& result, const Samples& source, float visible, int moved) {
    const int wider = static_cast<int>(result.shape[0]) - static_cast<int>(source.shape[0]);
    const int reach = std::max(std::abs(wider), moved) + 4;
    std::vector<Patch> patches(in_space.begin(), in_space.end());
    Similarity out;
    out.completeness = nearest(source, result, visible, patches, reach);
    if (source.frames >= static_cast<std::size_t>(in_time.frames)) patches.push_back(in_time);
    out.coherence = nearest(result, source, visible, patches, reach);
    return out;
}

double mass_of(const Samples& samples) { return std::accumulate(samples.values.begin(), samples.values.end(), 0.0); }

/// The sum of the absolute second differences between samples that stand `stride` apart, per mass.
/// @param length  of the dimension that has this stride
double roughness(const Samples& samples, std::size_t length, std::size_t stride) {
    double sum = 0;
    const auto& values = samples.values;
    for (std::size_t base = 0; base < values.size(); base += length * stride)
        for (std::size_t n = base + stride; n + stride < base + length * stride; ++n) sum += std::abs(values[n + stride] - 2 * values[n] + values[n - stride]);
    return sum / mass_of(samples);
}

double jagged(const Samples& samples) { return roughness(samples, samples.shape[0], 1); }
double flicker(const Samples& samples) { return roughness(samples, samples.frames, samples.values.size() / samples.frames); }

std::vector<double> shares(const std::vector<double>& of, const std::vector<double>& whole) {
    std::vector<double> out(of.size());
    std::ranges::transform(of, whole, out.begin(), std::divides());
    return out;
}

}  // namespace

double Looks::mean() const {
    return std::accumulate(completeness.begin(), completeness.end(), std::accumulate(coherence.begin(), coherence.end(), 0.0)) /
           static_cast<double>(coherence.size() + completeness.size());
}

double Looks::worst() const { return std::max(std::ranges::max(coherence), std::ranges::max(completeness)); }

float visible_from(const Samples& source) {
    auto values = source.values;
    const auto rare = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 1000);
    std::nth_element(values.begin(), rare, values.end());
    return 0.02f * *rare;
}

double visible_width(const Samples& samples, float visible) {
    double sum = 0, lines = 0;
    const auto [width, laterals, slices] = samples.shape;
    std::vector<bool> lit(width);
    for (std::size_t plane = 0; plane < samples.frames * slices; ++plane) {
        std::fill(lit.begin(), lit.end(), false);
        for (std::size_t j = 0; j < laterals; ++j)
            for (std::size_t i = 0; i < width; ++i) lit[i] = lit[i] || samples.row(plane * laterals + j)[i] > visible;
        const auto count = std::count(lit.begin(), lit.end(), true);
        sum += static_cast<double>(count);
        lines += count > 0 ? 1 : 0;
    }
    return sum / lines;
}

Samples stretched(const Samples& source, std::size_t width, const std::function<double(double)>& from) {
    Samples out(source.frames, {width, source.shape[1], source.shape[2]}, source.closed, source.around);
    const double last = static_cast<double>(source.shape[0]) - 1;
    for (std::size_t i = 0; i < width; ++i) {
        const double at = std::clamp(from(static_cast<double>(i)), 0.0, last);
        const auto low = static_cast<std::size_t>(at), high = std::min(low + 1, source.shape[0] - 1);
        const auto part = static_cast<float>(at - static_cast<double>(low));
        for (std::size_t r = 0; r < source.rows(); ++r) out.row(r)[i] = (1 - part) * source.row(r)[low] + part * source.row(r)[high];
    }
    return out;
}

Looks looks_of(const Samples& result, const Samples& source, const Samples& even, int moved) {
    const float visible = visible_from(source);
    const auto ours = similarity(result, source, visible, moved), theirs = similarity(even, source, visible, moved);
    Looks out;
    out.coherence = shares(ours.coherence, theirs.coherence);
    out.completeness = shares(ours.completeness, theirs.completeness);
    if (source.frames > 2) out.flicker = flicker(result) / flicker(source);
    out.jagged = jagged(result) / jagged(source);
    out.mass = mass_of(result) / mass_of(even);
    if (result.shape[0] != source.shape[0]) {
        const double narrower = 1 - visible_width(result, visible) / visible_width(source, visible);
        out.resized = narrower / (1 - static_cast<double>(result.shape[0]) / static_cast<double>(source.shape[0]));
    }
    return out;
}
