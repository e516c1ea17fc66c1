#include "carve/time/motion.h"

#include "carve/base/failure.h"
#include "carve/field/dense.h"
#include "carve/field/extent.h"

#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;

/// Voxels: standard deviation of the window in which motion is alike.
constexpr float width = 1.5f;
constexpr int rounds = 5;          ///< of correction
constexpr float most_step = 1.5f;  ///< voxels by which a round corrects at most
/// Resistance against correction, as shares of the structure tensor's trace: of the largest one,
/// and of the place's own.
constexpr float at_least = 1e-4f, own = 0.02f;
/// Voxels that the velocity of one of two frames moves at most, along each axis: a wild one would
/// widen what is moved without end.
constexpr float furthest = 64;
constexpr int margin = 4;     ///< voxels around the visible content
constexpr int coarsest = 24;  ///< voxels along the longest side up to which a box is not halved

/// Numbers in a box of voxels; z is fastest.
struct Box {
    CoordBBox bounds;
    std::array<int, 3> size;
    std::array<std::ptrdiff_t, 3> stride;

    explicit Box(const CoordBBox& box)
        : bounds(box), size{box.dim().x(), box.dim().y(), box.dim().z()} {
        stride = {static_cast<std::ptrdiff_t>(size[1]) * size[2], size[2], 1};
    }
    std::size_t count() const {
        return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(stride[0]);
    }
    /// Calls `body(index, x, y, z)` for all voxels, planes of x in parallel.
    template <class Body>
    void each(const Body& body) const {
        tbb::parallel_for(0, size[0], [&](int x) {
            auto at = x * stride[0];
            for (int y = 0; y < size[1]; ++y)
                for (int z = 0; z < size[2]; ++z, ++at) body(static_cast<std::size_t>(at), x, y, z);
        });
    }
};

using Numbers = std::vector<float>;
using Vectors = std::array<Numbers, 3>;

/// Values that are not finite show no motion, and count as 0.
Numbers numbers_of(const FloatGrid& grid, const Box& box) {
    openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(box.bounds);
    openvdb::tools::copyToDense(grid, dense);
    Numbers out(dense.data(), dense.data() + box.count());
    for (auto& value : out)
        if (!std::isfinite(value)) value = 0;
    return out;
}

/// Samples trilinearly; the border is repeated beyond the box.
float sample(const Numbers& of, const Box& box, const std::array<float, 3>& at) {
    std::array<std::ptrdiff_t, 3> low{}, high{};
    std::array<float, 3> part{};
    for (std::size_t n = 0; n < 3; ++n) {
        const float last = static_cast<float>(box.size[n] - 1),
                    place = at[n] > 0 ? std::min(at[n], last) : 0;  // also for NaN
        const auto first = static_cast<int>(place);
        part[n] = place - static_cast<float>(first);
        low[n] = first * box.stride[n];
        high[n] = std::min(first + 1, box.size[n] - 1) * box.stride[n];
    }
    const auto line = [&](std::ptrdiff_t begin) {
        const float a = of[static_cast<std::size_t>(begin + low[2])],
                    b = of[static_cast<std::size_t>(begin + high[2])];
        return a + part[2] * (b - a);
    };
    const auto plane = [&](std::ptrdiff_t begin) {
        const float a = line(begin + low[1]), b = line(begin + high[1]);
        return a + part[1] * (b - a);
    };
    const float a = plane(low[0]), b = plane(high[0]);
    return a + part[0] * (b - a);
}

