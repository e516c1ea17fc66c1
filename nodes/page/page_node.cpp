#include "nodes/page/page_node.h"

#include "carve/base/words.h"
#include "carve/remap/joining.h"
#include "formats/file/output_file.h"
#include "nodes/page/page_html.h"
#include "nodes/page/page_scene.h"
#include "nodes/params/carve_inputs.h"
#include "nodes/params/file_sequence.h"
#include "nodes/params/join_params.h"
#include "nodes/params/rim.h"
#include "nodes/preview/shown_frames.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace fluidcarve {

namespace {

constexpr int default_frames = 8;

struct PreviewPage {
    struct Params : JoinParams {
        Auto<std::string> grid;
        Auto<int> frames;
        Auto<int> voxels;
        Auto<Count> count;
        Rim rim = Rim::cut;
        double rim_fade = 8;
        std::string setting = "count";
        OutputPath path;
    };
    struct Ports {
        Ref<Volume> before;
        Optional<FloatGrid> energy;
        Optional<Lattice> lattice;
        Optional<Rig> rig;
        OptionalNamed<AnyGrid> masks;
        OptionalList<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_rim_fade(params.rim, check);
        check_join(params, check);
        if (check.connections("seams") > 0 && check.connections("lattice") == 0)
            check.fault("seams",
                        "'seams' need the lattice in which they were found: connect 'lattice'");
        if (check.stated("path") && ending_of(params.path.text()) != ".html")
            check.fault("path", "'path' must end in .html; a page is an HTML file");
    }

    /// Reports a missing grid before the run starts.
    static void survey(const Params& params, Survey& survey) {
        if (!params.grid) return;
        const auto total = survey.frames().size();
        survey_grids(
            "before", survey,
            [&](std::size_t t) {
                return is_shown(t, total, params.frames.value_or(default_frames));
            },
            [&](const auto& there) { require_grid("before", *params.grid, there); });
    }

    static bool takes(const Params& params, const Context& context) {
        return is_shown(context.t(), context.frames().size(),
                        params.frames.value_or(default_frames));
    }
    static NodeTraits traits(const Params& params) {
        return {.takes = [&params](const Context& context) { return takes(params, context); }};
    }

    void add(const Params& params, const Ports& io, Context& context) {
        if (context.per_frame() && !takes(params, context)) return;
        PageFrame frame;
        frame.number = context.frame();
        frame.before = grid_of(*io.before, params.grid);
        frame.energy = io.energy;
        frame.lattice = io.lattice;
        frame.rig = io.rig;
        for (const auto& [name, mask] : io.masks) frame.masks.emplace_back(name, mask->grid);
        frame.seams = io.seams;
        if (frame.lattice && frame.lattice->closed_form)
            context.warn(
                "the page carves by the lattice's true inverse, not by `mapping: closed_form`");
        // Refuses seams of another lattice, and a count or a softness that the carve refuses.
        if (!frame.seams.empty())
            carve_map(*frame.lattice, frame.seams, params.count, frame.number, params);
        frames_.push_back(std::move(frame));
    }

    void finish(const Params& params, Ports&, Context& context) {
        if (frames_.empty()) throw Failure("none of the frames to show was computed");
        const auto request = request_of(params, context);
        const auto scene = page_scene(request, frames_);
        const auto page = params.frames
                              ? SmallPage{page_html(request.title, {scene}), frames_.size()}
                              : small_page(request.title, {scene});
        require_page_size(page.html, fmt::format("lower `frames` ({}) or `voxels`", page.frames));
        if (page.frames < frames_.size())
            context.warn(fmt::format(
                "the page shows {} of {} frames, to stay small; state `frames` for more",
                page.frames, frames_.size()));
        OutputFile::write(params.path.at(context.frame()), page.html);
    }

private:
    static openvdb::GridBase::ConstPtr grid_of(const Volume& volume,
                                               const Auto<std::string>& name) {
        const auto shows = [](const auto& grid) {
            return grid &&
                   (grid->template isType<FloatGrid>() || grid->template isType<VectorGrid>());
        };
        if (name) {
            require_grid("before", *name, volume.given_names());
            const auto grid = volume.find(*name);
            if (!shows(grid))
                throw Failure(fmt::format(
                    "grid '{}' holds {} values; a page shows grids of floats or vectors", *name,
                    grid->valueType()));
            return grid;
        }
        if (const auto density = volume.find("density"); shows(density)) return density;
        for (const auto& each : volume.grids)
            if (const auto grid = each.grid(); shows(grid)) return grid;
        throw Failure(fmt::format("'before' has no grid of floats or vectors to show; it has: {}",
                                  volume.names()));
    }

