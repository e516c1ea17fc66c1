#include "tests/bench/similarity.h"

#include "carve/base/words.h"

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
void mean_along(std::span<const float> in, std::span<float> out, std::size_t length,
                std::size_t stride, int size, bool closed) {
    const int end = static_cast<int>(length), radius = size / 2;
    const auto place = [&](int n) {
        return stride *
               static_cast<std::size_t>(closed ? (n % end + end) % end : std::clamp(n, 0, end - 1));
    };
    std::vector<double> sum(stride);
    for (std::size_t base = 0; base < in.size(); base += length * stride) {
        std::ranges::fill(sum, 0.0);
        for (int n = -radius; n <= radius; ++n)
            for (std::size_t s = 0; s < stride; ++s) sum[s] += in[base + place(n) + s];
        for (int n = 0; n < end; ++n) {
            const auto *const enters = &in[base + place(n + radius + 1)],
                              *const leaves = &in[base + place(n - radius)];
            auto* const mean = &out[base + place(n)];
            for (std::size_t s = 0; s < stride; ++s) {
                mean[s] = static_cast<float>(sum[s] / size);
                sum[s] += static_cast<double>(enters[s]) - leaves[s];
            }
        }
    }
}

/// Means over the patch around each sample. @param spare  of the same size; its content is lost
void mean_over(const Samples& like, Patch patch, std::vector<float>& values,
               std::vector<float>& spare) {
    const std::array lengths{like.shape[0], like.shape[1], like.shape[2], like.frames};
    std::size_t stride = 1;
    for (std::size_t d = 0; d < lengths.size(); ++d) {
        if (const int size = d < 3 ? patch.size : patch.frames; lengths[d] > 1 && size > 1) {
            mean_along(values, spare, lengths[d], stride, size,
                       (d == 1 && like.around) || (d == 2 && like.closed));
            values.swap(spare);
        }
        stride *= lengths[d];
    }
}

/// Squared differences to what is `shift` further along u; beyond its ends there is nothing.
void squared_differences(const Samples& of, const Samples& among, int shift,
                         std::vector<float>& out) {
    const int width = static_cast<int>(of.shape[0]), end = static_cast<int>(among.shape[0]);
    const int first = std::clamp(-shift, 0, width), last = std::clamp(end - shift, first, width);
    for (std::size_t r = 0; r < of.rows(); ++r) {
        const auto *const mine = of.row(r), *const theirs = among.row(r);
        auto* const square = out.data() + r * of.shape[0];
        for (int i = 0; i < first; ++i) square[i] = mine[i] * mine[i];
        for (int i = first; i < last; ++i)
            square[i] = (mine[i] - theirs[i + shift]) * (mine[i] - theirs[i + shift]);
        for (int i = last; i < width; ++i) square[i] = mine[i] * mine[i];
    }
}

/// Mean square distances of the patch around each sample of `of` to the nearest patch of `among` at
/// the same v, w and time.
/// @param shifts  along u, of the patches that are looked at
/// @return for each kind of patch, for each sample
std::vector<std::vector<float>> least_squares(const Samples& of, const Samples& among,
                                              const std::vector<Patch>& patches,
                                              const std::vector<int>& shifts) {
    struct Work {
        std::vector<float> squares, means, spare;
        std::vector<std::vector<float>> best;
    };
    const auto size = of.values.size();
    // The least of all shifts is the same in whatever order they come.
    tbb::enumerable_thread_specific<Work> works([&] {
        const std::vector<float> none(size);
        return Work{
            none,
            none,
            none,
            {patches.size(), std::vector<float>(size, std::numeric_limits<float>::infinity())}};
    });
    tbb::parallel_for(std::size_t{0}, shifts.size(), [&](std::size_t n) {
        auto& work = works.local();
        squared_differences(of, among, shifts[n], work.squares);
        for (std::size_t p = 0; p < patches.size(); ++p) {
            work.means = work.squares;
            mean_over(of, patches[p], work.means, work.spare);
            std::ranges::transform(work.best[p], work.means, work.best[p].begin(),
                                   [](float a, float b) { return std::min(a, b); });
        }
    });

    std::vector<std::vector<float>> out(
        patches.size(), std::vector<float>(size, std::numeric_limits<float>::infinity()));
    for (const auto& work : works)
        for (std::size_t p = 0; p < patches.size(); ++p)
            std::ranges::transform(out[p], work.best[p], out[p].begin(),
                                   [](float a, float b) { return std::min(a, b); });
    return out;
}