/// Smooths by a Gaussian, along each axis in turn; the border is repeated beyond the box.
/// @param deviation  voxels
void smooth(Numbers& values, const Box& box, float deviation) {
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    std::vector<float> weights;
    float sum = 0;
    for (int n = -radius; n <= radius; ++n)
        sum += weights.emplace_back(
            std::exp(-0.5f * static_cast<float>(n * n) / (deviation * deviation)));
    for (auto& weight : weights) weight /= sum;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto p = axis == 0 ? std::size_t{1} : 0, q = axis == 2 ? std::size_t{1} : 2;
        const int length = box.size[axis];
        tbb::parallel_for(0, box.size[p], [&](int i) {
            std::vector<float> line(static_cast<std::size_t>(length + 2 * radius));
            for (int j = 0; j < box.size[q]; ++j) {
                float* const begin = values.data() + i * box.stride[p] + j * box.stride[q];
                for (int n = 0; n < length + 2 * radius; ++n)
                    line[static_cast<std::size_t>(n)] =
                        begin[std::clamp(n - radius, 0, length - 1) * box.stride[axis]];
                for (int n = 0; n < length; ++n) {
                    float out = 0;
                    for (std::size_t k = 0; k < weights.size(); ++k)
                        out += weights[k] * line[static_cast<std::size_t>(n) + k];
                    begin[n * box.stride[axis]] = out;
                }
            }
        });
    }
}

/// Two frames in a box, and the displacement between them at the moment halfway, voxels.
class Pair {
public:
    Pair(const MovingFrame& a, const MovingFrame& b, double scale, std::uint64_t memory_budget)
        : box_(bounds_of(a, b, memory_budget)) {
        before_ = numbers_of(*a.shown, box_);
        after_ = numbers_of(*b.shown, box_);
        keep_squarable();
        for (auto& axis : displacement_) axis.assign(box_.count(), 0);
        const auto& transform = a.shown->transform();
        const double voxels = scale / transform.voxelSize().x();
        for (const auto* const velocity : {a.velocity.get(), b.velocity.get()}) {
            if (!velocity) continue;
            tbb::parallel_for(0, box_.size[0], [&](int x) {
                // A sampler refers to the accessor.
                const auto accessor = velocity->getConstAccessor();
                const openvdb::tools::GridSampler<VectorGrid::ConstAccessor,
                                                  openvdb::tools::BoxSampler>
                    values(accessor, velocity->transform());
                auto at = static_cast<std::size_t>(x * box_.stride[0]);
                for (int y = 0; y < box_.size[1]; ++y)
                    for (int z = 0; z < box_.size[2]; ++z, ++at) {
                        const auto here = values.isSample(near_place(velocity->worldToIndex(
                            transform.indexToWorld(box_.bounds.min().offsetBy(x, y, z)))));
                        for (int n = 0; n < 3; ++n)
                            if (const auto moved = static_cast<float>(0.5 * voxels * here[n]);
                                std::isfinite(moved))
                                displacement_[static_cast<std::size_t>(n)][at] +=
                                    std::clamp(moved, -furthest, furthest);
                    }
            });
        }
    }

    /// Corrects the displacement by what both frames show (Lucas and Kanade 1981), at half size
    /// first, which finds motion further than the width of the window.
    void correct() {
        if (*std::ranges::max_element(box_.size) > coarsest) {
            auto half = halved();
            half.correct();
            take_from(half);
        }
        for (int round = 0; round < rounds; ++round) {
            auto left = differences();
            auto& rest = left.rest;
            auto& tensor = left.tensor;
            for (auto& each : rest) smooth(each, box_, width);
            for (auto& each : tensor) smooth(each, box_, width);
            float largest = 0;
            for (std::size_t n = 0; n < box_.count(); ++n)
                largest = std::max(largest, tensor[0][n] + tensor[3][n] + tensor[5][n]);
            if (largest < 1e-30f) return;  // there is no structure to follow
            box_.each([&](std::size_t at, int, int, int) {
                const double firm =
                    at_least * largest + own * (tensor[0][at] + tensor[3][at] + tensor[5][at]);
                const auto of = [&](std::size_t n) { return static_cast<double>(tensor[n][at]); };
                const openvdb::Mat3d matrix(of(0) + firm, of(1), of(2), of(1), of(3) + firm, of(4),
                                            of(2), of(4), of(5) + firm);
                const auto by = matrix.inverse(0) * Vec3d(rest[0][at], rest[1][at], rest[2][at]);
                for (std::size_t n = 0; n < 3; ++n)
                    displacement_[n][at] -= std::clamp(static_cast<float>(by[static_cast<int>(n)]),
                                                       -most_step, most_step);
            });
            for (auto& each : displacement_) smooth(each, box_, 0.5f * width);
        }
    }