    PageRequest request_of(const Params& params, const Context& context) const {
        PageRequest out;
        out.grid = frames_.front().before->getName();
        out.title = out.grid;
        for (const auto& [name, text] : context.provenance())
            if (name == "fluidcarve_pipeline") out.title = text;
        out.setting = params.setting;
        if (params.voxels) out.voxels = out.flat_voxels = *params.voxels;
        if (const auto& seams = frames_.front().seams; !seams.empty())
            out.count =
                params.count
                    ? static_cast<std::size_t>(std::abs(params.count->of(seams.back()->before())))
                    : seams.back()->seams.size();
        // The page squeezes joins that the remaps fade.
        if (const auto& seams = frames_.front().seams; !seams.empty()) {
            out.softness = softness_of(params, *seams.back());
            out.softness.fade = 0;
        }
        out.rim_fade = params.rim == Rim::fade ? params.rim_fade : 0;
        return out;
    }

    std::vector<PageFrame> frames_;
};

}  // namespace

NodeType preview_page() {
    return declare_join(
        Declare<PreviewPage>(
            "preview.page",
            "A page for a browser, to choose the count by eye: the sequence before and after, with "
            "a slider. It is one file that loads nothing else. The page carves by itself, from the "
            "seams, as remap.grids does with linear interpolation. Without `seams` it shows where "
            "rig, lattice, masks and energy lie.")
            .input("before", &PreviewPage::Ports::before,
                   "The grids before the carve, usually as read.")
            .input("energy", &PreviewPage::Ports::energy,
                   "The energy in which the seams are found, to show over `before`.")
            .input("lattice", &PreviewPage::Ports::lattice,
                   "The lattice in which the seams were found, or one to place. Cells that fold "
                   "are red.")
            .input("rig", &PreviewPage::Ports::rig, "A rig to draw, mostly that of the lattice.")
            .input("masks", &PreviewPage::Ports::masks,
                   "Masks to show, or the active voxels of any grid, by name, such as what a "
                   "solver protects: `masks: {protect: face}`.")
            .input("seams", &PreviewPage::Ports::seams,
                   "Seams, or a list of seam sets in the order of carving. The slider is for the "
                   "last one.")
            .param("grid", &PreviewPage::Params::grid,
                   "Name of the grid to show. Vectors are shown by their length. auto is "
                   "`density`, or the first grid of floats or vectors.")
            .param("frames", &PreviewPage::Params::frames, Unit::frames, between(1, 240),
                   "Number of frames to show, in even steps from the first to the last; 1: the "
                   "middle one. They stay in memory until the last of them. auto is 8, or fewer if "
                   "the page had more than 2 MB. A page above 20 MB is refused.")
            .param("voxels", &PreviewPage::Params::voxels, Unit::voxels, between(8, 2048),
                   "Most voxels along an axis. Of a larger grid each voxel shows the mean of "
                   "several, and the carve reads these. auto is 96, and 640 for a picture, which "
                   "is one voxel thick.")
            .param("count", &PreviewPage::Params::count, Unit::seams, any_number(),
                   "Number of seams that the page shows at first, as remap.grids takes it.")
            .param("rim", &PreviewPage::Params::rim, "As remap.grids takes it.")
            .param("rim_fade", &PreviewPage::Params::rim_fade, Unit::vertices, between(1, 10000),
                   rim_fade_doc)
            .param("setting", &PreviewPage::Params::setting,
                   "What sets the count, as the page writes it for the command line: `count` makes "
                   "`--set count=-17`, `seams.count` the field of a node.")
            .required(
                "path", &PreviewPage::Params::path,
                "File that ends in .html, one for the whole sequence. Missing folders are made."));
}

}  // namespace fluidcarve
