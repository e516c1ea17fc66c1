#include "tools/draft/draft.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"
#include "graph/text/yaml_text.h"
#include "graph/types/frames.h"
#include "graph/types/param.h"
#include "tools/draft/contents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

using Matter = Contents::Matter;
using Fields = DraftRequest::Fields;

/// A path or a text of the command line as a YAML value.
std::string text_value(const std::string& text) { return yaml_scalar(text); }

/// Whether a text can be the name of a reader's output in a pipeline.
bool plain_name(const std::string& name) {
    const auto word = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
    return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) && std::ranges::all_of(name, word);
}

/// Writes one pipeline.
class Draft {
public:
    Draft(const DraftRequest& request) : request_(request), contents_(contents_of(request.facts)) {}

    std::string text() {
        if (request_.axis == 't') return in_time();
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

private:
    // Lines of the file.

    void comment(const std::string& text) { nodes_ += fmt::format("\n  # {}\n", text); }
    void more(const std::string& text) { nodes_ += fmt::format("  # {}\n", text); }

    void node(const std::string& name, const std::string& type, const Fields& fields) {
        nodes_ += fmt::format("  {}: {{type: {}", name, type);
        for (const auto& [field, value] : fields) nodes_ += fmt::format(", {}: {}", field, value);
        nodes_ += "}\n";
    }

    /// The line of a param; none without a value.
    static std::string param(const char* name, const char* type, const std::string& value, const char* doc) {
        return value.empty() ? value : fmt::format("  {}: {{type: {}, default: {}, doc: \"{}\"}}\n", name, type, value, doc);
    }
    static std::string path_param(const char* name, const std::string& value, const char* doc) {
        return param(name, "path", value.empty() ? value : text_value(value), doc);
    }
    /// Whether the count is no whole number.
    bool fraction() const { return !request_.count.ends_with('%') && request_.count.find_first_of(".eE") != std::string::npos; }

    std::string head() const {
        const std::array titles{"smoke", "fire", "a level set", "particles", "an image", "a mesh"};
        auto out =
            fmt::format("# {} {}, along {}: {} where it shows least.\n", request_.count.starts_with('-') ? "Narrow" : "Widen",
                        titles.at(static_cast<std::size_t>(contents_.matter)), request_.axis, warps() ? "a warp squeezes or draws it out" : "seams leave");
        out += "# Another amount, other files: --set count=-12 --set sim=FILES --set out=FILES\n";
        out += "fluidcarve: 1\n\nparams:\n";
        out += path_param("sim", request_.input, request_.frames.empty() ? "Input file." : "Input sequence.");
        if (fraction() && !warps())
            throw Failure(fmt::format("seams are whole: take {:.0f} or {:.0f}; a warp carves by fractions, too (carve --warp)",
                                      std::floor(std::atof(request_.count.c_str())), std::ceil(std::atof(request_.count.c_str()))));
        out += param(
            "count", fraction() ? "float" : "count", request_.count,
            warps() ? "Voxels, or a share of the size: negative makes it narrower." : "Seams, or a share of the size: negative removes, positive inserts.");
        out += path_param("out", request_.out, "What was carved.") + path_param("seams", request_.seams, "The seams, to use again without solving.") +
               path_param("sheet", request_.sheet, "Before, after and the seams in one picture.");
        if (!request_.frames.empty())
            out += fmt::format("\n# The frames whose files are there. State them, and one that is missing is told: {}\nframes: auto\n", request_.frames);
        return out + "\nnodes:";
    }

    /// A pipeline that makes the sequence shorter or longer.
    std::string in_time() {
        if (request_.frames.empty()) throw Failure("--axis t: one file has no frames to take or to add; give a sequence, such as smoke.####.vdb");
        const bool volume = contents_.matter == Matter::smoke || contents_.matter == Matter::fire || contents_.matter == Matter::level_set;
        if (!volume) throw Failure("--axis t: only volumes can be made shorter or longer in time (time.retime)");
        if (!request_.solver.empty() || !request_.protect.empty() || !request_.seams.empty() || !request_.solver_fields.empty() ||
            !request_.remap_fields.empty())
            throw Failure("--axis t: no seam is sought in time, so leave out --solver, --warp, --protect, --seams and what else is for seams");
        if (fraction()) throw Failure(fmt::format("--axis t: frames are whole, not {}", request_.count));
        std::string fault;
        const auto frames = FrameSet::parse(request_.frames, fault);
        const int before = frames ? static_cast<int>(frames->frames().size()) : 0;
        const int after = before + Count{std::atof(request_.count.c_str()), request_.count.ends_with('%')}.of(before);
        if (after < 2) throw Failure(fmt::format("--axis t: {} of {} frames leaves {}; leave two at least", request_.count, before, after));
        std::string velocity;
        if (!contents_.velocity.empty()) velocity = offer(contents_.velocity, "velocity", "vector");
        comment("`sim` alone means all grids of the files.");
        reader("vdb.read", "grids");
        comment(velocity.empty() ? "What follows has the new frames. The files have no velocity, so that what is seen tells where things move."
                                 : "What follows has the new frames. The velocity says where things move, and is scaled by the speed.");
        Fields pace{{"source", "sim"}, {"frames", "\"${length}\""}};
        if (!velocity.empty()) pace.insert(pace.begin() + 1, {"velocity", velocity});
        node("paced", "time.retime", pace);
        node("out", "vdb.write", {{"source", "paced"}, {"path", "\"${out}\""}});
        if (!request_.sheet.empty()) {
            comment("Some of its frames in one picture.");
            const auto grid = text_value(contents_.matter == Matter::fire ? contents_.flame : contents_.main);
            node("sheet", "preview.sheet",
                 {{"before", "paced"}, {"grid", grid}, {"axis", contents_.profile == "houdini" ? "z" : "y"}, {"path", "\"${sheet}\""}});
        }
        return fmt::format(
                   "# {} in time: {} frames become {}.\n# Another length, other files: --set length=48 --set sim=FILES --set out=FILES\n"
                   "fluidcarve: 1\n\nparams:\n",
                   after < before ? "Shorter" : "Longer", before, after) +
               path_param("sim", request_.input, "Input sequence.") + param("length", "int", std::to_string(after), "Frames of the result.") +
               path_param("out", request_.out, "The sequence at its new pace.") + path_param("sheet", request_.sheet, "Some frames in one picture.") +
               fmt::format("\nframes: {}\n\nnodes:", request_.frames) + nodes_;
    }

    // Parts that all pipelines have.

    /// Names a float grid, a vector grid or a channel as an output of the reader. @return "sim.NAME"
    std::string offer(const std::string& grid, const std::string& name, const char* type) {
        const auto alias = plain_name(grid) && !(name == "surface") ? grid : name;
        const auto value = contents_.matter == Matter::image ? text_value(grid)
                           : alias == grid                   ? std::string(type)
                                                             : fmt::format("{{name: {}, type: {}}}", text_value(grid), type);
        if (std::ranges::find(offered_, alias, &std::pair<std::string, std::string>::first) == offered_.end()) offered_.emplace_back(alias, value);
        return "sim." + alias;
    }

    /// The reader of the files, with what was offered so far.
    void reader(const char* type, const char* list) {
        Fields fields{{"path", "\"${sim}\""}};
        std::vector<std::string> outputs;
        for (const auto& [name, value] : offered_) outputs.push_back(name + ": " + value);
        if (!outputs.empty()) fields.emplace_back(list, fmt::format("{{{}}}", fmt::join(outputs, ", ")));
        if (!contents_.profile.empty() && contents_.in_volume) fields.emplace_back("profile", contents_.profile);
        node("sim", type, fields);
    }

    /// The nodes of masks that no seam may pass. @param like  a grid on whose voxels they lie
    /// Offers the grids that have the name of the one that is looked at.
    void beside() {
        for (std::size_t n = 0; n < contents_.same.size(); ++n)
            offer(contents_.same[n], fmt::format("beside{}", n + 1), contents_.vectors ? "vector" : "float");
    }

    void masks(const std::string& like) {
        std::vector<std::string> all;
        for (const auto& each : protected_) {
            const auto name = fmt::format("keep{}", protected_.size() > 1 ? std::to_string(all.size() + 1) : "");
            all.push_back(name);
            if (all.size() == 1) comment("No seam passes here.");
            if (!each.field.empty()) {
                node(name, "mask.threshold", {{"field", each.field}, {"above", each.value}});
            } else if (contents_.matter == Matter::image) {
                node(name + "_paint", "image.read", {{"path", text_value(each.value)}});
                node(name + "_bright", "energy.image", {{"source", name + "_paint"}});
                node(name, "mask.threshold", {{"field", name + "_bright.intensity"}, {"above", "0.5"}});
            } else {
                node(name + "_mesh", "mesh.read", {{"path", text_value(each.value)}});
                node(name, "mask.mesh", {{"mesh", name + "_mesh"}, {"like", like}});
            }
        }
        if (all.size() > 1) node("keep", "mask.combine", {{"masks", fmt::format("[{}]", fmt::join(all, ", "))}});
    }

    void box(const std::string& fit) {
        comment(contents_.matter == Matter::image ? "The lattice is the image: `u` to the right, `v` up."
                                                  : "The space in which seams run: the box around all frames, a vertex at every voxel.");
        // Grids of the same name beside it move alike.
        std::vector<std::string> all{fit};
        for (std::size_t n = 0; n < contents_.same.size(); ++n) all.push_back(fmt::format("sim.beside{}", n + 1));
        Fields fields{{"fit", all.size() == 1 ? fit : fmt::format("[{}]", fmt::join(all, ", "))}};
        if (request_.axis == 'z') fields.emplace_back("axes", "zxy");
        node("box", "lattice.box", fields);
        if (contents_.matter != Matter::image && contents_.box) rig_comment();
    }

    /// What stands in place of the box where the content bends: a rig through its middle, in its longest direction.
    void rig_comment() {
        const auto size = contents_.box.extents(), middle = contents_.box.getCenter();
        const auto along = static_cast<int>(openvdb::math::MaxIndex(size));
        auto first = middle, last = middle;
        first[along] = contents_.box.min()[along];
        last[along] = contents_.box.max()[along];
        const auto point = [](const openvdb::Vec3d& at) { return fmt::format("[{:.5g}, {:.5g}, {:.5g}]", at.x(), at.y(), at.z()); };
        const auto reach = std::max(size[(along + 1) % 3], size[(along + 2) % 3]) / 2 + contents_.voxel;
        more("To carve along a bend, put these two in its place, and let the points follow the bend; rig.curve reads them from a file:");
        more(fmt::format("rig: {{type: rig.points, points: [{}, {}, {}], up: {}}}", point(first), point(middle), point(last),
                         along == 2 ? "[0, 1, 0]" : "[0, 0, 1]"));
        more(fmt::format("box: {{type: lattice.build, rig: rig, spacing: {:.6g}, extent_u: [{:.5g}, {:.5g}], extent_v: [{:.5g}, {:.5g}]}}", contents_.voxel,
                         -reach, reach, -reach, reach));
    }

    /// Whether a warp carves, not seams. In a wave of water a seam would be a cliff.
    bool warps() const {
        if (!request_.solver.empty()) return request_.solver == "warp.solve";
        const auto of_seams = [](const auto& field) { return field.first == "spread" || field.first == "rigidity" || field.first == "soft"; };
        const bool water = contents_.matter == Matter::level_set || contents_.matter == Matter::particles;
        return water && std::ranges::none_of(request_.solver_fields, of_seams) && std::ranges::none_of(request_.remap_fields, of_seams);
    }
    /// Without the fields of a name.
    static Fields without(Fields fields, std::string_view name) {
        std::erase_if(fields, [&](const auto& field) { return field.first == name; });
        return fields;
    }

    void solver(Fields fields) {
        if (warps()) fields = without(without(std::move(fields), "spread"), "field_weight");
        fields.insert(fields.begin(), {"energy", "energy"});
        fields.emplace_back("lattice", "box");
        if (!protected_.empty()) fields.emplace_back("protect", "keep");
        fields.emplace_back("axis", request_.axis == 'y' ? "v" : "u");
        fields.emplace_back(warps() ? "amount" : "count", "\"${count}\"");
        // Seams may run out beside what none may pass.
        if (!protected_.empty() && !warps()) fields.emplace_back("best_effort", "true");
        if (contents_.matter != Matter::image) fields.emplace_back("anchor", contents_.source.at(static_cast<std::size_t>(request_.axis - 'x')));
        node("seams", warps() ? "warp.solve" : request_.solver.empty() ? "seam.pyramid" : request_.solver, with(std::move(fields), request_.solver_fields));
    }

    void carve(const std::string& name, const char* type, const std::string& source, Fields fields) {
        if (warps()) fields = without(std::move(fields), "soft");
        fields.insert(fields.begin(), {{"source", source}, {"lattice", "box"}, {"seams", "seams"}});
        auto wanted = request_.remap_fields;
        if (std::string_view(type) != "remap.grids") std::erase_if(wanted, [](const auto& field) { return field.first != "soft"; });
        node(name, type, with(std::move(fields), wanted));
    }

    /// Fields, some of them with other values.
    static Fields with(Fields fields, const Fields& wanted) {
        for (const auto& [name, value] : wanted) {
            const auto found = std::ranges::find(fields, name, &std::pair<std::string, std::string>::first);
            if (found == fields.end()) fields.emplace_back(name, value);
            else found->second = value;
        }
        return fields;
    }

    /// The writers of all but the carved files.
    void others(const std::string& before, const std::string& after, const std::string& grid, bool render) {
        if (!request_.seams.empty()) node("kept", "seams.write", {{"seams", "seams"}, {"path", "\"${seams}\""}});
        if (request_.sheet.empty()) return;
        comment("Is the carve where it should be? Look here first.");
        const bool y_up = contents_.profile == "houdini" || contents_.profile == "embergen";
        const auto* const view = contents_.matter == Matter::image ? "z" : y_up ? (request_.axis == 'z' ? "x" : "z") : (request_.axis == 'y' ? "x" : "y");
        Fields fields{{"before", before}, {"after", after}, {"grid", text_value(grid)}, {"energy", "energy"}, {"lattice", "box"}, {"seams", "seams"}};
        if (render) fields.emplace_back("show", "render");
        else if (contents_.matter != Matter::image) fields.emplace_back("show", "slice");
        fields.emplace_back("axis", view);
        fields.emplace_back("path", "\"${sheet}\"");
        node("sheet", "preview.sheet", fields);
    }

    /// What is protected: a range of a grid's values, or what is in a file.
    struct Protected {
        std::string field;  ///< output of the reader; empty: a file
        std::string value;  ///< lowest value, or path
    };

    void read_protected() {
        for (const auto& each : request_.protect) {
            const auto sign = each.rfind('=');
            double number = 0;
            const auto* const end = each.data() + each.size();
            const bool is_range = sign != std::string::npos && std::from_chars(each.data() + sign + 1, end, number).ptr == end && sign + 1 < each.size();
            if (!is_range) {
                const auto ending = ending_of(each);
                const std::set<std::string> meshes{".obj", ".ply", ".off", ".stl"};
                const bool picture = contents_.matter == Matter::image;
                if (ending.empty() || meshes.contains(ending) == picture)
                    throw Failure(fmt::format("--protect: '{}' is neither GRID=VALUE, such as density=0.7, nor {}", each,
                                              picture ? "an image, white where no seam may pass" : "a closed mesh (.obj, .ply, .off, .stl)"));
                protected_.push_back({{}, each});
                continue;
            }
            auto grid = each.substr(0, sign);
            // Of several grids of one name the first.
            if (std::ranges::find(contents_.floats, grid) == contents_.floats.end() &&
                std::ranges::find(contents_.floats, grid + "[0]") != contents_.floats.end())
                grid += "[0]";
            if (std::ranges::find(contents_.floats, grid) == contents_.floats.end())
                throw Failure(fmt::format("--protect: there is no float grid '{}' in every file of {}{}", grid, request_.input,
                                          contents_.floats.empty() ? "" : did_you_mean(grid, contents_.floats)));
            protected_.push_back({offer(grid, fmt::format("protect{}", protected_.size() + 1), "float"), each.substr(sign + 1)});
        }
    }

    // A pipeline for each matter.

    void fog() {
        const bool fire = contents_.matter == Matter::fire, both = fire && contents_.flame != contents_.main;
        auto field = offer(contents_.main, "main", contents_.vectors ? "vector" : "float");
        const auto flame = both ? offer(contents_.flame, "flame", "float") : field;
        beside();
        read_protected();
        comment("`sim` alone means all grids of the files, which are all carved; `grids` names those that nodes take.");
        reader("vdb.read", "grids");
        if (contents_.vectors) node("length", "field.magnitude", {{"vectors", std::exchange(field, "length")}});
        comment("What must keep its look: edges, by their square and as far as an eye compares.");
        if (both) {
            node("smoke", "energy.gradient", {{"field", field}});
            node("flames", "energy.gradient", {{"field", flame}});
            node("edges", "energy.combine", {{"terms", "[smoke, flames]"}});
        } else {
            node("edges", "energy.gradient", {{"field", field}});
        }
        node("sharp", "energy.remap", {{"energy", "edges"}, {"gamma", "2"}});
        node("energy", "field.filter", {{"field", "sharp"}, {"width", "2"}});
        masks(field);
        box(field);
        comment(fmt::format(
            "`field` is what is looked at: seams pay for the edges that they leave in it. More of the carve goes through the {} with a higher `empty`.",
            both   ? "fire and its smoke"
            : fire ? "flame"
                   : "smoke"));
        // A solver keeps 16 bits of what is looked at.
        constexpr double faint = 0.01, strong = 1e4;
        const bool remapped = !both && (contents_.highest < faint || contents_.highest > strong);
        if (both) node("seen", "energy.combine", {{"terms", fmt::format("[{}, {}]", field, flame)}});
        if (remapped) node("seen", "energy.remap", {{"energy", field}});
        solver({{"field", both || remapped ? "seen" : field}});
        nodes_ += "\n";
        carve("carved", "remap.grids", "sim", {});
        node("out", "vdb.write", {{"source", "carved"}, {"path", "\"${out}\""}});
        others("sim", "carved", fire ? contents_.flame : contents_.main, !contents_.vectors);
    }

    void level_set() {
        const auto surface = offer(contents_.main, "surface", "float");
        Fields energy{{"surface", surface}};
        if (!contents_.velocity.empty()) energy.emplace_back("velocity", offer(contents_.velocity, "velocity", "vector"));
        beside();
        read_protected();
        comment("`sim` alone means all grids of the files, which are all carved; `grids` names those that nodes take.");
        reader("vdb.read", "grids");
        comment(contents_.velocity.empty() ? "What must keep its look: waves, drops and edges of the surface."
                                           : "What must keep its look: waves and drops of the surface, and currents.");
        node("energy", "energy.surface", energy);
        masks(surface);
        box(surface);
        nodes_ += "\n";
        solver({});
        carve("carved", "remap.grids", "sim", {});
        node("out", "vdb.write", {{"source", "carved"}, {"path", "\"${out}\""}});
        others("sim", "carved", contents_.main, false);
    }

    void particles() {
        const bool beside = contents_.in_volume && !contents_.alone;
        Fields surface{{"points", "drops"}}, energy{{"surface", "surface"}};
        if (!contents_.velocity.empty()) {
            const auto velocity = offer(contents_.velocity, "velocity", "vector");
            surface.emplace_back("like", velocity);
            energy.emplace_back("velocity", velocity);
        } else {
            surface.emplace_back("voxel_size", fmt::format("{:.6g}", contents_.voxel));
        }
        read_protected();
        comment("The particles, and the grids beside them.");
        if (beside) reader("vdb.read", "grids");
        Fields drops{{"path", "\"${sim}\""}};
        if (contents_.in_volume) drops.emplace_back("grid", text_value(contents_.main));
        node("drops", "points.read", drops);
        comment("What must keep its look: waves and drops of the liquid's surface, and currents if there are velocities.");
        node("surface", "sdf.from_points", surface);
        node("energy", "energy.surface", energy);
        masks("surface");
        box("surface");
        nodes_ += "\n";
        solver({});
        if (!contents_.identified && !warps())
            comment("Vertex by vertex: a soft carve thins particles by their `id`, which these lack, and jitter follows it, too.");
        const auto hard = contents_.identified ? Fields{} : Fields{{"soft", "0"}};
        auto jitter = hard;
        if (!contents_.identified) jitter.emplace_back("jitter", "0");
        carve("moved", "remap.points", "drops", jitter);
        if (beside) carve("carved", "remap.grids", "sim", hard);
        Fields out{{"source", "moved"}, {"path", "\"${out}\""}};
        if (beside) out.insert(out.begin() + 1, {"beside", "carved"});
        node("out", "points.write", out);
        if (!request_.sheet.empty()) carve("level", "remap.grids", "surface", hard);
        others("surface", "level", "surface", false);
    }

    void image() {
        read_protected();
        comment("A grid for each channel, a voxel for each pixel, in the plane z = 0.");
        reader("image.read", "channels");
        comment("What must keep its look: edges and textures, by their square and as far as an eye compares.");
        node("edges", "energy.image", {{"source", "sim"}});
        node("sharp", "energy.remap", {{"energy", "edges"}, {"gamma", "2"}});
        node("energy", "field.filter", {{"field", "sharp"}, {"width", "5"}});
        masks("energy");
        box("energy");
        comment(
            "Seams pay for the edges that they leave in the picture, and little for what is black: a black background goes first, a black object mostly "
            "stays.");
        solver({{"field", "edges.intensity"}, {"field_weight", "5"}, {"spread", "1"}, {"empty", "0.2"}});
        carve("carved", "remap.grids", "sim", {{"soft", "1"}});
        node("out", "image.write", {{"source", "carved"}, {"path", "\"${out}\""}});
        others("sim", "carved", contents_.main, false);
    }

    void mesh() {
        read_protected();
        comment("The mesh, and the distance to its faces, in which seams are found.");
        node("sim", "mesh.read", {{"path", "\"${sim}\""}});
        node("surface", "sdf.from_mesh", {{"mesh", "sim"}, {"voxel_size", fmt::format("{:.6g}", contents_.voxel)}});
        comment("What must keep its look: where the surface curves.");
        node("energy", "energy.curvature", {{"surface", "surface"}});
        masks("surface");
        box("surface");
        nodes_ += "\n";
        solver({});
        carve("carved", "remap.mesh", "sim", {});
        node("out", "mesh.write", {{"source", "carved"}, {"path", "\"${out}\""}});
        if (!request_.sheet.empty()) carve("level", "remap.grids", "surface", {});
        others("surface", "level", "surface", false);
    }

    const DraftRequest& request_;
    const Contents contents_;
    std::vector<std::pair<std::string, std::string>> offered_;  ///< outputs of the reader, and what they are, as YAML
    std::vector<Protected> protected_;
    std::string nodes_;
};

}  // namespace

std::string draft_pipeline(const DraftRequest& request) { return Draft(request).text(); }

}  // namespace fluidcarve