/// Those of the numbers of each sample that stand in the middle of a visible patch.
std::vector<float> of_visible(const Samples& samples, const std::vector<float>& numbers,
                              float visible, Patch patch) {
    std::vector<float> lit(samples.values.size()), spare(samples.values.size()), out;
    std::ranges::transform(samples.values, lit.begin(),
                           [&](float value) { return value > visible ? 1.0f : 0.0f; });
    mean_over(samples, patch, lit, spare);
    for (std::size_t n = 0; n < lit.size(); ++n)
        if (lit[n] > least_lit) out.push_back(numbers[n]);
    return out;
}

/// Shifts along u from -reach to reach, but for those below `least`.
std::vector<int> shifts_up_to(int reach, int least = 0) {
    std::vector<int> out;
    for (int shift = -reach; shift <= reach; ++shift)
        if (std::abs(shift) >= least) out.push_back(shift);
    return out;
}

/// Root mean square distances of the patches of `of` to the nearest patch of `among` at the same v,
/// w and time, by kind of patch.
std::vector<double> nearest(const Samples& of, const Samples& among, float visible,
                            const std::vector<Patch>& patches, int reach) {
    const auto squares = least_squares(of, among, patches, shifts_up_to(reach));
    std::vector<double> out;
    for (std::size_t p = 0; p < patches.size(); ++p) {
        const auto lit = of_visible(of, squares[p], visible, patches[p]);
        out.push_back(std::sqrt(std::accumulate(lit.begin(), lit.end(), 0.0) /
                                static_cast<double>(lit.size())));
    }
    return out;
}

/// The share of rare distances, by which what is not rare is counted.
constexpr double rare = 0.05;

/// The distance below which so many are. @param share  0 to 1
float quantile(std::vector<float> distances, double share) {
    const auto at = distances.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(distances.size() - 1));
    std::nth_element(distances.begin(), at, distances.end());
    return *at;
}

double repeated_in(const Samples& result, const Samples& even, float visible, int moved) {
    const Patch patch{7};
    // What overlaps by more than half is always alike.
    const auto shifts = shifts_up_to(moved + patch.size, patch.size / 2 + 1);
    const auto distances = [&](const Samples& of) {
        return of_visible(of, least_squares(of, of, {patch}, shifts)[0], visible, patch);
    };
    const auto like = quantile(distances(even), rare);
    const auto all = distances(result);
    return static_cast<double>(
               std::ranges::count_if(all, [&](float each) { return each < like; })) /
           (rare * static_cast<double>(all.size()));
}

double lost_in(const Samples& result, const Samples& source, const Samples& even, float visible,
               int moved) {
    const Patch patch{9};
    const auto distances = [&](const Samples& among) {
        return of_visible(source, least_squares(source, among, {patch}, shifts_up_to(moved + 4))[0],
                          visible, patch);
    };
    const auto far = quantile(distances(even), 1 - rare);
    const auto all = distances(result);
    return static_cast<double>(std::ranges::count_if(all, [&](float each) { return each > far; })) /
           (rare * static_cast<double>(all.size()));
}

/// Correlation length of the detail along u, as a share of that along the other dimensions.
double slenderness(const Samples& samples) {
    // Three means of 9 vertices are close to a Gaussian of 4.5 vertices.
    auto smooth = samples.values;
    std::vector<float> spare(smooth.size());
    for (int pass = 0; pass < 3; ++pass) mean_over(samples, {9}, smooth, spare);
    std::ranges::transform(samples.values, smooth, smooth.begin(), std::minus());
    const double power = std::inner_product(smooth.begin(), smooth.end(), smooth.begin(), 0.0);
    const auto length = [&](std::size_t size, std::size_t stride) {
        double out = 1;
        for (std::size_t apart = 1; apart < 7 && apart < size; ++apart) {
            double sum = 0;
            for (std::size_t base = 0; base < smooth.size(); base += size * stride)
                for (std::size_t n = base; n + apart * stride < base + size * stride; ++n)
                    sum += static_cast<double>(smooth[n]) * smooth[n + apart * stride];
            out += std::max(0.0, sum / power);
        }
        return out;
    };
    double across = 0, dimensions = 0;
    const std::array strides{std::size_t{1}, samples.shape[0], samples.shape[0] * samples.shape[1]};
    for (std::size_t d = 1; d < 3; ++d)
        if (samples.shape[d] > 1) across += length(samples.shape[d], strides[d]), ++dimensions;
    return length(samples.shape[0], 1) * dimensions / across;
}

