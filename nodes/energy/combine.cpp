#include "nodes/energy/combine.h"

#include "nodes/energy/term_ranges.h"
#include "nodes/field/same_transform.h"
#include "nodes/field/stencil.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {
namespace {

/// A term of combined_energy with its remap.
struct Remap {
    const FloatGrid* grid;
    double weight, low, width;

    explicit Remap(const EnergyTerm& term) : grid(term.energy.get()), weight(term.weight), low(term.range.low), width(term.range.high - term.range.low) {}
    float operator()(float value) const { return width > 0 ? static_cast<float>(weight * std::clamp((value - low) / width, 0.0, 1.0)) : 0; }
};

struct Combine {
    struct Params {
        std::vector<float> weights;
        TermRanges range;
    };
    struct Ports {
        List<FloatGrid> terms;
        Ref<FloatGrid> energy;
    };

    GatheredRanges gathered;

    static bool gathers(const Params& params) { return params.range.gathers(); }

    static void check(const Params& params, NodeCheck& check) {
        const auto terms = check.connections("terms");
        if (!params.weights.empty() && params.weights.size() != terms)
            check.fault("weights", fmt::format("states {} weights for {} terms; state one per term", params.weights.size(), terms));
        params.range.check(terms, check);
    }

    static std::shared_ptr<FrameRanges> digest(const Params& params, const Ports& io, Context&) { return ranges_of(params.range, io.terms); }

    void add(const Params&, const Ref<FrameRanges>& frame, Context&) { gathered.add(*frame); }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context&) const {
        std::vector<EnergyTerm> terms;
        for (std::size_t n = 0; n < io.terms.size(); ++n)
            terms.push_back({io.terms[n], params.weights.empty() ? 1.0f : params.weights.at(n), gathered.of(params.range, n)});
        io.energy = combined_energy(terms);
    }
};

}  // namespace

FloatGrid::Ptr combined_energy(const std::vector<EnergyTerm>& terms) {
    for (std::size_t n = 1; n < terms.size(); ++n) require_same_transform(fmt::format("terms 1 and {}", n + 1), *terms[0].energy, *terms[n].energy);
    const std::vector<Remap> remaps(terms.begin(), terms.end());
    float nothing = 0;  ///< the background of the sum
    for (const auto& remap : remaps) nothing += remap(remap.grid->background());
    const auto tree = std::make_shared<openvdb::FloatTree>(terms[0].energy->tree(), nothing, openvdb::TopologyCopy());
    for (std::size_t n = 1; n < terms.size(); ++n) tree->topologyUnion(terms[n].energy->tree());

    std::mutex mutex;
    std::optional<std::pair<std::size_t, openvdb::Coord>> lowest;
    const auto note = [&](std::size_t term, const openvdb::Coord& at) {
        const std::lock_guard lock(mutex);
        const std::pair found(term, at);
        if (!lowest || found < *lowest) lowest = found;
    };
    using Leaf = openvdb::FloatTree::LeafNodeType;
    openvdb::tree::LeafManager<openvdb::FloatTree>(*tree).foreach ([&](Leaf& leaf, std::size_t) {
        for (std::size_t n = 0; n < remaps.size(); ++n) {
            const auto& remap = remaps[n];
            const auto* const from = remap.grid->tree().probeConstLeaf(leaf.origin());
            const float constant = from ? 0 : remap.grid->tree().getValue(leaf.origin());
            for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
                const float value = from ? from->getValue(voxel.pos()) : constant;
                if (!std::isfinite(value)) note(n, voxel.getCoord());
                voxel.setValue((n == 0 ? 0 : *voxel) + remap(value));
            }
        }
    });
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        float sum = 0;
        for (std::size_t n = 0; n < remaps.size(); ++n) {
            const float value = remaps[n].grid->tree().getValue(tile.getCoord());
            if (!std::isfinite(value)) note(n, tile.getCoord());
            sum += remaps[n](value);
        }
        tile.setValue(sum);
    }
    if (lowest) refuse_not_finite(*terms[lowest->first].energy, lowest->second);

    auto out = FloatGrid::create(tree);
    out->setTransform(terms[0].energy->transform().copy());
    out->setName("energy");
    return out;
}

NodeType energy_combine() {
    return Declare<Combine>("energy.combine", "Adds energies, each remapped to [0, 1] over the whole sequence and weighted.")
        .input("terms", &Combine::Ports::terms, "Energies, all on grids with the same transform.")
        .param("weights", &Combine::Params::weights, Unit::none, at_least(0), "One weight per term. Empty: all are 1.")
        .param("range", &Combine::Params::range,
               "The interval that is remapped to [0, 1]; values outside are clamped. Auto: from the smallest to the largest active value of the sequence, "
               "found in an extra pass. A list states one interval or auto per term. A constant term counts as 0.")
        .output("energy", &Combine::Ports::energy, "From 0 to the sum of the weights, on the voxels that are active in any term.")
        .digests({"terms", "range"})
        .in_place();
}

}  // namespace fluidcarve
