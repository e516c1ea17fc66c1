#include "carve/field/missed_range.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {
constexpr auto wanted_key = "fluidcarve_wanted", values_key = "fluidcarve_values";
}

void note_missed_range(MaskGrid& mask, const MissedRange& missed) {
    mask.insertMeta(wanted_key, openvdb::Vec2DMetadata({missed.wanted.low, missed.wanted.high}));
    mask.insertMeta(values_key, openvdb::Vec2DMetadata({missed.values.low, missed.values.high}));
}

std::optional<MissedRange> missed_range(const openvdb::GridBase& mask) {
    const auto range = [&](const char* key) -> std::optional<Interval> {
        const auto held = mask.getMetadata<openvdb::Vec2DMetadata>(key);
        return held ? std::optional(Interval{held->value().x(), held->value().y()}) : std::nullopt;
    };
    const auto wanted = range(wanted_key), values = range(values_key);
    return wanted && values ? std::optional(MissedRange{*wanted, *values}) : std::nullopt;
}

std::string to_text(const MissedRange& missed) {
    const auto& [low, high] = missed.wanted;
    const auto wanted = std::isinf(high)  ? fmt::format("from {:g}", low)
                        : std::isinf(low) ? fmt::format("up to {:g}", high)
                                          : fmt::format("from {:g} to {:g}", low, high);
    if (missed.values.low > missed.values.high)
        return fmt::format("mask.threshold marks values {}, but the field has no active voxels",
                           wanted);
    return fmt::format("mask.threshold marks values {}, but the field has {:g} to {:g} only",
                       wanted, missed.values.low, missed.values.high);
}

}  // namespace fluidcarve
