#pragma once

#include "nodes/rig/rig.h"

#include <optional>
#include <vector>

namespace fluidcarve {

/// A rig to walk along.
class Path {
public:
    /// A place on it: `along` from the start of a piece, in its own measure. Of a closed rig the pieces go on counting in
    /// the next round.
    struct Place {
        std::size_t piece = 0;
        double along = 0;
    };

    /// @param rig  without a rig_fault; an open one goes on straight beyond its end, for as long again
    explicit Path(const Rig& rig);

    openvdb::Vec3d at(const Place& place) const;
    /// The first place after `from` whose straight distance from there is `distance`; nothing if there is none, in a closed
    /// rig within a round.
    std::optional<Place> step(const Place& from, double distance) const;
    /// Unit direction from one place to a later one.
    openvdb::Vec3d direction(const Place& from, const Place& to) const;
    /// How far a place is along the path, in the pieces' measure.
    double travelled(const Place& place) const;
    /// The same for the end of an open rig as given, or one round.
    double end() const { return end_; }
    /// World units, of ovals nearly.
    double length() const { return length_; }

private:
    double crossing(const Place& from, std::size_t piece, const openvdb::Vec3d& origin, double distance) const;

    bool closed_;
    std::optional<Rig::Oval> oval_;
    std::vector<openvdb::Vec3d> points_, directions_;
    std::vector<double> starts_;  ///< of the pieces, and the end of the last: world units, of ovals radians
    double length_ = 0, end_ = 0;
};

}  // namespace fluidcarve
