#include "carve/time/between.h"

#include "carve/points/point_vectors.h"
#include "carve/stream/openvdb_types.h"
#include "carve/time/advect.h"
#include "carve/time/points_between.h"
#include "carve/volume/grid_types.h"

#include <openvdb/tools/Activate.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Composite.h>
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
#include <tuple>
#include <type_traits>
#include <vector>

namespace fluidcarve {
namespace {

/// Multiplies all values, the background too.
template <class GridT>
void multiply(GridT& grid, double by) {
    using Element = typename openvdb::VecTraits<typename GridT::ValueType>::ElementType;
    openvdb::tools::foreach (grid.beginValueAll(), [by](const auto& value) {
        value.setValue(*value * static_cast<Element>(by));
    });
    openvdb::tools::changeBackground(
        grid.tree(), typename GridT::ValueType(grid.background() * static_cast<Element>(by)));
}

template <class GridT>
typename GridT::Ptr moved(const GridT& grid, const VectorGrid* motion, double time,
                          Transport transport) {
    return motion && time != 0 ? advected(grid, *motion, time, transport == Transport::mac_cormack)
                               : grid.deepCopy();
}

double sum_of(const FloatGrid& grid) {
    double out = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value)
        out += static_cast<double>(*value) * static_cast<double>(value.getVoxelCount());
    return out;
}

/// Ends the narrow band of a level set where its distances do.
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

/// A float or vector grid between two of its frames, of which one may be null: then the other
/// fades.
template <class GridT>
typename GridT::ConstPtr grid_between(const GridT* a, const GridT* b, double share,
                                      const VectorGrid* motion, Transport transport) {
    const auto& first = a ? *a : *b;
    const bool level_set = first.getGridClass() == openvdb::GRID_LEVEL_SET;
    typename GridT::Ptr out;
    for (const auto& [grid, time, weight] :
         {std::tuple(a, share, 1 - share), std::tuple(b, share - 1, share)}) {
        if (!grid) continue;
        auto part = moved(*grid, motion, time, transport);
        // A distance can't fade.
        if (!level_set || (a && b)) multiply(*part, weight);
        if (part->transform() != first.transform()) {
            const auto matched = GridT::create(part->background());
            matched->setTransform(first.transform().copy());
            openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*part, *matched);
            part = matched;
        }
        if (out) openvdb::tools::compSum(*out, *part);
        else out = part;
    }
    if constexpr (std::is_same_v<GridT, FloatGrid>) {
        // A mean of distances is nearly one. Distances made anew would move the surface.
        if (level_set) return trim(*out), out;
        // Motion that converges or diverges would make the mass pulsate from frame to frame.
        const double wanted = (a ? (1 - share) * sum_of(*a) : 0) + (b ? share * sum_of(*b) : 0),
                     by = wanted / sum_of(*out);
        if (by > 0.5 && by < 2) multiply(*out, by);
    }
    openvdb::tools::deactivate(out->tree(), out->background());
    openvdb::tools::pruneInactive(out->tree());
    return out;
}

/// Activates what lies inside of a level set, down to voxels.
void activate_inside(FloatGrid& grid, const FloatGrid& of) {
    grid.tree().topologyUnion(openvdb::tools::sdfInteriorMask(of)->tree());
}