    /// The displacement that is left, as both frames show it.
    struct Differences {
        Vectors rest;                   ///< slope times change
        std::array<Numbers, 6> tensor;  ///< products of slopes
    };
    Differences differences() const {
        const auto nothing = Numbers(box_.count());
        Differences out{{nothing, nothing, nothing},
                        {nothing, nothing, nothing, nothing, nothing, nothing}};
        auto middle = nothing, change = nothing;
        {
            const auto [from, to] = halfway();
            for (std::size_t n = 0; n < middle.size(); ++n) {
                middle[n] = 0.5f * (from[n] + to[n]);
                change[n] = to[n] - from[n];
            }
        }
        box_.each([&](std::size_t at, int x, int y, int z) {
            const auto slope = slopes(middle, at, {x, y, z});
            std::size_t n = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                out.rest[i][at] = slope[i] * change[at];
                for (std::size_t j = i; j < 3; ++j) out.tensor[n++][at] = slope[i] * slope[j];
            }
        });
        return out;
    }

    /// The same at half size: means of cubes of eight voxels.
    Pair halved() const {
        const auto half_of = [&](int size) { return (size + 1) / 2; };
        Pair out(Box(CoordBBox(Coord(0), Coord(half_of(box_.size[0]) - 1, half_of(box_.size[1]) - 1,
                                               half_of(box_.size[2]) - 1))));
        const auto mean = [&](const Numbers& from, Numbers& to, float by) {
            to.resize(out.box_.count());
            out.box_.each([&](std::size_t at, int x, int y, int z) {
                float sum = 0;
                for (int n = 0; n < 8; ++n) {
                    const std::array place{2 * x + (n & 1), 2 * y + (n >> 1 & 1), 2 * z + (n >> 2)};
                    std::ptrdiff_t fine = 0;
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        fine += std::min(place[axis], box_.size[axis] - 1) * box_.stride[axis];
                    sum += from[static_cast<std::size_t>(fine)];
                }
                to[at] = by * sum / 8;
            });
        };
        mean(before_, out.before_, 1);
        mean(after_, out.after_, 1);
        for (std::size_t n = 0; n < 3; ++n) mean(displacement_[n], out.displacement_[n], 0.5f);
        return out;
    }

    double mismatch() const {
        const auto [from, to] = halfway();
        double sum = 0;
        for (std::size_t n = 0; n < from.size(); ++n)
            sum += static_cast<double>(to[n] - from[n]) * (to[n] - from[n]);
        return std::sqrt(sum / static_cast<double>(from.size()));
    }

    /// The displacement as a grid, world units.
    VectorGrid::Ptr grid(const openvdb::math::Transform& transform) const {
        openvdb::tools::Dense<Vec3s, openvdb::tools::LayoutZYX> dense(box_.bounds);
        const auto voxel = static_cast<float>(transform.voxelSize().x());
        for (std::size_t n = 0; n < box_.count(); ++n)
            dense.data()[n] =
                voxel * Vec3s(displacement_[0][n], displacement_[1][n], displacement_[2][n]);
        const auto out = VectorGrid::create(Vec3s(0));
        openvdb::tools::copyFromDense(dense, *out, Vec3s(0));
        out->setTransform(transform.copy());
        return out;
    }

