#include "nodes/energy/remap.h"

#include "nodes/energy/term_ranges.h"
#include "nodes/field/active_range.h"
#include "nodes/field/stencil.h"

#include <algorithm>
#include <cmath>

namespace fluidcarve {
namespace {

struct EnergyRemap {
    struct Params : RemapCurve {
        Auto<Interval> range;
    };
    struct Ports {
        Ref<FloatGrid> energy, remapped;
    };

    Interval gathered = empty_range;

    static bool gathers(const Params& params) { return !params.range; }

    static void check(const Params& params, NodeCheck& check) {
        if (!params.clamp && params.gamma != 1) check.fault("gamma", "'gamma' needs clamped values: leave 'gamma' at 1, or 'clamp' at true");
    }

    static std::shared_ptr<FrameRanges> digest(const Params&, const Ports& io, Context&) {
        return std::make_shared<FrameRanges>(FrameRanges{{active_range(*io.energy)}});
    }

    void add(const Params&, const Ref<FrameRanges>& frame, Context&) { gathered = joined(gathered, frame->each.at(0)); }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context&) const { io.remapped = remapped_energy(*io.energy, params.range.value_or(gathered), params); }
};

}  // namespace

FloatGrid::Ptr remapped_energy(const FloatGrid& field, const Interval& range, const RemapCurve& curve) {
    const auto remap = [&](float value) {
        double t = range.low < range.high ? (value - range.low) / (range.high - range.low) : 0;
        if (curve.clamp) t = std::clamp(t, 0.0, 1.0);
        if (curve.gamma == 2) t *= t;
        else if (curve.gamma != 1) t = std::pow(t, curve.gamma);
        return static_cast<float>(curve.invert ? std::lerp(curve.to.high, curve.to.low, t) : std::lerp(curve.to.low, curve.to.high, t));
    };
    const auto out = map_values<FloatGrid>(field, remap(field.background()), remap);
    out->setName("remap of " + field.getName());
    return out;
}

NodeType energy_remap() {
    return Declare<EnergyRemap>("energy.remap", "Remaps an energy's values to another interval: linearly or with a gamma, and inverted if wanted.")
        .input("energy", &EnergyRemap::Ports::energy, "An energy, density or any other field.")
        .param("range", &EnergyRemap::Params::range, Unit::none, any_number(),
               "The interval that becomes `to`, in the unit of `energy`. Auto: from the smallest to the largest active value of the sequence, found in an "
               "extra pass. If both are equal, every value counts as the low end.")
        .param("to", &RemapCurve::to, Unit::none, any_number(), "The interval that `range` is mapped to.")
        .param("gamma", &RemapCurve::gamma, Unit::none, between(0.01, 100),
               "Exponent of the curve: below 1 raises low values, above 1 lowers them. Needs `clamp`.")
        .param("clamp", &RemapCurve::clamp, "Whether values outside of `range` go to the ends of `to`. False: they are extrapolated linearly.")
        .param("invert", &RemapCurve::invert, "Maps the low end of `range` to the high end of `to`: empty space then gets the highest energy.")
        .output("energy", &EnergyRemap::Ports::remapped, "The remapped values, on the active voxels of `energy`. Its background is remapped too.")
        .digests({"energy"})
        .in_place();
}

}  // namespace fluidcarve
