#include "carve/time/between.h"

#include "carve/points/point_vectors.h"
#include "carve/stream/openvdb_types.h"
#include "carve/time/advect.h"
#include "carve/time/paced.h"
#include "carve/time/points_between.h"
#include "carve/volume/grid_types.h"

#include <openvdb/tools/Activate.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/ValueTransformer.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

/// Multiplies all values, including the background.
template <class GridT>
void multiply(GridT& grid, double by) {
    using Element = typename openvdb::VecTraits<typename GridT::ValueType>::ElementType;
    openvdb::tools::foreach (grid.beginValueAll(), [by](const auto& value) {
        value.setValue(*value * static_cast<Element>(by));
    });
    openvdb::tools::changeBackground(
        grid.tree(), typename GridT::ValueType(grid.background() * static_cast<Element>(by)));
}

/// Cuts the narrow band of a level set at the background's distance.
void trim(FloatGrid& grid) {
    const float background = grid.background();
    openvdb::tree::LeafManager<FloatGrid::TreeType>(grid.tree())
        .foreach ([&](auto& leaf, std::size_t) {
            for (auto value = leaf.beginValueOn(); value; ++value)
                if (std::abs(*value) >= background) {
                    value.setValue(std::copysign(background, *value));
                    value.setValueOff();
                }
        });
    openvdb::tools::pruneLevelSet(grid.tree());
}

/// Activates the inside of a level set, as voxels.
void activate_inside(FloatGrid& grid, const FloatGrid& of) {
    grid.tree().topologyUnion(openvdb::tools::sdfInteriorMask(of)->tree());
}

/// The displacements from both frames to the moment that each place shows. Null: nothing moves.
struct Ways {
    VectorGrid::ConstPtr from_a, from_b;
    Transport transport = Transport::semi_lagrangian;
    bool alike = false;  ///< whether all places show one moment
};

/// The motion, multiplied by a number that differs from place to place.
VectorGrid::ConstPtr part_of(const VectorGrid& motion, const ShareAt& by) {
    const auto out = motion.deepCopy();
    out->tree().voxelizeActiveTiles();
    openvdb::tree::LeafManager<VectorGrid::TreeType> leaves(out->tree());
    leaves.foreach ([&](auto& leaf, std::size_t) {
        for (auto value = leaf.beginValueOn(); value; ++value)
            value.setValue(*value * static_cast<float>(by(out->indexToWorld(value.getCoord()))));
    });
    return out;
}

Ways ways_of(const VectorGrid* motion, const ShareAt& share, Transport transport, bool alike) {
    if (!motion) return {nullptr, nullptr, transport, alike};
    return {part_of(*motion, share),
            part_of(*motion, [&](const openvdb::Vec3d& world) { return share(world) - 1; }),
            transport, alike};
}

/// A frame's grid, and this grid moved to the moment that each place shows. Both may be null.
template <class GridT>
struct Side {
    const GridT* grid;
    typename GridT::Ptr matched;
    typename GridT::ConstPtr moved;

    /// @param like  grids of another transform are resampled to its voxels
    Side(const GridT* of, const GridT& like, const VectorGrid::ConstPtr& way, Transport transport)
        : grid(of) {
        if (!of) return;
        if (of->transform() != like.transform()) {
            matched = GridT::create(of->background());
            matched->setTransform(like.transform().copy());
            openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*of, *matched);
            grid = matched.get();
        }
        if (way) moved = advected(*grid, *way, 1, transport);
    }
    const GridT* shown() const { return moved ? moved.get() : grid; }
};

/// Values of a grid.
template <class GridT>
class ValuesOf {
public:
    /// @param of  null: nothing but the background
    ValuesOf(const GridT* of, const typename GridT::ValueType& background)
        : background_(background) {
        if (of) values_.emplace(of->getConstAccessor());
    }
    auto operator()(const openvdb::Coord& at) const {
        return values_ ? values_->getValue(at) : background_;
    }

private:
    typename GridT::ValueType background_;
    std::optional<typename GridT::ConstAccessor> values_;
};