private:
    static CoordBBox bounds_of(const MovingFrame& a, const MovingFrame& b,
                               std::uint64_t memory_budget) {
        auto out = active_box(*a.shown);
        out.expand(active_box(*b.shown));
        if (out.empty()) out = CoordBBox(Coord(0), Coord(0));
        require_near(a.shown->getName(), out);
        // A picture needs no margin: its rim is repeated beyond.
        if (out.dim().z() > 1) out = padded(out, margin);
        constexpr double bytes = 24 * sizeof(float);
        if (!grid_fits(bytes * static_cast<double>(voxels_in(out)), memory_budget))
            throw Failure(fmt::format(
                "the motion of grid '{}' in {} exceeds --memory: crop the grid, or raise --memory",
                a.shown->getName(), span_text(out)));
        return out;
    }

    explicit Pair(const Box& box) : box_(box) {}

    /// Scales both frames down if the sum of their squared values would be infinite.
    void keep_squarable() {
        constexpr float most = 1e12f;
        float largest = 0;
        for (const auto* const each : {&before_, &after_})
            for (const float value : *each) largest = std::max(largest, std::abs(value));
        if (largest <= most) return;
        for (auto* const each : {&before_, &after_})
            for (float& value : *each) value *= 1 / largest;
    }

    /// Adopts a displacement found at half size.
    void take_from(const Pair& half) {
        box_.each([&](std::size_t at, int x, int y, int z) {
            const std::array place{0.5f * static_cast<float>(x) - 0.25f,
                                   0.5f * static_cast<float>(y) - 0.25f,
                                   0.5f * static_cast<float>(z) - 0.25f};
            for (std::size_t n = 0; n < 3; ++n)
                displacement_[n][at] = 2 * sample(half.displacement_[n], half.box_, place);
        });
    }

    /// Both frames, each moved halfway to the other.
    std::pair<Numbers, Numbers> halfway() const {
        Numbers from(box_.count()), to(box_.count());
        box_.each([&](std::size_t at, int x, int y, int z) {
            const std::array<float, 3> here{static_cast<float>(x), static_cast<float>(y),
                                            static_cast<float>(z)};
            for (const float side : {-0.5f, 0.5f}) {
                // Midpoint steps.
                std::array<float, 3> middle = here, source = here;
                for (std::size_t n = 0; n < 3; ++n) middle[n] += 0.5f * side * displacement_[n][at];
                for (std::size_t n = 0; n < 3; ++n)
                    source[n] += side * sample(displacement_[n], box_, middle);
                (side < 0 ? from : to)[at] = sample(side < 0 ? before_ : after_, box_, source);
            }
        });
        return {std::move(from), std::move(to)};
    }

    /// Central differences; one-sided at the ends of the box.
    std::array<float, 3> slopes(const Numbers& of, std::size_t at,
                                const std::array<int, 3>& place) const {
        std::array<float, 3> out{};
        for (std::size_t n = 0; n < 3; ++n) {
            const auto below = place[n] > 0 ? -box_.stride[n] : 0,
                       above = place[n] + 1 < box_.size[n] ? box_.stride[n] : 0;
            if (above == below) continue;
            const auto value = [&](std::ptrdiff_t by) {
                return of[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + by)];
            };
            out[n] = (value(above) - value(below)) / (below != 0 && above != 0 ? 2.0f : 1.0f);
        }
        return out;
    }

    Box box_;
    Numbers before_, after_;
    Vectors displacement_;
};

}  // namespace

VectorGrid::Ptr motion_between(const MovingFrame& a, const MovingFrame& b, double scale,
                               std::uint64_t memory_budget) {
    Pair pair(a, b, scale, memory_budget);
    pair.correct();
    return pair.grid(a.shown->transform());
}

double mismatch(const MovingFrame& a, const MovingFrame& b, double scale,
                std::uint64_t memory_budget) {
    // Half the size gives the same answer, eight times as fast.
    return Pair(a, b, scale, memory_budget).halved().mismatch();
}

double typical_speed(const MovingFrame& frame) {
    if (!frame.velocity) return 0;
    const auto accessor = frame.velocity->getConstAccessor();
    const openvdb::tools::GridSampler<VectorGrid::ConstAccessor, openvdb::tools::PointSampler>
        values(accessor, frame.velocity->transform());
    double sum = 0, count = 0;
    for (auto leaf = frame.shown->tree().cbeginLeaf(); leaf; ++leaf)
        for (auto value = leaf->cbeginValueOn(); value; ++value) {
            const auto at =
                frame.velocity->worldToIndex(frame.shown->indexToWorld(value.getCoord()));
            const double square = Vec3d(values.isSample(near_place(at))).lengthSqr();
            if (!std::isfinite(square)) continue;
            sum += square;
            ++count;
        }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace fluidcarve
