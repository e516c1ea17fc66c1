#pragma once

#include "carve/rig/rig.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Walks along a rig.
class Path {
public:
    /// A place on the path. In a closed rig, `piece` goes on counting in the next round.
    struct Place {
        std::size_t piece = 0;
        double along = 0;  ///< from the start of the piece: world units, of ovals radians
    };

    /// @param rig  without a rig_fault(); an open one continues straight beyond its end, by its own
    ///   length
    explicit Path(const Rig& rig);

    openvdb::Vec3d at(const Place& place) const;
    /// The first place after `from` at a straight distance from it.
    /// @param distance  world units
    /// @return nothing if there is none; in a closed rig, if there is none within a round
    std::optional<Place> step(const Place& from, double distance) const;
    /// Unit direction from one place to a later one.
    openvdb::Vec3d direction(const Place& from, const Place& to) const;
    /// Length of the path up to a place: world units, of ovals radians.
    double travelled(const Place& place) const;
    /// Length up to the end of an open rig without its extension, or of one round of a closed rig:
    /// world units, of ovals radians.
    double end() const { return end_; }
    /// Length of the rig, world units; of ovals an approximation.
    double length() const { return length_; }

private:
    /// Where a piece crosses the sphere around `origin` with radius `distance`: Place::along.
    double crossing(const Place& from, std::size_t piece, const openvdb::Vec3d& origin,
                    double distance) const;

    bool closed_;
    std::optional<Rig::Oval> oval_;
    std::vector<openvdb::Vec3d> points_, directions_;
    std::vector<double> starts_;  ///< of the pieces, and the end of the last one, as travelled()
    double length_ = 0, end_ = 0;
};

}  // namespace fluidcarve
