#include "nodes/remap/transport.h"

#include "nodes/remap/blocks.h"

#include <cmath>
#include <memory>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

template <class GridT>
class Worker {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;

public:
    Worker(const GridT& grid, CarvedPlaces places, const CarveDerivative& derivative)
        : derivative_(derivative),
          staggered_(grid.getGridClass() == openvdb::GRID_STAGGERED),
          on_faces_(staggered_ && !places.aligned()),
          places_(std::move(places)),
          window_(grid.tree()) {}

    bool operator()(const Coord& block, Leaf& out) {
        if (places_.move_to(block).empty()) return false;
        window_.move_to(CoordBBox::createCube(block.offsetBy(staggered_ ? -1 : 0), staggered_ ? 10 : 8));
        if (window_.uniform() && (!window_.tile().on || window_.tile().value == openvdb::zeroVal<Value>())) return false;
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
    /// Calls `visit(z, derivative)` for the active voxels of a row that have one.
    template <class Visit>
    void each(const Coord& first, const Vec3d& offset, Visit&& visit) {
        places_.locate(first, offset, places_row_);
        for (std::size_t z = 0; z < 8; ++z)
            if (row_[z].on && (places_row_.inside >> z & 1) != 0)
                if (const auto derivative = derivative_(places_row_.at[z])) visit(z, *derivative);
    }

    void scale(const Coord& first) {
        each(first, Vec3d(0), [&](std::size_t z, const openvdb::Mat3d& derivative) { row_[z].value = Value(row_[z].value * std::abs(derivative.det())); });
    }

    void turn(const Coord& first) {
        using Element = typename Value::ValueType;
        if (!staggered_) {
            each(first, Vec3d(0), [&](std::size_t z, const openvdb::Mat3d& derivative) { row_[z].value = Value(derivative.inverse() * Vec3d(row_[z].value)); });
            return;
        }
        for (int c = 0; c < 3; ++c) {
            Vec3d offset(0);
            if (on_faces_) offset[c] = -0.5;
            each(first, offset, [&](std::size_t z, const openvdb::Mat3d& derivative) {
                row_[z].value[c] = static_cast<Element>(derivative.inverse().row(c).dot(at_face(first.offsetBy(0, 0, static_cast<int>(z)), c)));
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
                for (int step = 0; step < 2; ++step, ++near[other]) out[other] += 0.25 * static_cast<double>(window_.get(near).value[other]);
        }
        return out;
    }

    const CarveDerivative& derivative_;
    const bool staggered_, on_faces_;
    CarvedPlaces places_;
    CarvedPlaces::Row places_row_;
    BlockWindow<TreeT> window_;
    std::array<typename BlockWindow<TreeT>::Voxel, 8> row_;
};

template <class GridT>
openvdb::GridBase::ConstPtr transported(const openvdb::GridBase::ConstPtr& base, const CarvedPlaces& places, const CarveDerivative& derivative) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    return rewrite_blocks<GridT>(grid, places.voxels(derivative.range()), [&] {
        return [worker = std::make_shared<Worker<GridT>>(*grid, places, derivative)](const Coord& block, LeafOf<GridT>& out) { return (*worker)(block, out); };
    });
}

}  // namespace

openvdb::GridBase::ConstPtr mass_kept(const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places, const CarveDerivative& derivative) {
    if (grid->isType<openvdb::FloatGrid>()) return transported<openvdb::FloatGrid>(grid, places, derivative);
    return transported<openvdb::DoubleGrid>(grid, places, derivative);
}

openvdb::GridBase::ConstPtr vectors_turned(const openvdb::GridBase::ConstPtr& grid, const CarvedPlaces& places, const CarveDerivative& derivative) {
    if (grid->isType<openvdb::Vec3SGrid>()) return transported<openvdb::Vec3SGrid>(grid, places, derivative);
    return transported<openvdb::Vec3DGrid>(grid, places, derivative);
}

}  // namespace fluidcarve
