#include "carve/remap/finish/transport.h"

#include "carve/points/point_vectors.h"
#include "carve/remap/voxels/blocks.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Number of positions that are sampled for each further voxel pressed into one, and the largest
/// number in all.
constexpr int places_per_voxel = 4, most_places = 64;
/// Compression by less than this share is ignored.
constexpr double hardly = 1e-3;

/// Scales a density, or turns vectors, block by block.
template <class GridT>
class TransportedBlocks {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;

public:
    /// @param source  the grid before the carve, for densities; else null
    TransportedBlocks(const GridT* source, const GridT& grid, CarvedPlaces places,
                      const CarveDerivative& derivative)
        : derivative_(derivative),
          source_(source ? source : &grid),
          values_(source_->getConstAccessor()),
          exact_(derivative.exact()),
          staggered_(grid.getGridClass() == openvdb::GRID_STAGGERED),
          on_faces_(staggered_ && !places.aligned()),
          places_(std::move(places)),
          window_(grid.tree()) {}

    bool operator()(const Coord& block, Leaf& out) {
        if (places_.move_to(block).empty()) return false;
        window_.move_to(
            CoordBBox::createCube(block.offsetBy(staggered_ ? -1 : 0), staggered_ ? 10 : 8));
        if (window_.uniform() &&
            (!window_.tile().on || window_.tile().value == openvdb::zeroVal<Value>()))
            return false;
        for (openvdb::Index n = 0; n < Leaf::SIZE; n += 8) {
            const auto first = out.offsetToGlobalCoord(n);
            window_.read(first, row_);
            if constexpr (openvdb::VecTraits<Value>::IsVec) turn(first);
            else scale(first);
            window_.write(out, n, row_);
        }
        return true;
    }

private:
    /// Calls `visit(z, image)` for the voxels of a row that have an image.
    /// @param inactive  whether to visit inactive voxels too
    template <class Visit>
    void each(const Coord& first, const Vec3d& offset, bool inactive, Visit&& visit) {
        places_.locate(first, offset, places_row_);
        for (std::size_t z = 0; z < 8; ++z)
            if ((inactive || row_[z].on) && (places_row_.inside >> z & 1) != 0)
                if (const auto image = derivative_.image(places_row_.at[z])) visit(z, *image);
    }

    void scale(const Coord& first) {
        const bool around = exact_ && source_->background() == openvdb::zeroVal<Value>();
        each(first, Vec3d(0), around, [&](std::size_t z, const CarveDerivative::Image& image) {
            auto& [value, on] = row_[z];
            if (const auto mean = pressed_mean(places_row_.at[z], image)) {
                if (!on && !(*mean > 0)) return;
                value = Value(*mean);
                on = true;
            } else if (on) {
                value = Value(value * std::abs(image.derivative.det()));
            }
        });
    }

    /// Mean of all content that is pressed into a voxel, along the axis of the strongest
    /// compression; nothing if it is not compressed.
    std::optional<double> pressed_mean(const Vec3d& at, const CarveDerivative::Image& image) {
        if (!exact_) return std::nullopt;
        int axis = 0;
        for (const int other : {1, 2})
            if (image.slope(other, other) > image.slope(axis, axis)) axis = other;
        const int count = std::min(
            most_places, 1 + static_cast<int>(std::ceil(places_per_voxel *
                                                        (image.slope(axis, axis) - 1 - hardly))));
        if (count < 2) return std::nullopt;
        const auto& mapping = derivative_.mapping();
        // Half of a voxel, in vertices.
        const double half = 0.5 * source_->voxelSize()[0] /
                            position_slope(mapping, at).col(axis).length(),
                     width = 2 * half / count;
        const auto image_at = [&](double from) {
            auto place = at;
            place[axis] += from - half;
            return derivative_.image(place);
        };
        double sum = 0;
        int met = 0;
        auto below = image_at(0);
        for (int n = 0; n < count; ++n) {
            const auto there = image_at((n + 0.5) * width), above = image_at((n + 1) * width);
            if (there) {
                // Content between both ends, so that neighbouring parts together count all content
                // once.
                const double slope = below && above
                                         ? (above->source[axis] - below->source[axis]) / width
                                         : there->slope(axis, axis);
                const auto world = mapping.position(there->source);
                sum += slope / there->slope(axis, axis) * std::abs(there->derivative.det()) *
                       openvdb::tools::BoxSampler::sample(values_,
                                                          source_->transform().worldToIndex(world));
                ++met;
            }
            below = above;
        }
        return met > 0 ? std::optional(sum / met) : std::nullopt;
    }

