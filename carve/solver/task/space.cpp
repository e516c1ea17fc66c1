#include "carve/solver/task/space.h"

#include "carve/lattice/extension_faults.h"

#include <optional>

namespace fluidcarve {

CarvedSpace::CarvedSpace(const std::vector<Ref<Lattice>>& lattices,
                         const std::vector<Ref<Seams>>& after, const std::vector<int>& frames)
    : lattices_(lattices), after_(after), frames_(frames) {
    // Fails if the sets do not fit together. shape() trusts that they do.
    carve_map(0);
}

std::array<int, 3> CarvedSpace::shape() const {
    return after_.empty() ? lattices_.front()->shape
                          : after_.back()->shape_after(after_.back()->size());
}

LatticeForm CarvedSpace::form() const {
    return {shape(), lattices_.front()->closed, lattices_.front()->around,
            static_cast<int>(frames_.size())};
}

CarveMap CarvedSpace::carve_map(std::size_t t) const {
    return {*lattices_[place(t)], after_, frames_[t], std::nullopt};
}

std::string CarvedSpace::extension_fault(const Seams& found) const {
    if (found.paired() || found.in_time()) return {};
    const auto axis = dimension(found.axis);
    int first = found.shift_after(found.size());
    for (const auto& set : after_)
        if (set->axis == found.axis) first += set->shift_after(set->size());
    const int end = first + found.shape_after(found.size())[axis];
    ExtensionFaults faults;
    for (std::size_t t = 0; t < lattices_.size(); ++t)
        faults.add(*lattices_[t], found.axis, std::max(0, -first),
                   std::max(0, end - lattices_[t]->shape[axis]), frames_[t]);
    return faults.fault();
}

}  // namespace fluidcarve