/// Blends a float or vector grid of two frames, of which one may be null: then the other fades. A
/// level set can't fade: it appears where its frame is the nearer one.
template <class GridT>
class GridMix {
public:
    GridMix(const GridT* first, const GridT* second, const ShareAt& share, const Ways& ways)
        : header_(first ? *first : *second),
          a_(first, header_, ways.from_a, ways.transport),
          b_(second, header_, ways.from_b, ways.transport),
          share_(share),
          alone_(level_set() && !(first && second)),
          out_(header_.deepCopy()) {
        for (const GridT* const each : {a_.grid, b_.grid, a_.moved.get(), b_.moved.get()}) {
            if (!each) continue;
            out_->topologyUnion(*each);
            // Beyond the narrow bands, the sign alone tells the sides apart.
            if constexpr (floats)
                if (level_set()) activate_inside(*out_, *each);
        }
        out_->tree().voxelizeActiveTiles();
    }

    bool level_set() const { return header_.getGridClass() == openvdb::GRID_LEVEL_SET; }

    /// @return the mixed grid, and by what factor its sum falls short of what lies between the
    ///   frames; of vectors, not a number
    std::pair<typename GridT::Ptr, double> mix() {
        openvdb::tree::LeafManager<typename GridT::TreeType> leaves(out_->tree());
        std::vector<Sums> sums(leaves.leafCount());
        leaves.foreach ([&](auto& leaf, std::size_t n) { mix_leaf(leaf, sums[n]); });
        double wanted = 0, got = 0;
        for (const auto& each : sums) {
            wanted += each.wanted;
            got += each.got;
        }
        return {out_, wanted / got};
    }

private:
    static constexpr bool floats = std::is_same_v<GridT, FloatGrid>;
    using Value = typename GridT::ValueType;
    using Element = typename openvdb::VecTraits<Value>::ElementType;
    using Leaf = typename GridT::TreeType::LeafNodeType;

    /// Sums over the blended voxels of a leaf: the wanted one, and the actual one.
    struct Sums {
        double wanted = 0, got = 0;
    };

    void mix_leaf(Leaf& leaf, Sums& sums) const {
        const auto values = [&](const GridT* of) {
            return ValuesOf<GridT>(of, out_->background());
        };
        const auto old = values(a_.grid), now = values(b_.grid), old_moved = values(a_.shown()),
                   now_moved = values(b_.shown());
        for (auto value = leaf.beginValueOn(); value; ++value) {
            const auto at = value.getCoord();
            const auto part = static_cast<Element>(share_(out_->indexToWorld(at)));
            // One side alone keeps its bits.
            if (part == 0) value.setValue(old(at));
            else if (part == 1) value.setValue(now(at));
            else if (alone_) {
                if ((part < 0.5f) == (a_.grid != nullptr))
                    value.setValue(a_.grid ? old_moved(at) : now_moved(at));
                else value.setValue(out_->background());
            } else {
                const Value before = old_moved(at), after = now_moved(at);
                value.setValue(before == after ? before
                                               : Value(before * (1 - part) + after * part));
                if constexpr (floats) {
                    sums.wanted += double((1 - part) * old(at) + part * now(at));
                    sums.got += double(*value);
                }
            }
        }
    }

    const GridT& header_;
    const Side<GridT> a_, b_;
    const ShareAt& share_;
    const bool alone_;  ///< a level set that the other frame has not
    const typename GridT::Ptr out_;
};

/// A float or vector grid of two frames.
template <class GridT>
typename GridT::ConstPtr grid_mixed(const GridT* first, const GridT* second, const ShareAt& share,
                                    const Ways& ways) {
    GridMix<GridT> mixing(first, second, share, ways);
    const auto [out, by] = mixing.mix();
    if constexpr (std::is_same_v<GridT, FloatGrid>) {
        // A mean of distances is nearly a distance. Recomputed distances would move the surface.
        if (mixing.level_set()) return trim(*out), out;
        // Converging or diverging motion would make mass pulsate from frame to frame. Where
        // places show different moments, one factor for all would leave steps.
        if (ways.from_a && ways.alike && by > 0.5 && by < 2) multiply(*out, by);
    }
    openvdb::tools::deactivate(out->tree(), out->background());
    openvdb::tools::pruneInactive(out->tree());
    return out;
}

