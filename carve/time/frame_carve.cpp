#include "carve/time/frame_carve.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/time/mesh_between.h"
#include "carve/time/paced.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

namespace {

/// Whether floats are shown, but no grid in any two neighbouring frames by which motion is found.
bool shows_no_motion(const Sequence& source) {
    if (source.box().empty()) return false;
    for (std::size_t place = 0; place + 1 < source.size(); ++place)
        if (shown_in(source.at(place).volume, source.at(place + 1).volume)) return false;
    return source.size() > 1;
}

}  // namespace

void FrameCarve::require_still(const Ref<Lattice>& lattice) {
    if (lattice_ && lattice_->hash != lattice->hash)
        throw Failure(
            "the lattice is another one than in the frames before, but seams of frames need "
            "one that stands still: use a rig that does, or lattice.box");
    lattice_ = lattice;
}

void FrameCarve::add(const Volume& source, const Ref<Lattice>& lattice, int number,
                     const Limits& limits) {
    require_still(lattice);
    source_.add(source, nullptr, number, limits);
    numbers_.push_back(number);
}

void FrameCarve::add(const Ref<Points>& source, const Ref<Lattice>& lattice, int number,
                     const Limits& limits) {
    require_still(lattice);
    points_.add(source, number, limits);
    numbers_.push_back(number);
}

void FrameCarve::add(const Ref<Mesh>& source, const Ref<Lattice>& lattice, int number,
                     const Limits& limits) {
    require_still(lattice);
    if (meshes_.size() > 0 && !faces_change_)
        faces_change_ = !same_faces(*meshes_.at(meshes_.size() - 1), *source);
    meshes_.add(source, number, limits);
    numbers_.push_back(number);
}

void FrameCarve::finish(const Seams& seams, std::size_t count, const std::vector<int>& left,
                        const JoinParams& join, std::uint64_t memory_budget) {
    if (seams.frames != numbers())
        throw Failure(
            fmt::format("the seams are of the frames {}, but the source has {}: state the same "
                        "`frames` as when they were found, or find them anew",
                        FrameSet(seams.frames).text(), FrameSet(numbers()).text()));
    left_ = left;
    const auto how = time_join_of(join, seams.thick());
    map_.emplace(seams, *lattice_, count, how);
    blends_ = faces_change_ || (how.fade > 1 && how.moved && shows_no_motion(source_));
    motions_.emplace(source_, 0, memory_budget);
}

int FrameCarve::place_of(int number) const {
    const auto found = std::ranges::lower_bound(left_, number);
    if (found == left_.end() || *found != number)
        throw Failure(
            fmt::format("there is no such frame: some of the source are missing, and the carve "
                        "leaves {}; let `missing: hold` of the reader fill them",
                        FrameSet(left_).text()));
    return static_cast<int>(found - left_.begin());
}

Volume FrameCarve::volume(int number, bool pace) const {
    const int n = place_of(number);
    auto out = map_->frame(frame_source(source_, *motions_), n);
    const auto rate = pace ? map_->rate(n) : nullptr;
    return rate ? paced(out, rate) : out;
}

Points FrameCarve::points(int number, bool pace) const {
    const int n = place_of(number);
    auto out = map_->frame(frame_source(points_), n);
    const auto rate = pace ? map_->rate(n) : nullptr;
    return rate ? paced(out, rate) : out;
}

Mesh FrameCarve::mesh(int number) const {
    return map_->frame(frame_source(meshes_), place_of(number));
}

}  // namespace fluidcarve
