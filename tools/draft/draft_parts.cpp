#include "carve/base/failure.h"
#include "carve/base/find_or_null.h"
#include "graph/text/yaml_text.h"
#include "tools/draft/draft_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

// The parts that all drafted pipelines have: the head, the reader, masks, the box, the solver, the
// carve, and the other writers.

namespace fluidcarve {

DraftText::DraftText(const DraftRequest& request)
    : request_(request), contents_(contents_of(request.facts)) {
    axis_ = request.axis != 'w' ? request.axis : contents_.y_up ? 'y' : 'z';
}

std::string DraftText::text() {
    if (axis_ == 't') {
        require_time();
        if (paced()) return at_another_pace();
    }
    switch (contents_.matter) {
        case Matter::smoke:
        case Matter::fire: fog(); break;
        case Matter::level_set: level_set(); break;
        case Matter::particles: particles(); break;
        case Matter::image: image(); break;
        case Matter::mesh: mesh(); break;
    }
    return head() + nodes_;
}

void DraftText::comment(const std::string& text) { nodes_ += fmt::format("\n  # {}\n", text); }

void DraftText::more(const std::string& text) { nodes_ += fmt::format("  # {}\n", text); }

void DraftText::node(const std::string& name, const std::string& type, const Fields& fields) {
    nodes_ += fmt::format("  {}: {{type: {}", name, type);
    for (const auto& [field, value] : fields) nodes_ += fmt::format(", {}: {}", field, value);
    nodes_ += "}\n";
}

std::string DraftText::param(const char* name, const char* type, const std::string& value,
                             const char* doc) {
    return value.empty() ? value
                         : fmt::format("  {}: {{type: {}, default: {}, doc: \"{}\"}}\n", name, type,
                                       value, doc);
}

std::string DraftText::path_param(const char* name, const std::string& value, const char* doc) {
    return param(name, "path", value.empty() ? value : yaml_scalar(value), doc);
}

bool DraftText::fraction() const {
    const auto count = std::atof(request_.count.c_str());
    return !request_.count.ends_with('%') && count != std::round(count);
}

std::string DraftText::head() const {
    const std::array titles{"smoke", "fire", "a level set", "particles", "an image", "a mesh"};
    const bool less = request_.count.starts_with('-'), time = axis_ == 't';
    auto out =
        fmt::format("# {} {}, {}: {} where it shows least.\n",
                    time                   ? (less ? "Shorten" : "Lengthen")
                    : request_.axis == 'w' ? (less ? "Lower" : "Raise")
                                           : (less ? "Narrow" : "Widen"),
                    titles.at(static_cast<std::size_t>(contents_.matter)),
                    time ? std::string("in time") : fmt::format("along {}", axis_),
                    warps() ? "a warp squeezes or draws it out"
                    : less  ? (time ? "seams of frames leave" : "seams leave")
                            : (time ? "seams of frames are shown again" : "seams are doubled"));
    out += "# Another amount, other files: --set count=-12 --set sim=FILES --set out=FILES\n";
    out += "fluidcarve: 1\n\nparams:\n";
    out += path_param("sim", request_.input,
                      request_.frames.empty() ? "Input file." : "Input sequence.");
    if (fraction() && !warps())
        throw Failure(
            fmt::format("seams are whole: take {:.0f} or {:.0f}; a warp carves by fractions, "
                        "too (carve --warp)",
                        std::floor(std::atof(request_.count.c_str())),
                        std::ceil(std::atof(request_.count.c_str()))));
    out += param("count", fraction() ? "float" : "count", request_.count,
                 axis_ == 't' ? "Frames, or a share of them: negative removes, positive inserts."
                 : warps()    ? "Voxels, or a share of the size: negative makes it narrower."
                           : "Seams, or a share of the size: negative removes, positive inserts.");
    out += path_param("out", request_.out, "What was carved.") +
           path_param("seams", request_.seams, "The seams, to use again without solving.") +
           path_param("sheet", request_.sheet,
                      axis_ == 't' ? "Some frames in one picture."
                                   : "Before, after and the seams in one picture.");
    return out + frames() + "\nnodes:";
}

std::string DraftText::frames() const {
    return request_.frames.empty()
               ? ""
               : fmt::format(
                     "\n# `auto`: the frames whose files are there. State them as {}, and "
                     "`run` reports a missing one.\nframes: auto\n",
                     request_.frames);
}

void DraftText::paced_sheet(const char* shown, const std::string& grid) {
    if (request_.sheet.empty()) return;
    const bool from_above =
        contents_.liquid() || contents_.matter == Matter::mesh || contents_.matter == Matter::image;
    comment("Some of its frames in one picture.");
    Fields fields{{"before", shown}, {"grid", grid}};
    if (!contents_.vectors) fields.emplace_back("show", "render");
    fields.emplace_back("axis", contents_.y_up || from_above ? "z" : "y");
    fields.emplace_back("path", "\"${sheet}\"");
    node("sheet", "preview.sheet", fields);
}

std::string DraftText::offer(const std::string& grid, const std::string& name, const char* type) {
    const auto alias = plain_name(grid) && !(name == "surface") ? grid : name;
    const auto value = contents_.matter == Matter::image ? yaml_scalar(grid)
                       : alias == grid
                           ? std::string(type)
                           : fmt::format("{{name: {}, type: {}}}", yaml_scalar(grid), type);
    if (std::ranges::find(offered_, alias, &std::pair<std::string, std::string>::first) ==
        offered_.end())
        offered_.emplace_back(alias, value);
    return "sim." + alias;
}

void DraftText::reader(const char* type, const char* list) {
    Fields fields{{"path", "\"${sim}\""}};
    std::vector<std::string> outputs;
    for (const auto& [name, value] : offered_) outputs.push_back(name + ": " + value);
    if (!outputs.empty())
        fields.emplace_back(list, fmt::format("{{{}}}", fmt::join(outputs, ", ")));
    if (!contents_.profile.empty() && contents_.in_volume)
        fields.emplace_back("profile", contents_.profile);
    node("sim", type, fields);
}

void DraftText::beside() {
    for (std::size_t n = 0; n < contents_.same.size(); ++n)
        offer(contents_.same[n], fmt::format("beside{}", n + 1),
              contents_.vectors ? "vector" : "float");
}

void DraftText::masks(const std::string& like) {
    std::vector<std::string> all;
    for (const auto& each : protected_) {
        const auto name =
            fmt::format("keep{}", protected_.size() > 1 ? std::to_string(all.size() + 1) : "");
        all.push_back(name);
        if (all.size() == 1) comment("No seam passes here.");
        if (!each.field.empty()) {
            node(name, "mask.threshold", {{"field", each.field}, {"above", each.value}});
        } else if (contents_.matter == Matter::image) {
            node(name + "_paint", "image.read", {{"path", yaml_scalar(each.value)}});
            node(name + "_bright", "energy.image", {{"source", name + "_paint"}});
            node(name, "mask.threshold", {{"field", name + "_bright.intensity"}, {"above", "0.5"}});
        } else {
            node(name + "_mesh", "mesh.read", {{"path", yaml_scalar(each.value)}});
            node(name, "mask.mesh", {{"mesh", name + "_mesh"}, {"like", like}});
        }
    }
    if (all.size() > 1)
        node("keep", "mask.combine", {{"masks", fmt::format("[{}]", fmt::join(all, ", "))}});
}

void DraftText::box(const std::string& fit) {
    comment(contents_.matter == Matter::image
                ? "The lattice is the image: `u` to the right, `v` up."
                : "The space in which seams run: the box around all frames, a vertex at every "
                  "voxel.");
    // Grids of the same name beside it move alike.
    std::vector<std::string> all{fit};
    for (std::size_t n = 0; n < contents_.same.size(); ++n)
        all.push_back(fmt::format("sim.beside{}", n + 1));
    Fields fields{{"fit", all.size() == 1 ? fit : fmt::format("[{}]", fmt::join(all, ", "))}};
    if (axis_ == 'z') fields.emplace_back("axes", "zxy");
    node("box", "lattice.box", fields);
    if (contents_.matter != Matter::image && contents_.box) rig_comment();
}

void DraftText::rig_comment() {
    const auto size = contents_.box.extents(), middle = contents_.box.getCenter();
    const auto along = static_cast<int>(openvdb::math::MaxIndex(size));
    auto first = middle, last = middle;
    first[along] = contents_.box.min()[along];
    last[along] = contents_.box.max()[along];
    const auto point = [](const openvdb::Vec3d& at) {
        return fmt::format("[{:.5g}, {:.5g}, {:.5g}]", at.x(), at.y(), at.z());
    };
    const auto reach = std::max(size[(along + 1) % 3], size[(along + 2) % 3]) / 2 + contents_.voxel;
    more(
        "To carve along a bend, put these two in its place, and let the points follow the "
        "bend; rig.curve reads them from a file:");
    more(fmt::format("rig: {{type: rig.points, points: [{}, {}, {}], up: {}}}", point(first),
                     point(middle), point(last), along == 2 ? "[0, 1, 0]" : "[0, 0, 1]"));
    more(
        fmt::format("box: {{type: lattice.build, rig: rig, spacing: {:.6g}, extent_u: [{:.5g}, "
                    "{:.5g}], extent_v: [{:.5g}, {:.5g}]}}",
                    contents_.voxel, -reach, reach, -reach, reach));
}

bool DraftText::warps() const {
    if (axis_ == 't') return false;
    if (!request_.solver.empty()) return request_.solver == "warp.solve";
    const auto of_seams = [](const auto& field) {
        return field.first == "spread" || field.first == "rigidity" || field.first == "soft";
    };
    return contents_.liquid() && std::ranges::none_of(request_.solver_fields, of_seams) &&
           std::ranges::none_of(request_.remap_fields, of_seams);
}

DraftText::Fields DraftText::without(Fields fields, std::string_view name) {
    std::erase_if(fields, [&](const auto& field) { return field.first == name; });
    return fields;
}

void DraftText::solver(Fields fields) {
    if (warps()) fields = without(without(std::move(fields), "spread"), "field_weight");
    fields.insert(fields.begin(), {"energy", "energy"});
    fields.emplace_back("lattice", "box");
    if (!protected_.empty()) fields.emplace_back("protect", "keep");
    fields.emplace_back("axis", axis_ == 't' ? "t" : axis_ == 'y' ? "v" : "u");
    fields.emplace_back(warps() ? "amount" : "count", "\"${count}\"");
    // Seams may run out beside what none may pass.
    if (!protected_.empty() && !warps() && axis_ != 't') fields.emplace_back("best_effort", "true");
    if (contents_.matter != Matter::image && axis_ != 't')
        fields.emplace_back("anchor", contents_.source.at(static_cast<std::size_t>(axis_ - 'x')));
    node("seams",
         warps()                   ? "warp.solve"
         : request_.solver.empty() ? "seam.pyramid"
                                   : request_.solver,
         with(std::move(fields), request_.solver_fields));
}

void DraftText::carve(const std::string& name, const char* type, const std::string& source,
                      Fields fields) {
    if (warps() || axis_ == 't') fields = without(std::move(fields), "soft");
    fields.insert(fields.begin(), {{"source", source}, {"lattice", "box"}, {"seams", "seams"}});
    auto wanted = request_.remap_fields;
    if (std::string_view(type) != "remap.grids")
        std::erase_if(wanted, [](const auto& field) { return field.first != "soft"; });
    node(name, type, with(std::move(fields), wanted));
}

DraftText::Fields DraftText::with(Fields fields, const Fields& wanted) {
    for (const auto& [name, value] : wanted) {
        if (auto* const found =
                find_or_null(fields, name, &std::pair<std::string, std::string>::first))
            found->second = value;
        else fields.emplace_back(name, value);
    }
    return fields;
}

void DraftText::others(const std::string& before, const std::string& after,
                       const std::string& grid) {
    if (!request_.seams.empty())
        node("kept", "seams.write", {{"seams", "seams"}, {"path", "\"${seams}\""}});
    if (axis_ == 't') return paced_sheet(after.c_str(), yaml_scalar(grid));
    if (request_.sheet.empty()) return;
    comment("Is the carve where it should be? Look here first.");
    const char forward = contents_.y_up ? 'z' : 'y';
    // Liquids are seen from above, which only the view along z shows; all else from the front.
    // Nothing is seen along the carve: seams would face the viewer.
    const bool from_above = contents_.matter == Matter::image ||
                            (contents_.liquid() && !contents_.y_up && axis_ != 'z');
    const char view = from_above ? 'z' : axis_ == forward ? 'x' : forward;
    Fields fields{{"before", before},   {"after", after},   {"grid", yaml_scalar(grid)},
                  {"energy", "energy"}, {"lattice", "box"}, {"seams", "seams"}};
    fields.emplace_back("show", contents_.vectors ? "slice" : "render");
    fields.emplace_back("axis", std::string(1, view));
    fields.emplace_back("path", "\"${sheet}\"");
    node("sheet", "preview.sheet", fields);
}

}  // namespace fluidcarve