    void turn(const Coord& first) {
        using Element = typename Value::ValueType;
        if (!staggered_) {
            each(first, Vec3d(0), false, [&](std::size_t z, const CarveDerivative::Image& image) {
                row_[z].value = Value(image.derivative.inverse() * Vec3d(row_[z].value));
            });
            return;
        }
        for (int c = 0; c < 3; ++c) {
            Vec3d offset(0);
            if (on_faces_) offset[c] = -0.5;
            each(first, offset, false, [&](std::size_t z, const CarveDerivative::Image& image) {
                row_[z].value[c] = static_cast<Element>(image.derivative.inverse().row(c).dot(
                    at_face(first.offsetBy(0, 0, static_cast<int>(z)), c)));
            });
        }
    }

    /// The whole vector at the face of component `c`.
    Vec3d at_face(const Coord& voxel, int c) const {
        auto below = voxel;
        --below[c];
        Vec3d out(window_.get(voxel).value);
        for (int other = 0; other < 3; ++other) {
            if (other == c) continue;
            out[other] = 0;
            for (auto near : {voxel, below})
                for (int step = 0; step < 2; ++step, ++near[other])
                    out[other] += 0.25 * static_cast<double>(window_.get(near).value[other]);
        }
        return out;
    }

    const CarveDerivative& derivative_;
    const GridT* const source_;
    typename GridT::ConstAccessor values_;
    const bool exact_;
    const bool staggered_, on_faces_;
    CarvedPlaces places_;
    CarvedPlaces::Row places_row_;
    BlockWindow<TreeT> window_;
    std::array<typename BlockWindow<TreeT>::Voxel, 8> row_;
};

template <class GridT>
openvdb::GridBase::ConstPtr transported(const openvdb::GridBase::ConstPtr& from,
                                        const openvdb::GridBase::ConstPtr& base,
                                        const CarvedPlaces& places,
                                        const CarveDerivative& derivative) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    const auto source = from ? openvdb::GridBase::grid<GridT>(from) : nullptr;
    return rewrite_blocks<GridT>(grid, places.voxels(derivative.range()), [&] {
        return block_worker<GridT, TransportedBlocks<GridT>>(source.get(), *grid, places,
                                                             derivative);
    });
}

}  // namespace

openvdb::GridBase::ConstPtr mass_kept(const openvdb::GridBase::ConstPtr& source,
                                      const openvdb::GridBase::ConstPtr& grid,
                                      const CarvedPlaces& places,
                                      const CarveDerivative& derivative) {
    if (grid->isType<openvdb::FloatGrid>())
        return transported<openvdb::FloatGrid>(source, grid, places, derivative);
    return transported<openvdb::DoubleGrid>(source, grid, places, derivative);
}

openvdb::GridBase::ConstPtr vectors_turned(const openvdb::GridBase::ConstPtr& grid,
                                           const CarvedPlaces& places,
                                           const CarveDerivative& derivative) {
    if (grid->isType<openvdb::Vec3SGrid>())
        return transported<openvdb::Vec3SGrid>(nullptr, grid, places, derivative);
    return transported<openvdb::Vec3DGrid>(nullptr, grid, places, derivative);
}

Points vectors_turned(const Points& points, const CarveDerivative& derivative) {
    const auto name = velocity_name(points);
    if (name.empty()) return points;
    auto vectors = vectors_of(points, name);
    const auto positions = points.positions();
    tbb::parallel_for(std::size_t{0}, vectors.size(), [&](std::size_t n) {
        const auto at = derivative.mapping().locate(positions[n]);
        if (const auto slope = at ? derivative(*at) : std::nullopt)
            vectors[n] = slope->inverse() * vectors[n];
    });
    return with_vectors(points, name, vectors);
}

}  // namespace fluidcarve
