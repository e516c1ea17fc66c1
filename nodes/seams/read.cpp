#include "nodes/seams/read.h"

#include "nodes/seams/seam_file.h"

namespace fluidcarve {

namespace {

struct SeamsRead {
    struct Params {
        InputPath path;
    };
    struct Ports {
        Ref<Seams> seams;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (params.path.per_frame()) check.fault("path", "parameter 'path' can't have a frame token: one file holds the seams of all frames");
    }
    static void survey(const Params& params, Survey& survey) {
        if (!params.path.exists()) survey.missing(survey.frames().front(), params.path.at(0) + " does not exist");
    }
    static void run(const Params& params, Ports& io, Context&) { io.seams = std::make_shared<Seams>(read_seams(params.path.at(0))); }
};

}  // namespace

NodeType seams_read() {
    return Declare<SeamsRead>("seams.read", "Reads seams or a warp from a file that seams.write wrote.")
        .required("path", &SeamsRead::Params::path, "The file; one for all frames.")
        .output("seams", &SeamsRead::Ports::seams, "The seams, in the order in which they were found; or the warp.");
}

}  // namespace fluidcarve
