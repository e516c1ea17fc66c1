#include "nodes/seams/write.h"

#include "nodes/seams/seam_file.h"

namespace fluidcarve {

namespace {

struct SeamsWrite {
    struct Params {
        OutputPath path;
    };
    struct Ports {
        Ref<Seams> seams;
    };
    static void run(const Params& params, Ports& io, Context& context) { write_seams(params.path.at(0), *io.seams, context.provenance()); }
};

}  // namespace

NodeType seams_write() {
    return Declare<SeamsWrite>("seams.write", "Writes seams or a warp to one .vdb file. Any smaller number of the seams can be carved from it later.")
        .input("seams", &SeamsWrite::Ports::seams, "The seams, or a warp.")
        .required("path", &SeamsWrite::Params::path, "The file; one for all frames.");
}

}  // namespace fluidcarve
