#include "nodes/seams.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/seam/choice.h"
#include "carve/seam/seams.h"
#include "carve/time/frame_carve_promise.h"
#include "carve/volume/volume.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/ply.h"
#include "formats/geometry_file/wireframe.h"
#include "formats/seam_file/curves.h"
#include "formats/seam_file/seam_file.h"
#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"
#include "nodes/solving/foreseen.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

namespace fluidcarve {

namespace {

constexpr std::size_t most_frames = 8;  ///< frames that are measured

struct Choose {
    struct Params {};
    struct Ports {
        Ref<Seams> seams;
        Ref<FloatGrid> field;
        Ref<Lattice> lattice;
        Ref<Seams> chosen;
    };

    static constexpr auto nothing_to_choose =
        "`seams` is a warp, of which there is nothing to choose; connect the node that finds seams";

    static void foresee(const Params&, Outlook& ahead) {
        if (receives_warp(ahead)) ahead.fault(nothing_to_choose);
    }
    static NodeTraits traits(const Params&) { return {.takes = &takes}; }
    static bool takes(const Context& context) {
        const auto all = context.frames().size(), shown = std::min(all, most_frames);
        // The middle frame of each of `shown` equal parts.
        for (std::size_t n = 0; n < shown; ++n)
            if ((2 * n + 1) * all / (2 * shown) == context.t()) return true;
        return false;
    }

    void add(const Params&, const Ports& io, Context& context) {
        if (context.per_frame() && !takes(context)) return;
        const auto& seams = *io.seams;
        if (seams.warp) throw Failure(nothing_to_choose);
        if (seams.paired())
            throw Failure(
                "the seams come in pairs, between which the size stays, so that there is no rest "
                "for a warp; leave this node out, or `pair_window`");
        if (!choice_) choice_.emplace(io.seams);
        choice_->add(*io.lattice, *io.field, context.frame());
    }

    void finish(const Params&, Ports& io, Context& context) {
        const auto taken = choice_->best();
        const auto out = std::make_shared<Seams>(*io.seams);
        out->seams.erase(out->seams.begin() + static_cast<std::ptrdiff_t>(taken), out->seams.end());
        if (taken == 0) out->kind = Seams::Kind::remove;
        context.report("choice", {{"seams", taken},
                                  {"of", io.seams->size()},
                                  {"counts", choice_->counts()},
                                  {"distance", choice_->distances()}});
        io.chosen = out;
    }

private:
    std::optional<SeamChoice> choice_;
};

}  // namespace

NodeType seams_choose() {
    return Declare<Choose>(
               "seams.choose",
               "Keeps the first seams of a set, as many as look best together with a warp of what "
               "is left of the carve: all of them, some or none. How a carve looks is estimated by "
               "its similarity to the field, with even scaling in place of the warp. Slabs that "
               "are doubled are kept up to a third of the lattice's vertices: more repeats would "
               "stand side by side.")
        .input("seams", &Choose::Ports::seams, "Seams, as a solver found them; not in pairs.")
        .input("field", &Choose::Ports::field, "The grid that is seen, such as the density.")
        .input("lattice", &Choose::Ports::lattice, "The lattice in which the seams were found.")
        .output("chosen", &Choose::Ports::chosen,
                "The first seams. Carve them, and the warp that is found `after` them with `rest: "
                "true`.")
        .kept()
        .version(2);
}

namespace {

struct CurvesWrite {
    struct Params {
        OutputPath path;
        Auto<int> every;
    };
    struct Ports {
        Ref<Lattice> lattice;
        Ref<Seams> seams;
    };
    /// Seams differ from frame to frame.
    static NodeTraits traits(const Params&) { return {.animates = true}; }

    static void check(const Params& params, NodeCheck& check) {
        const auto ending = ending_of(params.path.text());
        if (ending != ".ply" && ending != ".obj")
            check.fault("path",
                        "writes .ply files, with colours, and .obj files: let the name end in one "
                        "of these");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const std::array every{params.every.value_or(every_by_default(io.seams->laterals())),
                               params.every.value_or(every_by_default(io.seams->slices()))};
        write_seam_curves(params.path.at(context.frame()),
                          seam_curves(*io.lattice, *io.seams, context.frame(), every),
                          context.provenance());
    }
};

}  // namespace

NodeType seams_curves() {
    return Declare<CurvesWrite>(
               "seams.curves",
               "Writes seams as curves, to view them beside the data: lines along each seam, at "
               "its place before the carve, one file per frame. PLY has a colour for each seam, on "
               "vertices and edges; OBJ has an object for each. Positions are those of the shot's "
               "world, with its axes.")
        .input("lattice", &CurvesWrite::Ports::lattice,
               "The lattice in which the seams were found.")
        .input("seams", &CurvesWrite::Ports::seams, "The seams.")
        .required(
            "path", &CurvesWrite::Params::path,
            "The file, .ply or .obj; with a frame token such as #### if there are several frames.")
        .param("every", &CurvesWrite::Params::every, Unit::vertices, between(1, most_vertices),
               "Distance between neighbouring curves, in vertices; 1 draws all. auto draws about "
               "16 along each dimension.");
}

namespace {

struct SeamsRead {
    struct Params {
        InputPath path;
    };
    struct Ports {
        Ref<Seams> seams;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (params.path.per_frame())
            check.fault("path",
                        "parameter 'path' can't have a frame token: one file holds the seams of "
                        "all frames");
    }
    static void survey(const Params& params, Survey& survey) {
        if (!params.path.exists())
            survey.missing(survey.frames().front(), params.path.at(0) + " does not exist");
    }
    static void run(const Params& params, Ports& io, Context&) {
        io.seams = std::make_shared<Seams>(read_seams(params.path.at(0)));
    }
    /// The effect of a file of seams of frames, if the file exists.
    static std::optional<FrameCarvePromise> in_time(const Params& params) {
        return params.path.exists() ? frames_carved_by(params.path.at(0)) : std::nullopt;
    }
};

}  // namespace

NodeType seams_read() {
    return Declare<SeamsRead>("seams.read",
                              "Reads seams or a warp from a file that seams.write wrote.")
        .required("path", &SeamsRead::Params::path, "The file; one for all frames.")
        .promises(&SeamsRead::in_time, only_remapped)
        .output("seams", &SeamsRead::Ports::seams,
                "The seams, in the order in which they were found; or the warp.");
}

namespace {

struct SeamsWrite {
    struct Params {
        OutputPath path;
        /// Seams of frames are written as all others are.
        std::optional<FrameCarvePromise> in_time;
    };
    struct Ports {
        Ref<Seams> seams;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        write_seams(params.path.at(0), *io.seams, context.provenance());
    }
};

}  // namespace

NodeType seams_write() {
    return Declare<SeamsWrite>("seams.write",
                               "Writes seams or a warp to one .vdb file. Any smaller number of the "
                               "seams can be carved from it later.")
        .input("seams", &SeamsWrite::Ports::seams, "The seams, or a warp.")
        .learns("seams", &SeamsWrite::Params::in_time)
        .required("path", &SeamsWrite::Params::path, "The file; one for all frames.");
}

}  // namespace fluidcarve
