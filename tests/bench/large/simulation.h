#pragma once

#include "tests/bench/large/cells.h"

#include <map>
#include <string>

/// A simulation as it is stored, at any time: fields in the box around the content of all frames.
class Simulation {
public:
    /// Cells that smoke moves in a frame, for each unit of a stored velocity: measured.
    static constexpr float cells_per_unit = 0.08f;

    struct Moment {
        Cells<float> density, flame;     ///< flame: no cells if there is none
        Cells<openvdb::Vec3f> velocity;  ///< cells per frame
    };

    /// Looks at all frames. Particles without a density count as water: what fills a cell has
    /// density 1.
    /// @param files  a path with `####`, as Blender writes them: velocities staggered, a frame
    ///   apart
    /// @throws std::runtime_error, Failure if there are no such files, or one has no density or
    ///   velocity
    explicit Simulation(const std::string& files);

    const openvdb::CoordBBox& box() const { return box_; }  ///< cells of the files
    double voxel() const { return voxel_; }                 ///< world units
    double last() const { return last_ - first_; }  ///< time of the last frame; the first is at 0

    /// Between two frames, what each shows is moved along its flow, and mixed.
    Moment at(double time);

private:
    const Moment& frame(int number);

    std::string before_, after_;
    int digits_ = 0, first_ = 0, last_ = 0;
    double voxel_ = 0;
    openvdb::CoordBBox box_;
    std::map<int, Moment> kept_;  ///< two at most
};
