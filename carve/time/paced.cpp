#include "carve/time/paced.h"

#include "carve/points/point_vectors.h"
#include "carve/stream/openvdb_types.h"
#include "carve/volume/triplet.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/ValueTransformer.h>

#include <cstddef>

namespace fluidcarve {
namespace {

/// Multiplies the active values.
template <class GridT>
openvdb::GridBase::ConstPtr multiplied(const openvdb::GridBase::ConstPtr& base,
                                       const RateAt& rate) {
    using Value = typename GridT::ValueType;
    const auto grid = openvdb::gridConstPtrCast<GridT>(base);
    const auto out = grid->deepCopy();
    // A tile has one value, but the rate differs within it.
    out->tree().voxelizeActiveTiles();
    openvdb::tools::foreach (out->beginValueOn(), [&](const typename GridT::ValueOnIter& value) {
        value.setValue(Value(*value * rate(out->indexToWorld(value.getCoord()))));
    });
    out->pruneGrid();
    return out;
}

}  // namespace

Volume paced(const Volume& volume, const RateAt& rate) {
    auto out = volume;
    for (auto& each : out.grids) {
        const auto& header = each.header();
        if (is_point_grid(header)) each = each.holding(paced(points_in(each), rate).grid);
        else if (header.isType<openvdb::Vec3SGrid>())
            each = multiplied<openvdb::Vec3SGrid>(each, rate);
        else if (header.isType<openvdb::Vec3DGrid>())
            each = multiplied<openvdb::Vec3DGrid>(each, rate);
        else if (header.isType<FloatGrid>() && triplet_of(volume, header))
            each = multiplied<FloatGrid>(each, rate);
    }
    return out;
}

Points paced(const Points& points, const RateAt& rate) {
    const auto name = velocity_name(points);
    auto velocities = vectors_of(points, name);
    if (velocities.empty()) return points;
    const auto positions = points.positions();
    for (std::size_t n = 0; n < velocities.size(); ++n) velocities[n] *= rate(positions[n]);
    return with_vectors(points, name, velocities);
}

}  // namespace fluidcarve
