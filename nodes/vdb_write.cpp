#include "carve/grid/named_grids.h"
#include "formats/vdb/provenance_metadata.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/params/file_sequence.h"
#include "nodes/params/placement_params.h"
#include "nodes/vdb.h"

namespace fluidcarve {

template <>
struct ChoiceNames<Codec> {
    static constexpr std::array names = {
        std::pair{"as_read", Codec::as_read}, std::pair{"blosc", Codec::blosc},
        std::pair{"zip", Codec::zip}, std::pair{"none", Codec::none}};
};

namespace {

/// Sets whether the grids of some names are written with half floats.
void stored_as_half(Volume& volume, const std::vector<std::string>& names, bool half) {
    const auto named = grids_named(volume, names);
    for (auto& each : volume.grids) {
        if (!named.contains(&each.header()) || each.header().saveFloatAsHalf() == half) continue;
        const auto changed = openvdb::ConstPtrCast<openvdb::GridBase>(each.grid()->copyGrid());
        changed->setSaveFloatAsHalf(half);
        each = changed;
    }
}

struct VdbWrite {
    struct Params {
        OutputPath path;
        Codec compression = Codec::as_read;
        std::vector<std::string> half, full;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Volume> source;
    };

    static void run(const Params& params, Ports& io, Context& context) {
        const auto placement = stated_placement(params);
        auto volume = *io.source;
        stored_as_half(volume, params.half, true);
        stored_as_half(volume, params.full, false);
        set_provenance(volume.metadata, context.provenance());
        write_vdb(params.path.at(context.frame()), volume, params.compression,
                  placement ? &*placement : nullptr);
    }
};

}  // namespace

NodeType vdb_write() {
    return Declare<VdbWrite>("vdb.write",
                             "Writes OpenVDB files: all grids of a volume, or one grid. A file "
                             "appears whole or not at all.")
        .input("source", &VdbWrite::Ports::source,
               "The grids to write. Nothing is changed; half floats stay half, unless `full` names "
               "them.")
        .required("path", &VdbWrite::Params::path,
                  "File; with a frame token such as #### if the source comes per frame. Missing "
                  "folders are made.")
        .param("compression", &VdbWrite::Params::compression,
               "as_read: that of the source's file, or blosc if it has none. All are lossless.")
        .param("half", &VdbWrite::Params::half,
               "Names of grids, or patterns, whose floats are written in 16 bits: half the size, "
               "to three digits, up to 65504.")
        .param("full", &VdbWrite::Params::full,
               "Names of grids, or patterns, whose floats are written in 32 bits, though the "
               "source had them in 16.")
        .param("translate", &VdbWrite::Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of each grid's reader; grids made by "
               "nodes stay in the shot's world.")
        .param("scale", &VdbWrite::Params::scale, Unit::none, between(1e-6, 1e6), undone_scale_doc);
}

}  // namespace fluidcarve