std::optional<double> form_of(const Samples& result, const Samples& source, const Samples& even) {
    const double before = slenderness(source),
                 changed = std::abs(std::log(slenderness(even) / before));
    constexpr double nothing = 0.01;
    return changed < nothing
               ? std::nullopt
               : std::optional(1 - std::abs(std::log(slenderness(result) / before)) / changed);
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

double mass_of(const Samples& samples) {
    return std::accumulate(samples.values.begin(), samples.values.end(), 0.0);
}

/// The sum of the absolute second differences between samples that stand `stride` apart, per mass.
/// @param length  of the dimension that has this stride
double roughness(const Samples& samples, std::size_t length, std::size_t stride) {
    double sum = 0;
    const auto& values = samples.values;
    for (std::size_t base = 0; base < values.size(); base += length * stride)
        for (std::size_t n = base + stride; n + stride < base + length * stride; ++n)
            sum += std::abs(values[n + stride] - 2 * values[n] + values[n - stride]);
    return sum / mass_of(samples);
}

double jagged(const Samples& samples) { return roughness(samples, samples.shape[0], 1); }
double flicker(const Samples& samples) {
    return roughness(samples, samples.frames, samples.values.size() / samples.frames);
}

std::vector<double> shares(const std::vector<double>& of, const std::vector<double>& whole) {
    std::vector<double> out(of.size());
    std::ranges::transform(of, whole, out.begin(), std::divides());
    return out;
}

}  // namespace

double Looks::mean() const {
    return std::accumulate(completeness.begin(), completeness.end(),
                           std::accumulate(coherence.begin(), coherence.end(), 0.0)) /
           static_cast<double>(coherence.size() + completeness.size());
}

double Looks::worst() const {
    return std::max(std::ranges::max(coherence), std::ranges::max(completeness));
}

float visible_from(const Samples& source) {
    auto values = source.values;
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 1000);
    std::nth_element(values.begin(), high, values.end());
    return 0.02f * *high;
}

double visible_width(const Samples& samples, float visible) {
    double sum = 0, lines = 0;
    const auto [width, laterals, slices] = samples.shape;
    std::vector<bool> lit(width);
    for (std::size_t plane = 0; plane < samples.frames * slices; ++plane) {
        std::fill(lit.begin(), lit.end(), false);
        for (std::size_t j = 0; j < laterals; ++j)
            for (std::size_t i = 0; i < width; ++i)
                lit[i] = lit[i] || samples.row(plane * laterals + j)[i] > visible;
        const auto count = std::ranges::count(lit, true);
        sum += static_cast<double>(count);
        lines += count > 0 ? 1 : 0;
    }
    return sum / lines;
}

Samples stretched(const Samples& source, std::size_t width,
                  const std::function<double(double)>& from) {
    Samples out(source.frames, {width, source.shape[1], source.shape[2]}, source.closed,
                source.around);
    const double last = static_cast<double>(source.shape[0]) - 1;
    for (std::size_t i = 0; i < width; ++i) {
        const double at = std::clamp(from(static_cast<double>(i)), 0.0, last);
        const auto low = static_cast<std::size_t>(at),
                   high = std::min(low + 1, source.shape[0] - 1);
        const auto part = static_cast<float>(at - static_cast<double>(low));
        for (std::size_t r = 0; r < source.rows(); ++r)
            out.row(r)[i] = (1 - part) * source.row(r)[low] + part * source.row(r)[high];
    }
    return out;
}

Looks looks_of(const Samples& result, const Samples& source, const Samples& even, int moved) {
    const float visible = visible_from(source);
    const auto ours = similarity(result, source, visible, moved),
               theirs = similarity(even, source, visible, moved);
    Looks out;
    out.coherence = shares(ours.coherence, theirs.coherence);
    out.completeness = shares(ours.completeness, theirs.completeness);
    if (source.frames > 2) out.flicker = flicker(result) / flicker(source);
    out.jagged = jagged(result) / jagged(source);
    out.mass = mass_of(result) / mass_of(even);
    out.form = form_of(result, source, even);
    out.repeated = repeated_in(result, even, visible, moved);
    out.lost = lost_in(result, source, even, visible, moved);
    if (result.shape[0] != source.shape[0]) {
        const double narrower = 1 - visible_width(result, visible) / visible_width(source, visible);
        out.resized = narrower / (1 - static_cast<double>(result.shape[0]) /
                                          static_cast<double>(source.shape[0]));
    }
    return out;
}