/// A float or vector grid of two frames, of which one may be null: then the other fades.
template <class GridT>
typename GridT::ConstPtr grid_mixed(const GridT* a, const GridT* b,
                                    const std::function<double(const openvdb::Vec3d&)>& share) {
    const auto& first = a ? *a : *b;
    const auto out = first.deepCopy();
    const bool alike = a && b && a->transform() == b->transform();
    if (alike) out->topologyUnion(*b);
    if constexpr (std::is_same_v<GridT, FloatGrid>)
        // Beyond the narrow bands, the sign alone tells the sides apart.
        if (alike && first.getGridClass() == openvdb::GRID_LEVEL_SET) {
            activate_inside(*out, *a);
            activate_inside(*out, *b);
        }
    out->tree().voxelizeActiveTiles();
    using Value = typename GridT::ValueType;
    using Element = typename openvdb::VecTraits<Value>::ElementType;
    const auto nothing = first.background();
    openvdb::tree::LeafManager<typename GridT::TreeType> leaves(out->tree());
    leaves.foreach ([&](auto& leaf, std::size_t) {
        std::optional<typename GridT::ConstAccessor> old, now;
        if (a) old.emplace(a->getConstAccessor());
        if (b) now.emplace(b->getConstAccessor());
        for (auto value = leaf.beginValueOn(); value; ++value) {
            const auto at = value.getCoord();
            const auto world = out->indexToWorld(at);
            const auto part = static_cast<Element>(share(world));
            const Value before = a ? old->getValue(at) : nothing;
            const Value after =
                !b            ? nothing
                : alike || !a ? now->getValue(at)
                              : openvdb::tools::BoxSampler::sample(*now, b->worldToIndex(world));
            // One side alone keeps its bits.
            if (part == 0 || before == after) value.setValue(before);
            else if (part == 1) value.setValue(after);
            else value.setValue(Value(before * (1 - part) + after * part));
        }
    });
    if constexpr (std::is_same_v<GridT, FloatGrid>)
        if (first.getGridClass() == openvdb::GRID_LEVEL_SET) return trim(*out), out;
    openvdb::tools::deactivate(out->tree(), out->background());
    openvdb::tools::pruneInactive(out->tree());
    return out;
}

