#include "nodes/energy/combine.h"

#include "nodes/field/same_transform.h"
#include "nodes/field/stencil.h"

#include <fmt/format.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>

namespace fluidcarve {
namespace {

constexpr Interval nothing{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

Interval joined(const Interval& a, const Interval& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }

/// `auto`, `[low, high]`, or one of these per term.
struct TermRanges {
    std::vector<Auto<Interval>> each{std::nullopt};
    bool shared = true;
    const Auto<Interval>& of(std::size_t term) const { return each.at(shared ? 0 : term); }
};

/// A term of combined_energy, ready for its voxels.
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

    std::vector<Interval> gathered;

    static bool gathers(const Params& params) {
        return std::any_of(params.range.each.begin(), params.range.each.end(), [](const auto& range) { return !range; });
    }

    static void check(const Params& params, NodeCheck& check) {
        const auto terms = check.connections("terms");
        const auto count = [&](const char* field, std::size_t stated, const char* what) {
            if (stated != terms) check.fault(field, fmt::format("states {} {} for {} terms; state one per term", stated, what, terms));
        };
        if (!params.weights.empty()) count("weights", params.weights.size(), "weights");
        if (!params.range.shared) count("range", params.range.each.size(), "ranges");
    }

    void add(const Params& params, const Ports& io, Context&) {
        gathered.resize(io.terms.size(), nothing);
        for (std::size_t n = 0; n < io.terms.size(); ++n)
            if (!params.range.of(n)) gathered[n] = joined(gathered[n], active_range(*io.terms[n]));
    }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context&) const {
        std::vector<EnergyTerm> terms;
        for (std::size_t n = 0; n < io.terms.size(); ++n) {
            const auto& stated = params.range.of(n);
            terms.push_back({io.terms[n], params.weights.empty() ? 1.0f : params.weights.at(n), stated ? *stated : gathered.at(n)});
        }
        io.energy = combined_energy(terms);
    }
};

}  // namespace

template <>
struct ParamTraits<TermRanges> {
    using One = ParamTraits<Auto<Interval>>;
    using Each = ParamTraits<std::vector<Auto<Interval>>>;

    static Shape shape() { return {Shape::Kind::any_of, {}, {One::shape(), Each::shape()}}; }

    static std::optional<TermRanges> parse(const Value& value, ValueReader& reader) {
        const auto is_number = [](const Value& item) { return item.kind == Value::Kind::scalar && item.text != "auto"; };
        if (value.kind == Value::Kind::list && std::none_of(value.items.begin(), value.items.end(), is_number)) {
            auto each = Each::parse(value, reader);
            return each ? std::optional(TermRanges{std::move(*each), false}) : std::nullopt;
        }
        if (value.kind != Value::Kind::list && value.text != "auto") return reader.unwanted(value, to_text(shape())), std::nullopt;
        const auto one = One::parse(value, reader);
        return one ? std::optional(TermRanges{{*one}, true}) : std::nullopt;
    }

    static std::string text(const TermRanges& ranges) { return ranges.shared ? One::text(ranges.each.at(0)) : Each::text(ranges.each); }
};

Interval active_range(const FloatGrid& grid) {
    using Leaves = openvdb::tree::LeafManager<const openvdb::FloatTree>;
    const auto extend = [](Interval range, auto value) {
        for (; value; ++value) {
            const double v = *value;
            // Told apart from any finite range, so that the caller looks for the place.
            range = std::isfinite(v) ? joined(range, {v, v}) : Interval{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        }
        return range;
    };
    const Leaves leaves(grid.tree());
    auto out = tbb::parallel_reduce(
        leaves.leafRange(), nothing,
        [&](const Leaves::LeafRange& range, Interval so_far) {
            for (auto leaf = range.begin(); leaf; ++leaf) so_far = extend(so_far, leaf->cbeginValueOn());
            return so_far;
        },
        joined);
    auto tiles = grid.cbeginValueOn();
    tiles.setMaxDepth(decltype(tiles)::LEAF_DEPTH - 1);
    out = extend(out, tiles);
    if (std::isinf(out.low) && out.low < out.high) refuse_not_finite(grid, {});
    return out;
}

FloatGrid::Ptr combined_energy(const std::vector<EnergyTerm>& terms) {
    for (std::size_t n = 1; n < terms.size(); ++n) require_same_transform(fmt::format("terms 1 and {}", n + 1), *terms[0].energy, *terms[n].energy);
    const auto tree = std::make_shared<openvdb::FloatTree>(terms[0].energy->tree(), 0.0f, openvdb::TopologyCopy());
    for (std::size_t n = 1; n < terms.size(); ++n) tree->topologyUnion(terms[n].energy->tree());
    const std::vector<Remap> remaps(terms.begin(), terms.end());

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
                voxel.setValue(*voxel + remap(value));
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
        .input("terms", &Combine::Ports::terms, "Energies, all on grids of one transform.")
        .param("weights", &Combine::Params::weights, Unit::none, at_least(0), "One per term; left empty, all are 1.")
        .param("range", &Combine::Params::range,
               "What is remapped to [0, 1], values beyond are clamped: the smallest and largest active value of the sequence, found in a pass of its own; "
               "or an interval for all terms; or a list with one of these per term. A term that is constant counts as 0.")
        .output("energy", &Combine::Ports::energy, "From 0 to the sum of the weights, on the voxels that are active in any term.");
}

}  // namespace fluidcarve
