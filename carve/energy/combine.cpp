#include "carve/energy/combine.h"

#include "carve/field/same_transform.h"
#include "carve/field/stencil.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace fluidcarve {

namespace {

/// A term of combined_energy with its remap.
struct Remap {
    const FloatGrid* grid;
    double weight, low, width;

    explicit Remap(const EnergyTerm& term)
        : grid(term.energy.get()),
          weight(term.weight),
          low(term.range.low),
          width(term.range.high - term.range.low) {}
    float operator()(float value) const {
        return width > 0 ? static_cast<float>(weight * std::clamp((value - low) / width, 0.0, 1.0))
                         : 0;
    }
};

/// The first value that is not finite: of the first term that has one, the first voxel.
class FirstFault {
public:
    void note(std::size_t term, const openvdb::Coord& at) {
        const std::lock_guard lock(mutex_);
        const std::pair found(term, at);
        if (!found_ || found < *found_) found_ = found;
    }
    const std::optional<std::pair<std::size_t, openvdb::Coord>>& found() const { return found_; }

private:
    std::mutex mutex_;
    std::optional<std::pair<std::size_t, openvdb::Coord>> found_;
};

void sum_leaf(const std::vector<Remap>& remaps, openvdb::FloatTree::LeafNodeType& leaf,
              FirstFault& fault) {
    for (std::size_t n = 0; n < remaps.size(); ++n) {
        const auto& remap = remaps[n];
        const auto* const from = remap.grid->tree().probeConstLeaf(leaf.origin());
        const float constant = from ? 0 : remap.grid->tree().getValue(leaf.origin());
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
            const float value = from ? from->getValue(voxel.pos()) : constant;
            if (!std::isfinite(value)) fault.note(n, voxel.getCoord());
            voxel.setValue((n == 0 ? 0 : *voxel) + remap(value));
        }
    }
}

}  // namespace

FloatGrid::Ptr combined_energy(const std::vector<EnergyTerm>& terms) {
    for (std::size_t n = 1; n < terms.size(); ++n)
        require_same_transform(fmt::format("terms 1 and {}", n + 1), *terms[0].energy,
                               *terms[n].energy);
    const std::vector<Remap> remaps(terms.begin(), terms.end());
    float nothing = 0;  ///< the background of the sum
    for (const auto& remap : remaps) nothing += remap(remap.grid->background());
    const auto tree = std::make_shared<openvdb::FloatTree>(terms[0].energy->tree(), nothing,
                                                           openvdb::TopologyCopy());
    for (std::size_t n = 1; n < terms.size(); ++n) tree->topologyUnion(terms[n].energy->tree());

    FirstFault fault;
    openvdb::tree::LeafManager<openvdb::FloatTree>(*tree).foreach (
        [&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
            sum_leaf(remaps, leaf, fault);
        });
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        float sum = 0;
        for (std::size_t n = 0; n < remaps.size(); ++n) {
            const float value = remaps[n].grid->tree().getValue(tile.getCoord());
            if (!std::isfinite(value)) fault.note(n, tile.getCoord());
            sum += remaps[n](value);
        }
        tile.setValue(sum);
    }
    if (const auto found = fault.found())
        refuse_not_finite(*terms[found->first].energy, found->second);

    auto out = FloatGrid::create(tree);
    out->setTransform(terms[0].energy->transform().copy());
    out->setName("energy");
    return out;
}

}  // namespace fluidcarve
