#include "carve/sdf/balls.h"

#include "carve/simd/wide.h"

#include <openvdb/tools/PointIndexGrid.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;

/// The interface to points that OpenVDB sorts into blocks.
struct PointList {
    using PosType = Vec3d;
    std::span<const Vec3d> points;
    std::size_t size() const { return points.size(); }
    void getPos(std::size_t n, Vec3d& at) const { at = points[n]; }
};

using Four = double __attribute__((vector_size(32)));

/// Squared distances from the voxels of a block of 8^3 to their nearest centre, `[x][y][z]`, in
/// fours.
using Squares = std::array<Four, Leaf::SIZE / 4>;

/// Lowers the squared distances of a block to those of further centres, where these are smaller.
/// @param places    indices of the centres
/// @param farthest  distance beyond which a centre has no effect
FLUIDCARVE_WIDE void lower(const Coord& block, std::span<const Vec3d> centres,
                           std::span<const openvdb::PointIndex32> places, double farthest,
                           Squares& squares) {
    for (const std::uint32_t place : places) {
        double along[3][8];
        int first[3], end[3];  // range of the voxels that are near enough along each axis
        for (int axis = 0; axis < 3; ++axis) {
            const double at = centres[place][axis];
            for (int n = 0; n < 8; ++n) {
                const double from = (block[axis] + n) - at;
                along[axis][n] = from * from;
            }
            const double from = at - farthest - block[axis], to = at + farthest - block[axis];
            first[axis] = from > 0 ? static_cast<int>(std::min(from, 8.0)) : 0;
            end[axis] = to < 7 ? static_cast<int>(std::max(to, -1.0)) + 1 : 8;
        }
        if (first[2] >= end[2]) continue;
        const auto& z = along[2];
        const Four near{z[0], z[1], z[2], z[3]}, far{z[4], z[5], z[6], z[7]};
        for (int x = first[0]; x < end[0]; ++x)
            for (int y = first[1]; y < end[1]; ++y) {
                const double across = along[0][x] + along[1][y];
                auto* const row = squares.data() + 2 * (8 * x + y);
                row[0] = across + near < row[0] ? across + near : row[0];
                row[1] = across + far < row[1] ? across + far : row[1];
            }
    }
}

/// The blocks that a ball's distances may reach from any place in a block, in units of blocks.
CoordBBox reached(const Coord& block, double farthest) {
    const Vec3d low = block.asVec3d() - Vec3d(0.5), high = low + Vec3d(8);
    return {Coord::floor((low - Vec3d(farthest)) / 8), Coord::floor((high + Vec3d(farthest)) / 8)};
}

class Rasterizer {
public:
    Rasterizer(const Balls& balls, double voxel)
        : balls_(balls),
          voxel_(voxel),
          farthest_(balls.radius + balls.half_width),
          deepest_(balls.radius > balls.half_width ? std::pow(balls.radius - balls.half_width, 2)
                                                   : -1),
          background_(static_cast<float>(balls.half_width * voxel)),
          points_(openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(
              PointList{balls.centres}, *openvdb::math::Transform::createLinearTransform())) {}

    openvdb::FloatTree::Ptr operator()() const {
        const auto blocks = blocks_in_reach();
        std::vector<std::unique_ptr<Leaf>> leaves(blocks.size());
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, blocks.size()),
            [&](const tbb::blocked_range<std::size_t>& range) {
                const auto points = points_->getConstAccessor();
                for (auto n = range.begin(); n < range.end(); ++n)
                    leaves[n] = leaf_at(
                        Coord(blocks[n].x() * 8, blocks[n].y() * 8, blocks[n].z() * 8), points);
            });
        auto out = std::make_shared<openvdb::FloatTree>(background_);
        for (auto& leaf : leaves)
            if (leaf) out->addLeaf(leaf.release());
        openvdb::tools::pruneLevelSet(*out);
        return out;
    }

private:
    std::vector<Coord> blocks_in_reach() const {
        openvdb::MaskTree marked;
        for (auto leaf = points_->tree().cbeginLeaf(); leaf; ++leaf)
            marked.denseFill(reached(leaf->origin(), farthest_), true);
        std::vector<Coord> out;
        for (auto at = marked.cbeginValueOn(); at; ++at) out.push_back(at.getCoord());
        return out;
    }

    /// The distances in a block; null if all are the background.
    std::unique_ptr<Leaf> leaf_at(
        const Coord& block, const openvdb::tools::PointIndexGrid::ConstAccessor& points) const {
        const double most = farthest_ * farthest_;
        Squares squares;
        squares.fill(Four{} + most);
        const auto near = reached(block, farthest_);
        for (auto at = near.begin(); at; ++at)
            if (const auto* const leaf =
                    points.probeConstLeaf(Coord((*at).x() * 8, (*at).y() * 8, (*at).z() * 8)))
                lower(block, balls_.centres, leaf->indices(), farthest_, squares);
        std::unique_ptr<Leaf> out;
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const double square = squares[n / 4][n % 4];
            if (square >= most) continue;
            if (!out) out = std::make_unique<Leaf>(block, background_, false);
            if (square <= deepest_) {
                out->setValueOff(n, -background_);
                continue;
            }
            const auto distance = static_cast<float>(voxel_ * (std::sqrt(square) - balls_.radius));
            if (distance < background_) out->setValueOn(n, distance);
        }
        return out;
    }

    const Balls balls_;
    const double voxel_;
    const double farthest_;  ///< distance from a centre beyond which all is outside, voxels
    /// Square of the distance from a centre below which all is inside; -1: none.
    const double deepest_;
    const float background_;
    const openvdb::tools::PointIndexGrid::ConstPtr points_;  ///< by index coordinates
};

}  // namespace

openvdb::FloatTree::Ptr distances_to_balls(const Balls& balls, double voxel) {
    return Rasterizer(balls, voxel)();
}

}  // namespace fluidcarve
