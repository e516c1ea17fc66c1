#include "carve/time/between.h"

#include "carve/time/advect.h"

#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetTracker.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/ValueTransformer.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cstddef>
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

void renormalize(FloatGrid& grid) {
    openvdb::tools::LevelSetTracker<FloatGrid> tracker(grid);
    tracker.setNormCount(3);
    tracker.normalize();
    tracker.prune();
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
        if (level_set) return renormalize(*out), out;
        // Motion that converges or diverges would make the mass pulsate from frame to frame.
        const double wanted = (a ? (1 - share) * sum_of(*a) : 0) + (b ? share * sum_of(*b) : 0),
                     by = wanted / sum_of(*out);
        if (by > 0.5 && by < 2) multiply(*out, by);
    }
    openvdb::tools::deactivate(out->tree(), out->background());
    openvdb::tools::pruneInactive(out->tree());
    return out;
}

/// A float or vector grid of two frames, of which one may be null: then the other fades.
template <class GridT>
typename GridT::ConstPtr grid_mixed(const GridT* a, const GridT* b,
                                    const std::function<double(const openvdb::Vec3d&)>& share) {
    const auto& first = a ? *a : *b;
    const auto out = first.deepCopy();
    const bool alike = a && b && a->transform() == b->transform();
    if (alike) out->topologyUnion(*b);
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
        if (first.getGridClass() == openvdb::GRID_LEVEL_SET) return renormalize(*out), out;
    openvdb::tools::deactivate(out->tree(), out->background());
    openvdb::tools::pruneInactive(out->tree());
    return out;
}

/// The grids of one of two volumes, the floats and vectors among them mixed of both.
/// @param mix  makes a grid of two of one type, of which one may be null
template <class Mix>
Volume paired(const Volume& a, const Volume& b, const Volume& nearer, const Mix& mix) {
    const auto first = a.unique_names(), second = b.unique_names(), names = nearer.unique_names();
    const auto in = [](const Volume& volume, const std::vector<std::string>& all,
                       const std::string& name) {
        const auto found = std::ranges::find(all, name);
        return found == all.end()
                   ? openvdb::GridBase::ConstPtr()
                   : volume.grids[static_cast<std::size_t>(found - all.begin())].grid();
    };
    auto out = nearer;
    for (std::size_t n = 0; n < out.grids.size(); ++n) {
        const auto before = in(a, first, names[n]), after = in(b, second, names[n]);
        const auto mixed = [&]<class GridT>(const GridT*) {
            const auto old = openvdb::gridConstPtrCast<GridT>(before),
                       now = openvdb::gridConstPtrCast<GridT>(after);
            out.grids[n] = out.grids[n].holding(mix(old.get(), now.get()));
        };
        if (out.grids[n].header().isType<FloatGrid>())
            mixed(static_cast<const FloatGrid*>(nullptr));
        else if (out.grids[n].header().isType<VectorGrid>())
            mixed(static_cast<const VectorGrid*>(nullptr));
    }
    return out;
}

}  // namespace

Volume volume_between(const Volume& a, const Volume& b, double share, const VectorGrid* motion,
                      Transport transport) {
    return paired(a, b, share < 0.5 ? a : b, [&](const auto* old, const auto* now) {
        return grid_between(old, now, share, motion, transport);
    });
}

Volume volume_mixed(const Volume& a, const Volume& b,
                    const std::function<double(const openvdb::Vec3d&)>& share,
                    const Volume& nearer) {
    return paired(a, b, nearer,
                  [&](const auto* old, const auto* now) { return grid_mixed(old, now, share); });
}

Volume scaled(const Volume& volume, const std::string& name, double by) {
    auto out = volume;
    for (auto& grid : out.grids)
        if (by != 1 && grid.name() == name && grid.header().isType<VectorGrid>()) {
            const auto copy = openvdb::gridConstPtrCast<VectorGrid>(grid)->deepCopy();
            multiply(*copy, by);
            grid = copy;
        }
    return out;
}

}  // namespace fluidcarve
