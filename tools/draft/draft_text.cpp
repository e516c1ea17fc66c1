#include "tools/draft/draft_text.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/base/numbers.h"
#include "carve/base/words.h"
#include "formats/mesh_file/mesh_file.h"
#include "graph/text/yaml_text.h"
#include "graph/types/param.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

bool plain_name(const std::string& name) {
    const auto word = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
    return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
           std::ranges::all_of(name, word);
}

namespace {
constexpr auto new_length = "\"${length}\"";
}

void DraftText::volume_reader() {
    comment(
        "`sim` alone means all grids of the files, which are all carved; `grids` names those "
        "that nodes take.");
    reader("vdb.read", "grids");
}

void DraftText::carve_volume() {
    carve("carved", "remap.grids", "sim", {});
    node("out", "vdb.write", {{"source", "carved"}, {"path", "\"${out}\""}});
}

void DraftText::fog() {
    const bool fire = contents_.matter == Matter::fire,
               both = fire && contents_.flame != contents_.main;
    auto field = offer(contents_.main, "main", contents_.vectors ? "vector" : "float");
    const auto flame = both ? offer(contents_.flame, "flame", "float") : field;
    beside();
    read_protected();
    volume_reader();
    if (contents_.vectors)
        node("length", "field.magnitude", {{"vectors", std::exchange(field, "length")}});
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
    comment(
        fmt::format("`field` is what is looked at: seams pay for the edges that they leave in "
                    "it. More of the carve goes through the {} with a higher `empty`.",
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
    carve_volume();
    others("sim", "carved", fire ? contents_.flame : contents_.main);
}

void DraftText::level_set() {
    const auto surface = offer(contents_.main, "surface", "float");
    Fields energy{{"surface", surface}};
    if (!contents_.velocity.empty())
        energy.emplace_back("velocity", offer(contents_.velocity, "velocity", "vector"));
    beside();
    read_protected();
    volume_reader();
    comment(contents_.velocity.empty()
                ? "What must keep its look: waves, drops and edges of the surface."
                : "What must keep its look: waves and drops of the surface, and currents.");
    node("energy", "energy.surface", energy);
    masks(surface);
    box(surface);
    nodes_ += "\n";
    solver({});
    carve_volume();
    others("sim", "carved", contents_.main);
}

void DraftText::particles() {
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
    if (contents_.in_volume) drops.emplace_back("grid", yaml_scalar(contents_.main));
    node("drops", "points.read", drops);
    comment(
        "What must keep its look: waves and drops of the liquid's surface, and currents if "
        "there are velocities.");
    node("surface", "sdf.from_points", surface);
    node("energy", "energy.surface", energy);
    masks("surface");
    box("surface");
    nodes_ += "\n";
    solver({});
    if (!contents_.identified && !warps())
        comment(
            "Vertex by vertex: a soft carve thins particles by their `id`, which these lack, "
            "and jitter follows it, too.");
    const auto hard = contents_.identified ? Fields{} : Fields{{"soft", "0"}};
    auto jitter = hard;
    if (!contents_.identified) jitter.emplace_back("jitter", "0");
    carve("moved", "remap.points", "drops", jitter);
    if (beside) carve("carved", "remap.grids", "sim", hard);
    Fields out{{"source", "moved"}, {"path", "\"${out}\""}};
    if (beside) out.insert(out.begin() + 1, {"beside", "carved"});
    node("out", "points.write", out);
    if (!request_.sheet.empty()) carve("level", "remap.grids", "surface", hard);
    others("surface", "level", "surface");
}

void DraftText::image() {
    read_protected();
    comment("A grid for each channel, a voxel for each pixel, in the plane z = 0.");
    reader("image.read", "channels");
    comment(
        "What must keep its look: edges and textures, by their square and as far as an eye "
        "compares.");
    node("edges", "energy.image", {{"source", "sim"}});
    node("sharp", "energy.remap", {{"energy", "edges"}, {"gamma", "2"}});
    node("energy", "field.filter", {{"field", "sharp"}, {"width", "5"}});
    masks("energy");
    box("energy");
    comment(
        "Seams pay for the edges that they leave in the picture, and little for what is black: a "
        "black background goes first, a black object mostly stays.");
    solver(
        {{"field", "edges.intensity"}, {"field_weight", "5"}, {"spread", "1"}, {"empty", "0.2"}});
    carve("carved", "remap.grids", "sim", {{"soft", "1"}});
    node("out", "image.write", {{"source", "carved"}, {"path", "\"${out}\""}});
    others("sim", "carved", contents_.main);
}

void DraftText::mesh() {
    read_protected();
    comment("The mesh, and the distance to its faces, from which the carve is found.");
    node("sim", "mesh.read", {{"path", "\"${sim}\""}});
    node("surface", "sdf.from_mesh",
         {{"mesh", "sim"}, {"voxel_size", fmt::format("{:.6g}", contents_.voxel)}});
    comment("What must keep its look: where the surface curves.");
    node("energy", "energy.curvature", {{"surface", "surface"}});
    masks("surface");
    box("surface");
    if (warps()) nodes_ += "\n";
    else comment("Seams far apart, carved softly: sharp ones would be creases in the surface.");
    solver({{"spread", "8"}});
    const Fields soft{{"soft", "12"}};
    carve("carved", "remap.mesh", "sim", soft);
    node("out", "mesh.write", {{"source", "carved"}, {"path", "\"${out}\""}});
    if (!request_.sheet.empty()) carve("level", "remap.grids", "surface", soft);
    others("surface", "level", "surface");
}

void DraftText::paced_volume() {
    Fields pace{{"source", "sim"}};
    if (!contents_.velocity.empty())
        pace.emplace_back("velocity", offer(contents_.velocity, "velocity", "vector"));
    pace.emplace_back("frames", new_length);
    comment("`sim` alone means all grids of the files.");
    reader("vdb.read", "grids");
    comment(contents_.velocity.empty()
                ? "What follows has the new frames. The files have no velocity, so that what is "
                  "seen tells where things move."
                : "What follows has the new frames. The velocity says where things move, and is "
                  "scaled by the speed.");
    node("paced", "time.retime", pace);
    node("out", "vdb.write", {{"source", "paced"}, {"path", "\"${out}\""}});
    paced_sheet("paced",
                yaml_scalar(contents_.matter == Matter::fire ? contents_.flame : contents_.main));
}

void DraftText::paced_particles() {
    const bool beside = contents_.in_volume && !contents_.alone;
    Fields pace{{"source", "sim"}}, drops{{"path", "\"${sim}\""}};
    if (beside && !contents_.velocity.empty())
        pace.emplace_back("velocity", offer(contents_.velocity, "velocity", "vector"));
    pace.emplace_back("frames", new_length);
    comment("The particles, and the grids beside them.");
    if (beside) reader("vdb.read", "grids");
    if (contents_.in_volume) drops.emplace_back("grid", yaml_scalar(contents_.main));
    node("drops", "points.read", drops);
    comment(contents_.identified
                ? "What follows has the new frames. Particles go their ways by their `id`."
                : "What follows has the new frames. Particles lack an `id`, so that those of the "
                  "nearer frame move on.");
    node("moved", "time.retime", {{"source", "drops"}, {"frames", new_length}});
    if (beside) node("paced", "time.retime", pace);
    Fields out{{"source", "moved"}, {"path", "\"${out}\""}};
    if (beside) out.insert(out.begin() + 1, {"beside", "paced"});
    node("out", "points.write", out);
    if (!request_.sheet.empty())
        node("surface", "sdf.from_points",
             {{"points", "moved"}, {"voxel_size", fmt::format("{:.6g}", contents_.voxel)}});
    paced_sheet("surface", "surface");
}

void DraftText::paced_mesh() {
    comment("The mesh of each frame.");
    node("sim", "mesh.read", {{"path", "\"${sim}\""}});
    comment("What follows has the new frames. Vertices move where the faces stay the same.");
    node("paced", "time.retime", {{"source", "sim"}, {"frames", new_length}});
    node("out", "mesh.write", {{"source", "paced"}, {"path", "\"${out}\""}});
    if (!request_.sheet.empty())
        node("surface", "sdf.from_mesh",
             {{"mesh", "paced"}, {"voxel_size", fmt::format("{:.6g}", contents_.voxel)}});
    paced_sheet("surface", "surface");
}

void DraftText::require_time() const {
    if (request_.frames.empty())
        throw Failure(
            "--axis t: one file has no frames to take or to add; give a sequence, such as "
            "smoke.####.vdb");
    if (request_.solver == "warp.solve")
        throw Failure(
            "--axis t: a warp has no time: leave --warp out; time.retime makes all of a sequence "
            "faster or slower");
    if (fraction())
        throw Failure(fmt::format("--axis t: frames are whole, not {}", request_.count));
    if (std::abs(std::atof(request_.count.c_str())) > 1e6)
        throw Failure(fmt::format("--axis t: {} frames are too many", request_.count));
}

int DraftText::frame_count() const {
    std::string fault;
    const auto frames = FrameSet::parse(request_.frames, fault);
    return frames ? static_cast<int>(frames->frames().size()) : 0;
}

int DraftText::frames_more() const {
    return Count{std::atof(request_.count.c_str()), request_.count.ends_with('%')}.of(
        frame_count());
}

bool DraftText::paced() const {
    const bool smoke = contents_.matter == Matter::smoke || contents_.matter == Matter::fire;
    if (!smoke) return contents_.matter != Matter::image;
    return frames_more() > frame_count() - 2;
}

std::string DraftText::at_another_pace() {
    if (!request_.solver.empty() || !request_.protect.empty() || !request_.seams.empty() ||
        !request_.solver_fields.empty() || !request_.remap_fields.empty())
        throw Failure(
            "--axis t changes the speed of level sets, particles and meshes, and of a sequence "
            "that becomes twice as long, by time.retime: leave out --solver, --protect, --seams "
            "and all other options for seams");
    const int before = frame_count(), after = before + frames_more();
    if (after < 2)
        throw Failure(fmt::format("--axis t: {} of {} frames leaves {}; leave two at least",
                                  request_.count, before, after));
    if (contents_.matter == Matter::particles) paced_particles();
    else if (contents_.matter == Matter::mesh) paced_mesh();
    else paced_volume();
    return fmt::format(
               "# {} in time: {} frames become {}.\n# Another length, other files: --set "
               "length=48 --set sim=FILES --set out=FILES\n"
               "fluidcarve: 1\n\nparams:\n",
               after < before ? "Shorter" : "Longer", before, after) +
           path_param("sim", request_.input, "Input sequence.") +
           param("length", "int", std::to_string(after), "Frames of the result.") +
           path_param("out", request_.out, "The sequence at its new pace.") +
           path_param("sheet", request_.sheet, "Some frames in one picture.") + frames() +
           "\nnodes:" + nodes_;
}

void DraftText::read_protected() {
    for (const auto& each : request_.protect) {
        const auto sign = each.rfind('=');
        const bool is_range = sign != std::string::npos &&
                              parse_number(std::string_view(each).substr(sign + 1)).has_value();
        if (!is_range) {
            const auto ending = ending_of(each);
            const auto meshes = all_mesh_endings();
            const bool mesh = std::ranges::find(meshes, ending) != meshes.end();
            const bool picture = contents_.matter == Matter::image;
            if (ending.empty() || mesh == picture)
                throw Failure(fmt::format(
                    "--protect: '{}' is neither GRID=VALUE, such as density=0.7, nor {}", each,
                    picture ? "an image, white where no seam may pass"
                            : fmt::format("a closed mesh ({})", fmt::join(meshes, ", "))));
            protected_.push_back({{}, each});
            continue;
        }
        auto grid = each.substr(0, sign);
        // Of several grids of one name the first.
        if (std::ranges::find(contents_.floats, grid) == contents_.floats.end() &&
            std::ranges::find(contents_.floats, grid + "[0]") != contents_.floats.end())
            grid += "[0]";
        if (std::ranges::find(contents_.floats, grid) == contents_.floats.end())
            throw Failure(
                fmt::format("--protect: there is no float grid '{}' in every file of {}{}", grid,
                            request_.input,
                            contents_.floats.empty() ? "" : did_you_mean(grid, contents_.floats)));
        protected_.push_back({offer(grid, fmt::format("protect{}", protected_.size() + 1), "float"),
                              each.substr(sign + 1)});
    }
}

std::string draft_pipeline(const DraftRequest& request) { return DraftText(request).text(); }

}  // namespace fluidcarve