/// A grid of two frames whose values can't be mixed: each voxel is that of the nearer side.
template <class GridT>
openvdb::GridBase::ConstPtr grid_chosen(const GridT& a, const GridT& b, const ShareAt& share) {
    const auto out = a.deepCopy();
    out->topologyUnion(b);
    out->tree().voxelizeActiveTiles();
    openvdb::tree::LeafManager<typename GridT::TreeType> leaves(out->tree());
    leaves.foreach ([&](auto& leaf, std::size_t) {
        const auto old = a.getConstAccessor(), now = b.getConstAccessor();
        for (auto value = leaf.beginValueOn(); value; ++value) {
            const auto at = value.getCoord();
            const auto& side = share(out->indexToWorld(at)) < 0.5 ? old : now;
            if constexpr (!std::is_same_v<GridT, MaskGrid>) value.setValue(side.getValue(at));
            if (!side.isValueOn(at)) leaf.setActiveState(value.pos(), false);
        }
    });
    out->pruneGrid();
    return out;
}

/// The same of any type that can be carved; null: of others, or of two types.
openvdb::GridBase::ConstPtr grid_chosen(const openvdb::GridBase::ConstPtr& a,
                                        const openvdb::GridBase::ConstPtr& b,
                                        const ShareAt& share) {
    openvdb::GridBase::ConstPtr out;
#define FLUIDCARVE_TRY(GridT)                                                                     \
    if (a->isType<GridT>() && b->isType<GridT>())                                                 \
        out = grid_chosen(*openvdb::GridBase::grid<GridT>(a), *openvdb::GridBase::grid<GridT>(b), \
                          share);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    return out;
}

/// A picture's channel, made pixel by pixel. @param value  by x and y
template <class Value>
ChannelPixels picture(const openvdb::CoordBBox& box, const Value& value) {
    const auto width = box.dim().x();
    const auto values = std::make_shared<std::vector<float>>(box.volume());
    tbb::parallel_for(0, box.dim().y(), [&](int row) {
        for (int column = 0; column < width; ++column)
            (*values)[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column)] =
                value(box.min().x() + column, box.min().y() + row);
    });
    return {box, box, std::shared_ptr<const float>(values, values->data()), 1, width};
}

/// The value between pixels: bilinear, the rim is repeated beyond. If the result is not finite,
/// the nearest pixel.
float sample(const ChannelPixels& pixels, double x, double y) {
    const auto &low = pixels.box.min(), &high = pixels.box.max();
    x = std::clamp(x, double(low.x()), double(high.x()));
    y = std::clamp(y, double(low.y()), double(high.y()));
    const int left = static_cast<int>(std::floor(x)), down = static_cast<int>(std::floor(y)),
              right = std::min(left + 1, high.x()), up = std::min(down + 1, high.y());
    const auto across = static_cast<float>(x - left), along = static_cast<float>(y - down);
    const auto line = [&](int row) {
        return (1 - across) * pixels.at(left, row) + across * pixels.at(right, row);
    };
    const float out = (1 - along) * line(down) + along * line(up);
    return std::isfinite(out) ? out
                              : pixels.at(across < 0.5f ? left : right, along < 0.5f ? down : up);
}

/// Blends a picture's channel of two frames, as grid_mixed(); but the rim is repeated beyond it.
/// @param motion  null: nothing moves
ChannelPixels picture_mixed(const ChannelPixels& a, const ChannelPixels& b, const ShareAt& share,
                            const VectorGrid* motion, const openvdb::math::Transform& transform) {
    const double voxel = transform.voxelSize().x();
    const int z = a.box.min().z();
    return picture(a.box, [&](int x, int y) {
        const double part = share(transform.indexToWorld(openvdb::Coord(x, y, z)));
        if (part == 0) return a.at(x, y);
        if (part == 1) return b.at(x, y);
        const auto way = [&](double at_x, double at_y) {
            return motion ? openvdb::Vec3d(openvdb::tools::BoxSampler::sample(
                                motion->constTree(), openvdb::Vec3d(at_x, at_y, z))) /
                                voxel
                          : openvdb::Vec3d(0);
        };
        const auto at = [&](const ChannelPixels& pixels, double time) {
            const auto first = way(x, y),
                       middle = way(x - 0.5 * time * first.x(), y - 0.5 * time * first.y());
            return sample(pixels, x - time * middle.x(), y - time * middle.y());
        };
        const float before = at(a, part), after = at(b, part - 1);
        if (before == after) return before;
        const auto out = static_cast<float>((1 - part) * before + part * after);
        return std::isfinite(out) ? out : part < 0.5 ? before : after;
    });
}