/// A grid of two frames whose values can't be mixed: each voxel is that of the nearer side.
template <class GridT>
typename GridT::ConstPtr grid_chosen(const GridT& a, const GridT& b,
                                     const std::function<double(const openvdb::Vec3d&)>& share) {
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

/// A picture's channel, made pixel by pixel. @param value  by x and y
template <class Value>
Plane picture(const openvdb::CoordBBox& box, const Value& value) {
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

/// A pixel between pixels: bilinear, held beyond the rim. Where one is not finite, the nearest.
float sample(const Plane& plane, double x, double y) {
    const auto &low = plane.box.min(), &high = plane.box.max();
    x = std::clamp(x, double(low.x()), double(high.x()));
    y = std::clamp(y, double(low.y()), double(high.y()));
    const int left = static_cast<int>(std::floor(x)), down = static_cast<int>(std::floor(y)),
              right = std::min(left + 1, high.x()), up = std::min(down + 1, high.y());
    const auto across = static_cast<float>(x - left), along = static_cast<float>(y - down);
    const auto line = [&](int row) {
        return (1 - across) * plane.at(left, row) + across * plane.at(right, row);
    };
    const float out = (1 - along) * line(down) + along * line(up);
    return std::isfinite(out) ? out
                              : plane.at(across < 0.5f ? left : right, along < 0.5f ? down : up);
}

/// A picture's channel between two frames, as grid_between(); but what lies beyond the rim is what
/// lies there.
Plane picture_between(const Plane& a, const Plane& b, double share, const VectorGrid* motion,
                      const openvdb::math::Transform& transform) {
    const double voxel = transform.voxelSize().x();
    const int z = a.box.min().z();
    return picture(a.box, [&](int x, int y) {
        const auto way = [&](double at_x, double at_y) {
            return motion ? openvdb::Vec3d(openvdb::tools::BoxSampler::sample(
                                motion->constTree(), openvdb::Vec3d(at_x, at_y, z))) /
                                voxel
                          : openvdb::Vec3d(0);
        };
        const auto at = [&](const Plane& plane, double time) {
            const auto first = way(x, y),
                       middle = way(x - 0.5 * time * first.x(), y - 0.5 * time * first.y());
            return sample(plane, x - time * middle.x(), y - time * middle.y());
        };
        const float before = at(a, share), after = at(b, share - 1);
        const auto out = static_cast<float>((1 - share) * before + share * after);
        return std::isfinite(out) ? out : share < 0.5 ? before : after;
    });
}

/// The grids of one of two volumes, the floats and vectors among them mixed of both.
/// @param mix      makes a grid of two of one type, of which one may be null
/// @param choose   makes a grid of two, of which none is null, whose values can't be mixed
/// @param picture  makes a picture's channel of two
/// @param points   makes points of two
template <class Mix, class Choose, class Picture, class MixPoints>
Volume paired(const Volume& a, const Volume& b, const Volume& nearer, const Mix& mix,
              const Choose& choose, const Picture& picture, const MixPoints& points) {
    const auto first = a.unique_names(), second = b.unique_names(), names = nearer.unique_names();
    const auto in = [](const Volume& volume, const std::vector<std::string>& all,
                       const std::string& name) {
        const auto found = std::ranges::find(all, name);
        return found == all.end() ? VolumeGrid()
                                  : volume.grids[static_cast<std::size_t>(found - all.begin())];
    };
    auto out = nearer;
    for (std::size_t n = 0; n < out.grids.size(); ++n) {
        auto& held = out.grids[n];
        const auto before = in(a, first, names[n]), after = in(b, second, names[n]);
        const auto mixed = [&]<class GridT>(const GridT*) {
            const auto old = before ? openvdb::gridConstPtrCast<GridT>(before.grid()) : nullptr,
                       now = after ? openvdb::gridConstPtrCast<GridT>(after.grid()) : nullptr;
            held = held.holding(mix(old.get(), now.get()));
        };
        if (held.header().isType<FloatGrid>()) {
            if (before && after && before.plane() && after.plane() &&
                before.plane()->box == after.plane()->box)
                held =
                    VolumeGrid(held.header().copyGridWithNewTree(),
                               picture(*before.plane(), *after.plane(), held.header().transform()));
            else mixed(static_cast<const FloatGrid*>(nullptr));
        } else if (held.header().isType<VectorGrid>())
            mixed(static_cast<const VectorGrid*>(nullptr));
        else if (is_point_grid(held.header()) && before && after)
            held = held.holding(points(points_in(before), points_in(after)).grid);
        else if (before && after && before.header().transform() == after.header().transform())
            if (const auto chosen = choose(before.grid(), after.grid()))
                held = held.holding(chosen);
    }
    return out;
}

}  // namespace

Volume volume_between(const Volume& a, const Volume& b, double share, const VectorGrid* motion,
                      Transport transport) {
    return paired(
        a, b, share < 0.5 ? a : b,
        [&](const auto* old, const auto* now) {
            return grid_between(old, now, share, motion, transport);
        },
        [](const auto&, const auto&) { return openvdb::GridBase::ConstPtr(); },
        [&](const Plane& old, const Plane& now, const openvdb::math::Transform& place) {
            return picture_between(old, now, share, motion, place);
        },
        [&](const Points& old, const Points& now) {
            const auto name = velocity_name(old);
            return points_between(old, now, share,
                                  {name, name.empty() ? 0 : point_scale(old, now, name)});
        });
}

Volume volume_mixed(const Volume& a, const Volume& b, const ShareAt& share, const Volume& nearer,
                    const ShareAt& of_points) {
    return paired(
        a, b, nearer, [&](const auto* old, const auto* now) { return grid_mixed(old, now, share); },
        [&](const openvdb::GridBase::ConstPtr& old, const openvdb::GridBase::ConstPtr& now) {
            openvdb::GridBase::ConstPtr out;
#define FLUIDCARVE_TRY(GridT)                                   \
    if (old->isType<GridT>() && now->isType<GridT>())           \
        out = grid_chosen(*openvdb::GridBase::grid<GridT>(old), \
                          *openvdb::GridBase::grid<GridT>(now), share);
            FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
            return out;
        },
        [&](const Plane& old, const Plane& now, const openvdb::math::Transform& place) {
            const int z = old.box.min().z();
            return picture(old.box, [&](int x, int y) {
                const auto part =
                    static_cast<float>(share(place.indexToWorld(openvdb::Coord(x, y, z))));
                const float before = old.at(x, y), after = now.at(x, y);
                if (part == 0 || before == after) return before;
                return part == 1 ? after : before * (1 - part) + after * part;
            });
        },
        [&](const Points& old, const Points& now) {
            return points_mixed(old, now, of_points ? of_points : share, &nearer == &a ? old : now);
        });
}

Volume scaled(const Volume& volume, const std::string& name, double by) {
    auto out = volume;
    if (by == 1) return out;
    for (auto& grid : out.grids)
        if (grid.name() == name && grid.header().isType<VectorGrid>()) {
            const auto copy = openvdb::gridConstPtrCast<VectorGrid>(grid)->deepCopy();
            multiply(*copy, by);
            grid = copy;
        } else if (is_point_grid(grid.header())) {
            const auto points = points_in(grid);
            const auto attribute = velocity_name(points);
            auto velocities = vectors_of(points, attribute);
            for (auto& velocity : velocities) velocity *= by;
            if (!velocities.empty())
                grid = grid.holding(with_vectors(points, attribute, velocities).grid);
        }
    return out;
}

}  // namespace fluidcarve
