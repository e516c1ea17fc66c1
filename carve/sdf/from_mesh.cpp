#include "carve/sdf/from_mesh.h"

#include "carve/base/failure.h"
#include "carve/mesh/edges.h"
#include "carve/mesh/made_once.h"
#include "carve/mesh/triangles.h"

#include <fmt/format.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Vec3I;
using openvdb::Vec3s;

constexpr double most_voxels = 1e9;

/// Maximum distance from the origin, voxels: floats still resolve half a voxel there.
constexpr double farthest = 1 << 22;

/// Upper bound on the number of voxels in a band around triangles. All lengths in voxels.
class BandSize {
public:
    /// @param band  half width of the band
    explicit BandSize(double band) : band_(band), edge_(8 * band) {}

    void add(const Vec3s& a, const Vec3s& b, const Vec3s& c) {
        openvdb::BBoxd box;
        for (const auto& corner : {a, b, c}) box.expand(openvdb::Vec3d(corner));
        all_.expand(box);
        // Volume around a triangle (Steiner's formula): slabs on both sides, half cylinders around
        // edges, parts of balls around corners.
        const double perimeter = (b - a).length() + (c - b).length() + (a - c).length(),
                     area = 0.5 * (b - a).cross(c - a).length();
        const double sum = 2 * band_ * area + 0.5 * pi * band_ * band_ * perimeter +
                           4.0 / 3 * pi * std::pow(band_, 3);
        if (box.extents()[box.maxExtent()] > edge_) {
            large_ += sum;
            return;
        }
        auto& cell = cells_[openvdb::Coord::floor(openvdb::Vec3d(a) / edge_)];
        cell.box.expand(box);
        cell.sum += sum;
    }

    /// The bound. Bands of small triangles overlap: the triangles of a cell together count at most
    /// as their bounding box.
    double voxels() const {
        double out = large_;
        for (const auto& [at, cell] : cells_) out += std::min(cell.sum, grown(cell.box));
        return out > 0 ? std::min(out, grown(all_)) : 0;
    }

private:
    struct Cell {
        openvdb::BBoxd box;
        double sum = 0;
    };
    static constexpr double pi = openvdb::math::pi<double>();

    double grown(const openvdb::BBoxd& box) const {
        const auto size = box.extents() + openvdb::Vec3d(2 * band_);
        return size.x() * size.y() * size.z();
    }

    double band_, edge_, large_ = 0;
    openvdb::BBoxd all_;
    std::map<openvdb::Coord, Cell> cells_;
};

/// The mesh as triangles in the grid's index space.
struct Triangles {
    std::vector<Vec3s> points;
    std::vector<Vec3I> corners;

    Triangles(const Mesh& mesh, const openvdb::math::Transform& transform, double band) {
        points.reserve(mesh.points.size());
        double reach = 0;
        for (const auto& point : mesh.points) {
            const auto at = transform.worldToIndex(point);
            for (int c = 0; c < 3; ++c)
                if (!(std::abs(at[c]) <= reach) && !std::isnan(reach))
                    reach = std::abs(at[c]);  // stays NaN if the position is NaN
            points.emplace_back(at);
        }
        if (!(reach <= farthest))
            throw Failure(
                fmt::format("the mesh reaches {:.3g} voxels away from the grid's origin; {:.0f} is "
                            "the most: choose larger voxels",
                            reach, farthest));
        std::vector<std::array<std::uint32_t, 3>> parts;
        BandSize size(band);
        for (std::size_t n = 0; n < mesh.faces(); ++n) {
            triangulate(mesh.points, mesh.face(n), parts);
            for (const auto& [a, b, c] : parts) {
                corners.emplace_back(a, b, c);
                size.add(points[a], points[b], points[c]);
            }
        }
        if (const double voxels = size.voxels(); !(voxels <= most_voxels))
            throw Failure(
                fmt::format("the band around the mesh's faces may take {:.1e} voxels, more than "
                            "{:.0e}; choose larger voxels, or a narrower band",
                            voxels, most_voxels));
    }
};

FloatGrid::Ptr distance(const Mesh& mesh, const openvdb::math::Transform& transform, double band,
                        int flags) {
    const Triangles triangles(mesh, transform, band);
    const openvdb::tools::QuadAndTriangleDataAdapter<Vec3s, Vec3I> faces(triangles.points,
                                                                         triangles.corners);
    openvdb::util::NullInterrupter uninterrupted;
    const auto width = static_cast<float>(band);
    const auto out = openvdb::tools::meshToVolume<FloatGrid>(uninterrupted, faces, transform, width,
                                                             width, flags);
    out->setName("surface");
    return out;
}

}  // namespace

FloatGrid::Ptr mesh_distance_unsigned(const Mesh& mesh, const openvdb::math::Transform& transform,
                                      double band) {
    const auto out = distance(mesh, transform, band, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    out->setGridClass(openvdb::GRID_UNKNOWN);
    return out;
}

FloatGrid::Ptr mesh_distance(const Mesh& mesh, const openvdb::math::Transform& transform,
                             double band, std::optional<double> thickness) {
    if (!thickness) {
        if (boundary_edges(mesh) > 0) return mesh_distance_unsigned(mesh, transform, band);
        const auto out = distance(mesh, transform, band, 0);
        out->setGridClass(openvdb::GRID_LEVEL_SET);
        return out;
    }
    const double voxel = transform.voxelSize().x();
    const auto half = static_cast<float>(0.5 * *thickness),
               background = static_cast<float>(band * voxel);
    const auto around = mesh_distance_unsigned(mesh, transform, band + half / voxel);
    const auto tree =
        std::make_shared<openvdb::FloatTree>(around->tree(), background, openvdb::TopologyCopy());
    openvdb::tree::LeafManager<openvdb::FloatTree>(*tree).foreach (
        [&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
            const auto* const from = around->tree().probeConstLeaf(leaf.origin());
            for (auto voxels = leaf.beginValueOn(); voxels; ++voxels) {
                const float value = from->getValue(voxels.pos()) - half;
                voxels.setValue(std::clamp(value, -background, background));
                if (std::abs(value) >= background) voxels.setValueOff();
            }
        });
    openvdb::tools::pruneLevelSet(*tree);
    auto out = FloatGrid::create(tree);
    out->setTransform(transform.copy());
    out->setGridClass(openvdb::GRID_LEVEL_SET);
    out->setName("surface");
    return out;
}

}  // namespace fluidcarve
