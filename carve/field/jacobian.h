#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Turns differences between neighbouring voxels into derivatives by place: the inverse of a
/// transform's linear part, whatever voxels it makes: turned, mirrored, sheared or longer along one
/// axis.
class Jacobian {
public:
    /// @throws Failure naming the grid if its voxels differ in shape (a frustum)
    explicit Jacobian(const openvdb::GridBase& grid);

    /// @param differences  of the neighbours on both sides along each index axis: over two voxels
    /// @return the gradient, per world unit
    openvdb::Vec3s gradient(const openvdb::Vec3s& differences) const {
        return plain_ ? half_ * differences : openvdb::Vec3s(0.5 * (by_world_ * differences));
    }
    /// Length of the gradient, per world unit. Of cubes it does not depend on how they are turned,
    /// to the last bit.
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
    /// @param by_voxel  second derivatives by voxels, symmetric
    /// @return second derivatives by world units
    openvdb::Mat3d second(const openvdb::Mat3d& by_voxel) const {
        return by_world_ * by_voxel * by_world_.transpose();
    }
    /// @param by_voxel  first derivatives by voxels
    /// @return first derivatives by world units
    openvdb::Vec3d first(const openvdb::Vec3d& by_voxel) const { return by_world_ * by_voxel; }

    /// The weights of second derivatives by voxels in the Laplacian, 1 / square world unit. Exactly
    /// 0 off the diagonal for plain voxels.
    openvdb::Mat3d metric() const { return by_world_.transpose() * by_world_; }

    /// Edge of a cube as large as a voxel, world units.
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

    openvdb::Mat3d by_world_;  ///< voxels per world unit: (n, i) is how far index axis i goes for a
                               ///< step along world axis n
    double edge_ = 0;
    bool cubes_ = false;
    bool plain_ = false;  ///< cubes along the world's axes
    float half_ = 0;      ///< of cubes: 1 / (2 edge)
};

}  // namespace fluidcarve
