#include "carve/time/time_surface.h"

#include "carve/field/extent.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>

namespace fluidcarve {

using openvdb::Coord;

namespace {

constexpr std::uint64_t most_cubes = std::uint64_t{1} << 24;

std::size_t count_of(const Coord& size) {
    return static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()) *
           static_cast<std::size_t>(size.z());
}

}  // namespace

TimeSurface::TimeSurface(const FloatGrid& like, std::size_t frames, double width,
                         const openvdb::CoordBBox& box)
    : space_(like.transform().copy()), frames_(frames), width_(width) {
    const auto cubes = [&](const Coord& voxel) {
        return Coord(voxel.x() >> shift_, voxel.y() >> shift_, voxel.z() >> shift_);
    };
    const auto measure = [&] {
        const openvdb::CoordBBox all(cubes(box.min()), cubes(box.max()));
        if (voxels_in(all) > most_cubes) return false;
        low_ = all.min();
        size_ = all.dim();
        return true;
    };
    while (!measure()) ++shift_;
    for (auto* const values : {&when_, &weight_, &all_}) values->assign(count_of(size_), 0);
}

void TimeSurface::add(const FloatGrid& first, const FloatGrid& second) {
    std::vector<float> squares(when_.size());
    const auto add_from = [&](const FloatGrid& grid, const FloatGrid& other, bool both) {
        const auto values = other.getConstAccessor();
        for (auto value = grid.cbeginValueOn(); value; ++value) {
            const auto at = value.getCoord();
            if (!value.isVoxelValue() || (!both && values.isValueOn(at))) continue;
            const float off = *value - values.getValue(at);
            const auto cube = Coord(at.x() >> shift_, at.y() >> shift_, at.z() >> shift_) - low_;
            if (std::isfinite(off))
                squares[(static_cast<std::size_t>(cube.x()) * static_cast<std::size_t>(size_.y()) +
                         static_cast<std::size_t>(cube.y())) *
                            static_cast<std::size_t>(size_.z()) +
                        static_cast<std::size_t>(cube.z())] += off * off;
        }
    };
    add_from(first, second, true);
    add_from(second, first, false);
    smooth(squares, 2);
    const float sum = std::reduce(squares.begin(), squares.end()),
                mean = sum > 0 ? sum / static_cast<float>(squares.size()) : 1;
    const auto moment = static_cast<float>(++added_);
    for (std::size_t n = 0; n < squares.size(); ++n) {
        // The moments where both sides match best count most.
        const float off = squares[n] / mean + 1e-6f, likeness = 1 / (off * off);
        when_[n] += likeness * moment;
        weight_[n] += likeness;
        all_[n] += squares[n] + 1e-3f * mean;
    }
}

void TimeSurface::finish() {
    // Smooths the moments, weighted by the differences at each place.
    for (std::size_t n = 0; n < when_.size(); ++n) when_[n] = all_[n] * (when_[n] / weight_[n]);
    smooth(when_, 4);
    smooth(all_, 4);
    const double middle = 0.5 * static_cast<double>(frames_ + 1),
                 reach = std::max(0.0, middle - 0.5 * width_);
    for (std::size_t n = 0; n < when_.size(); ++n)
        when_[n] = static_cast<float>(
            std::clamp(static_cast<double>(when_[n] / all_[n]), middle - reach, middle + reach));
}

double TimeSurface::share(int pair, const openvdb::Vec3d& world) const {
    const auto voxel = space_->worldToIndex(world);
    std::array<std::size_t, 3> cell{}, next{};
    std::array<double, 3> part{};
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::clamp((voxel[axis] + 0.5) / (1 << shift_) - 0.5 - low_[axis], 0.0,
                                     size_[axis] - 1.0);
        const auto n = static_cast<std::size_t>(axis);
        cell[n] = static_cast<std::size_t>(at);
        next[n] = std::min(cell[n] + 1, static_cast<std::size_t>(size_[axis] - 1));
        part[n] = at - static_cast<double>(cell[n]);
    }
    double when = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        std::array<std::size_t, 3> at{};
        for (std::size_t n = 0; n < 3; ++n) {
            const bool far = (corner >> n & 1) != 0;
            at[n] = far ? next[n] : cell[n];
            weight *= far ? part[n] : 1 - part[n];
        }
        when += weight * when_[(at[0] * static_cast<std::size_t>(size_.y()) + at[1]) *
                                   static_cast<std::size_t>(size_.z()) +
                               at[2]];
    }
    const double x = std::clamp((pair + 1 - when) / width_ + 0.5, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

void TimeSurface::smooth(std::vector<float>& values, int times) const {
    const std::array<std::size_t, 3> size{static_cast<std::size_t>(size_.x()),
                                          static_cast<std::size_t>(size_.y()),
                                          static_cast<std::size_t>(size_.z())};
    const std::array<std::size_t, 3> stride{size[1] * size[2], size[2], 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (size[axis] == 1) continue;
        const std::size_t p = axis == 0 ? 1 : 0, q = axis == 2 ? 1 : 2;
        tbb::parallel_for(std::size_t{0}, size[p], [&](std::size_t i) {
            std::vector<float> line(size[axis]);
            for (std::size_t j = 0; j < size[q]; ++j) {
                float* const first = values.data() + i * stride[p] + j * stride[q];
                for (int turn = 0; turn < times; ++turn) {
                    for (std::size_t n = 0; n < line.size(); ++n) line[n] = first[n * stride[axis]];
                    for (std::size_t n = 0; n < line.size(); ++n)
                        first[n * stride[axis]] = 0.25f * line[n > 0 ? n - 1 : 0] + 0.5f * line[n] +
                                                  0.25f * line[std::min(n + 1, line.size() - 1)];
                }
            }
        });
    }
}

std::optional<TimeSurface> surface_between(
    const Sequence& source, const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
    double width, const std::function<void()>& check) {
    if (source.box().empty()) return std::nullopt;
    std::optional<TimeSurface> out;
    FloatGrid::ConstPtr like;
    for (const auto& [first, second] : pairs) {
        check();
        const auto shown = shown_in(source.at(first).volume, source.at(second).volume);
        if (!shown || (like && shown->first->transform() != like->transform())) return std::nullopt;
        like = shown->first;
        if (!out) out.emplace(*like, pairs.size(), width, source.box());
        out->add(*like, *shown->second);
    }
    out->finish();
    return out;
}

}  // namespace fluidcarve
