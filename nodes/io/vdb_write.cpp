#include "nodes/io/vdb_write.h"

#include "nodes/io/provenance_metadata.h"
#include "nodes/io/vdb_file.h"

namespace fluidcarve {

template <>
struct ChoiceNames<Codec> {
    static constexpr std::array names = {std::pair{"as_read", Codec::as_read}, std::pair{"blosc", Codec::blosc}, std::pair{"zip", Codec::zip},
                                         std::pair{"none", Codec::none}};
};

namespace {

struct VdbWrite {
    struct Params {
        OutputPath path;
        Codec compression = Codec::as_read;
        Auto<Vec3> translate;
        Auto<double> scale;
    };
    struct Ports {
        Ref<Volume> source;
    };

    static void run(const Params& params, Ports& io, Context& context) {
        const auto at = params.translate.value_or(Vec3{});
        const Placement placement{openvdb::Vec3d(at[0], at[1], at[2]), params.scale.value_or(1)};
        auto volume = *io.source;
        set_provenance(volume.metadata, context.provenance());
        write_vdb(params.path.at(context.frame()), volume, params.compression, params.translate || params.scale ? &placement : nullptr);
    }
};

}  // namespace

NodeType vdb_write() {
    return Declare<VdbWrite>("vdb.write", "Writes OpenVDB files: all grids of a volume, or one grid. A file appears whole or not at all.")
        .input("source", &VdbWrite::Ports::source, "The grids to write. Nothing is changed; half floats stay half.")
        .required("path", &VdbWrite::Params::path, "File; with a frame token such as #### if the source comes per frame. Missing folders are made.")
        .param("compression", &VdbWrite::Params::compression, "as_read: that of the source's file, or blosc if it has none. All are lossless.")
        .param("translate", &VdbWrite::Params::translate, Unit::world, any_number(),
               "The placement of a reader to undo. Auto: that of each grid's reader; grids made by nodes stay in the shot's world.")
        .param("scale", &VdbWrite::Params::scale, Unit::none, between(1e-6, 1e6), "The same for a reader's `scale`.");
}

}  // namespace fluidcarve
