#include "carve/lattice/extension_faults.h"

#include "carve/base/words.h"
#include "carve/volume/cubes.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <string>

namespace fluidcarve {

void ExtensionFaults::add(const Lattice& lattice, Axis axis, int below, int above, int frame) {
    if ((below == 0 && above == 0) || lattice.hash == hash_) return;
    moves_ = !hash_.empty();
    hash_ = lattice.hash;
    axis_ = axis;
    below_ = below;
    above_ = above;
    planes_ = lattice.shape[2];
    around_ = lattice.around;
    std::array<int, 3> before{};
    before[dimension(axis)] = below;
    const auto whole = extended(lattice, before, axis == Axis::w ? above : 0);
    auto extent = whole.shape;
    if (axis != Axis::w) extent[dimension(axis)] += above;

    const auto note = [frame](Worst& worst, std::size_t extended, std::size_t own, int plane) {
        if (extended > own && extended - own > worst.count) worst = {extended - own, plane, frame};
    };
    const auto folds = count_folds(whole, extent[0], extent[1]);
    note(folds_, folds.cells, count_folds(lattice, lattice.shape[0], lattice.shape[1]).cells,
         folds.plane);
    const auto cubes = cubes_of(lattice.spacing);
    const auto overlap = count_overlap(Mapping(whole, extent), *cubes);
    if (overlap.voxels > 0)
        note(overlap_, overlap.voxels, count_overlap(Mapping(lattice), *cubes).voxels,
             overlap.plane);
}

std::string ExtensionFaults::where(const Worst& worst) const {
    return fmt::format("{}, most of them between planes {} and {}",
                       moves_ ? fmt::format(" in frame {}", worst.frame) : "", worst.plane,
                       (worst.plane + 1) % planes_);
}

std::string ExtensionFaults::fault() const {
    if (folds_.count == 0 && overlap_.count == 0) return {};
    std::string out = fmt::format(
        "to insert {}, the lattice is extended beyond its {} vertex along {}, and there",
        counted(static_cast<std::size_t>(below_) + static_cast<std::size_t>(above_), "seam"),
        below_ == 0   ? "last"
        : above_ == 0 ? "first"
                      : "first and last",
        to_text(axis_));
    if (folds_.count > 0) out += fmt::format(" {} cells are folded{}", folds_.count, where(folds_));
    if (overlap_.count > 0)
        out += fmt::format("{} {} voxels, as large as the spacing, lie in several cells{}",
                           folds_.count > 0 ? ", and" : "", overlap_.count, where(overlap_));
    return out +
           (around_
                ? ": part of what is pushed there is lost; insert fewer seams, or lower `radius`"
                : ": part of what is pushed there is lost; insert fewer seams, or turn the lattice "
                  "around with its `flip_u` or its rig's `up`, so that it grows to the other side");
}

}  // namespace fluidcarve
