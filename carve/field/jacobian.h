#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Turns differences between neighbouring voxels into derivatives in world space, by the inverse
/// of the transform's linear part. Voxels may be rotated, mirrored, sheared or stretched.
class Jacobian {
public:
    /// @throws Failure naming the grid if its voxels differ in shape (a frustum)
    explicit Jacobian(const openvdb::GridBase& grid);

    /// @param differences  between the two neighbours along each index axis, two voxels apart
    /// @return the gradient, per world unit
    openvdb::Vec3s gradient(const openvdb::Vec3s& differences) const {
        return plain_ ? half_ * differences : openvdb::Vec3s(0.5 * (by_world_ * differences));
    }
    /// Length of the gradient, per world unit. For cubic voxels, rotating the grid does not change
    /// a bit of it.
    double steepness(const openvdb::Vec3s& differences) const {
        const openvdb::Vec3d exact(differences);
        return cubes_ ? half_ * exact.length() : 0.5 * (by_world_ * exact).length();
    }
    /// @param x, y, z  differences of a vector field over two voxels along each index axis
    /// @return the curl, per world unit
    openvdb::Vec3s curl(const openvdb::Vec3s& x, const openvdb::Vec3s& y,
                        const openvdb::Vec3s& z) const {
        return plain_ ? half_ * rotation(x, y, z) : openvdb::Vec3s(0.5 * turned_curl(x, y, z));
    }
    /// @param by_voxel  second derivatives in index space, symmetric
    /// @return second derivatives in world space
    openvdb::Mat3d second(const openvdb::Mat3d& by_voxel) const {
        return by_world_ * by_voxel * by_world_.transpose();
    }
    /// @param by_voxel  first derivatives in index space
    /// @return first derivatives in world space
    openvdb::Vec3d first(const openvdb::Vec3d& by_voxel) const { return by_world_ * by_voxel; }

    /// Weights of the index-space second derivatives in the Laplacian, 1 / square world unit.
    /// Exactly 0 off the diagonal if the voxels are cubes along the world's axes.
    openvdb::Mat3d metric() const { return by_world_.transpose() * by_world_; }

    /// Cube root of a voxel's volume, world units.
    double edge() const { return edge_; }

private:
    template <class Vec>
    static Vec rotation(const Vec& x, const Vec& y, const Vec& z) {
        return {y[2] - z[1], z[0] - x[2], x[1] - y[0]};
    }
    openvdb::Vec3d turned_curl(const openvdb::Vec3s& x, const openvdb::Vec3s& y,
                               const openvdb::Vec3s& z) const {
        const auto along = [&](int n) {
            return by_world_(n, 0) * openvdb::Vec3d(x) + by_world_(n, 1) * openvdb::Vec3d(y) +
                   by_world_(n, 2) * openvdb::Vec3d(z);
        };
        return rotation(along(0), along(1), along(2));
    }

    openvdb::Mat3d by_world_;  ///< voxels per world unit; (n, i) is the step in index coordinate i
                               ///< for a step along world axis n
    double edge_ = 0;
    bool cubes_ = false;
    bool plain_ = false;  ///< cubes along the world's axes
    float half_ = 0;      ///< 1 / (2 edge), used for cubic voxels
};

}  // namespace fluidcarve
