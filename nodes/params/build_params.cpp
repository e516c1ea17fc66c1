#include "nodes/params/build_params.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <tuple>

namespace fluidcarve {

namespace {

/// The fault of an extent in world units, if any. @param spacing  nothing: not known yet
std::optional<std::string> extent_fault(const char* name, const RigExtent& extent,
                                        const Auto<double>& spacing) {
    if (extent.high == extent.low)
        return fmt::format(
            "'{}' is {}, which is empty; for a single vertex, as for images, state less than one "
            "spacing{}",
            name, to_text(extent),
            spacing && !extent.percent
                ? ": " + to_text(RigExtent{extent.low, extent.low + *spacing / 2, false})
                : std::string());
    if (!spacing || extent.percent) return std::nullopt;
    const double count = vertices_along(extent.of(0), *spacing);
    if (count <= most_vertices) return std::nullopt;
    return fmt::format("'{}' holds {:.0f} vertices at a spacing of {:g}; {} is the most", name,
                       count, *spacing, most_vertices);
}

}  // namespace

void check_params(const BuildParams& params, NodeCheck& check) {
    if (params.spacing && !(*params.spacing > 0))
        return check.fault("spacing", "'spacing' must be above 0");
    const bool content = check.stated("content");
    if (!params.spacing && !content)
        check.fault("spacing",
                    "'spacing' takes the voxel size of 'content', and that is not connected; "
                    "connect it, or state the spacing");
    for (const auto& [name, extent] :
         {std::pair{"extent_u", params.extent_u}, std::pair{"extent_v", params.extent_v}}) {
        if (extent.percent && !content)
            check.fault(name, fmt::format("'{}' counts the width of 'content', and that is not "
                                          "connected; connect it, or state world units",
                                          name));
        else if (const auto fault = extent_fault(name, extent, params.spacing))
            check.fault(name, *fault);
    }
}

void require_extents(const BuildParams& params, const ContentReach& content, double spacing) {
    for (const auto& [name, extent, width] : {std::tuple{"extent_u", params.extent_u, content.u},
                                              std::tuple{"extent_v", params.extent_v, content.v}}) {
        const auto [low, high] = extent.of(width);
        if (const auto fault = extent_fault(name, {low, high}, spacing)) throw Failure(*fault);
    }
}

LatticeSpec spec_of(const BuildParams& params, const ContentReach& content, double spacing) {
    LatticeSpec out;
    out.spacing = spacing;
    out.u = params.extent_u.of(content.u);
    out.v = params.extent_v.of(content.v);
    out.flip_u = params.flip_u;
    out.closed_form = params.mapping == Inverse::closed_form;
    out.smooth = params.smooth;
    out.max_iterations = params.max_iterations;
    return out;
}

}  // namespace fluidcarve