/// Blends two volumes, by a share of the second that differs from place to place.
/// @param nearer  `a` or `b`: its grids are those of the result
/// @param motion  from `a` to `b`; null: nothing moves
/// @param points  mixes the points of both
template <class MixPoints>
Volume mixed(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
             const VectorGrid* motion, Transport transport, bool alike, const MixPoints& points) {
    const auto ways = ways_of(motion, share, transport, alike);
    const auto first = a.unique_names(), second = b.unique_names(), names = nearer.unique_names();
    const auto in = [](const Volume& volume, const std::vector<std::string>& all,
                       const std::string& name) {
        const auto found = std::ranges::find(all, name);
        return found == all.end() ? VolumeGrid()
                                  : volume.grids[static_cast<std::size_t>(found - all.begin())];
    };
    auto out = nearer;
    for (std::size_t n = 0; n < out.grids.size(); ++n) {
        auto& each = out.grids[n];
        const auto before = in(a, first, names[n]), after = in(b, second, names[n]);
        const auto mix = [&]<class GridT>(const GridT*) {
            const auto old = before ? openvdb::gridConstPtrCast<GridT>(before.grid()) : nullptr,
                       now = after ? openvdb::gridConstPtrCast<GridT>(after.grid()) : nullptr;
            each = each.holding(grid_mixed(old.get(), now.get(), share, ways));
        };
        if (each.header().isType<FloatGrid>()) {
            if (before && after && before.pixels() && after.pixels() &&
                before.pixels()->box == after.pixels()->box)
                each = VolumeGrid(each.header().copyGridWithNewTree(),
                                  picture_mixed(*before.pixels(), *after.pixels(), share, motion,
                                                each.header().transform()));
            else mix(static_cast<const FloatGrid*>(nullptr));
        } else if (each.header().isType<VectorGrid>()) mix(static_cast<const VectorGrid*>(nullptr));
        else if (is_point_grid(each.header()) && before && after)
            each = each.holding(points(points_in(before), points_in(after)).grid);
        // With one moment for all places, the grid is that of the nearer frame, unchanged.
        else if (!alike && before && after &&
                 before.header().transform() == after.header().transform())
            if (const auto chosen = grid_chosen(before.grid(), after.grid(), share))
                each = each.holding(chosen);
    }
    return out;
}

/// volume_between(). @param alike  whether all places show one moment
Volume between(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
               const VectorGrid* motion, Transport transport, bool alike) {
    return mixed(a, b, share, nearer, motion, transport, alike,
                 [&](const Points& old, const Points& now) {
                     const auto name = velocity_name(old);
                     return points_between(old, now, share, &nearer == &a ? old : now,
                                           {name, name.empty() ? 0 : point_scale(old, now, name)});
                 });
}

}  // namespace

Volume volume_between(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                      const VectorGrid* motion, Transport transport) {
    return between(a, b, share, nearer, motion, transport, false);
}

Volume volume_between(const Volume& a, const Volume& b, double share, const VectorGrid* motion,
                      Transport transport) {
    return between(
        a, b, [share](const openvdb::Vec3d&) { return share; }, share < 0.5 ? a : b, motion,
        transport, true);
}

Volume volume_mixed(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                    const ShareAt& of_points) {
    return mixed(a, b, share, nearer, nullptr, Transport::semi_lagrangian, false,
                 [&](const Points& old, const Points& now) {
                     return points_mixed(old, now, of_points ? of_points : share,
                                         &nearer == &a ? old : now);
                 });
}

Volume velocities_scaled(const Volume& volume, const std::string& name, double by) {
    auto out = volume;
    if (by == 1) return out;
    for (auto& grid : out.grids)
        if (grid.name() == name && grid.header().isType<VectorGrid>()) {
            const auto copy = openvdb::gridConstPtrCast<VectorGrid>(grid)->deepCopy();
            multiply(*copy, by);
            grid = copy;
        } else if (is_point_grid(grid.header())) {
            grid = grid.holding(
                paced(points_in(grid), [&](const openvdb::Vec3d&) { return by; }).grid);
        }
    return out;
}

}  // namespace fluidcarve
