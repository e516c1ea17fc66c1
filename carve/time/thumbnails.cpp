#include "carve/time/thumbnails.h"

#include "carve/base/values.h"
#include "carve/field/collocate.h"
#include "carve/field/extent.h"
#include "carve/points/point_vectors.h"
#include "carve/stream/openvdb_types.h"
#include "carve/time/points_between.h"
#include "carve/time/sequence.h"

#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <cstddef>
#include <optional>

namespace fluidcarve {
namespace {

openvdb::Coord cube_of(const openvdb::Coord& voxel) {
    return {voxel.x() >> 2, voxel.y() >> 2, voxel.z() >> 2};
}

double square(float value) { return static_cast<double>(value) * value; }
double square(const openvdb::Vec3s& value) { return value.lengthSqr(); }

/// Sum of the squared differences of two trees.
template <class Tree>
double squared_difference(const Tree& a, const Tree& b) {
    double out = 0;
    for (auto value = a.cbeginValueOn(); value; ++value)
        out += square(typename Tree::ValueType(*value - b.getValue(value.getCoord())));
    for (auto value = b.cbeginValueOn(); value; ++value)
        if (!a.isValueOn(value.getCoord()))
            out += square(typename Tree::ValueType(*value - a.getValue(value.getCoord())));
    return out;
}

}  // namespace

void Thumbnails::add(const Volume& volume, const Ref<VectorGrid>& given) {
    auto& out = frames_.emplace_back();
    if (const auto grids = shown_in(volume, volume)) {
        const auto& shown = grids->first;
        const auto velocity = given ? collocated(given) : nullptr;
        openvdb::tree::ValueAccessor<openvdb::FloatTree> values(out.shown);
        openvdb::tree::ValueAccessor<openvdb::Vec3STree> momenta(out.momentum);
        std::optional<VectorGrid::ConstAccessor> velocities;
        if (velocity) velocities.emplace(velocity->getConstAccessor());
        for (auto value = shown->cbeginValueOn(); value; ++value) {
            if (!value.isVoxelValue() || !std::isfinite(*value)) continue;
            const auto cube = cube_of(value.getCoord());
            values.setValueOn(cube, values.getValue(cube) + *value);
            if (!velocity) continue;
            const auto at =
                near_place(velocity->worldToIndex(shown->indexToWorld(value.getCoord())));
            const auto moved =
                openvdb::Vec3s(*value * openvdb::tools::PointSampler::sample(*velocities, at));
            if (std::isfinite(moved.lengthSqr()))
                momenta.setValueOn(cube, momenta.getValue(cube) + moved);
        }
    } else add_points(volume, out);
    if (frames_.size() < 2) return;
    const auto now = squares(frames_[frames_.size() - 2], frames_.back());
    for (std::size_t n = 0; n < now.size(); ++n) typical_[n] += now[n];
}

void Thumbnails::add_points(const Volume& volume, Frame& to) {
    openvdb::tree::ValueAccessor<openvdb::FloatTree> counts(to.shown);
    openvdb::tree::ValueAccessor<openvdb::Vec3STree> momenta(to.momentum);
    for (const auto& each : volume.grids) {
        if (!is_point_grid(each.header())) continue;
        const auto points = points_in(each);
        if (!voxels_) voxels_ = points.grid->transform().copy();
        const auto positions = points.positions();
        const auto velocities = vectors_of(points, velocity_name(points));
        for (std::size_t n = 0; n < positions.size(); ++n) {
            const auto voxel = voxel_at(voxels_->worldToIndex(positions[n]));
            if (!voxel) continue;
            const auto cube = cube_of(*voxel);
            counts.setValueOn(cube, counts.getValue(cube) + 1);
            if (!velocities.empty() && openvdb::math::isFinite(velocities[n]))
                momenta.setValueOn(cube, momenta.getValue(cube) + openvdb::Vec3s(velocities[n]));
        }
    }
}

std::array<double, 2> Thumbnails::squares(const Frame& a, const Frame& b) const {
    return {squared_difference(a.shown, b.shown), squared_difference(a.momentum, b.momentum)};
}

double Thumbnails::difference(std::size_t a, std::size_t b) const {
    const auto parts = squares(frames_[a], frames_[b]);
    double sum = 0;
    int count = 0;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        if (typical_[n] == 0) continue;
        sum += parts[n] * static_cast<double>(frames_.size() - 1) / typical_[n];
        ++count;
    }
    return count == 0 ? 0 : std::sqrt(sum / count);
}

}  // namespace fluidcarve
