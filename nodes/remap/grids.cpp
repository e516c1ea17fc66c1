#include "nodes/remap/grids.h"

#include "nodes/remap/remap.h"

#include <algorithm>
#include <cstdlib>

namespace fluidcarve {

template <>
struct ChoiceNames<Interpolation> {
    static constexpr std::array names = {std::pair{"linear", Interpolation::linear}, std::pair{"quadratic", Interpolation::quadratic},
                                         std::pair{"cubic", Interpolation::cubic}};
};

namespace {

struct RemapGrids {
    struct Params {
        Auto<Count> count;
        Interpolation interpolation = Interpolation::linear;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Volume> volume;
    };

    static std::optional<std::size_t> count_of(const Params& params, const Seams& last) {
        if (!params.count) return std::nullopt;
        const int count = params.count->of(last.carved());
        if (count < 0 && last.kind == Seams::Kind::insert) throw Failure(fmt::format("count {} removes, but the seams insert", count));
        return static_cast<std::size_t>(std::abs(count));
    }

    /// A source that is the same in all frames is carved once; seams that move would each want another result.
    static void require_still(const Seams& seams) {
        const auto columns = static_cast<std::ptrdiff_t>(seams.columns_per_frame());
        for (const auto* const window : {&seams.seams, &seams.pairs})
            for (const auto& seam : *window)
                if (!std::equal(seam.at.begin() + columns, seam.at.end(), seam.at.begin()))
                    throw Failure("the source is one file for all frames, but the seams change from frame to frame; read it by a path with a frame token");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        if (!context.per_frame())
            for (const auto& seams : io.seams) require_still(*seams);
        const CarveMap map(*io.lattice, io.seams, context.frame(), count_of(params, *io.seams.back()));
        if (map.empty()) io.volume = io.source;
        else io.volume = std::make_shared<Volume>(carve_volume(*io.source, *io.lattice, map, params.interpolation));
    }
};

}  // namespace

NodeType remap_grids() {
    return Declare<RemapGrids>("remap.grids", "Carves seams from the grids of a volume, or inserts them, in one go from the untouched input.")
        .input("source", &RemapGrids::Ports::source, "The volume, or one grid, to carve.")
        .input("lattice", &RemapGrids::Ports::lattice, "The lattice in which the seams were found.")
        .input("seams", &RemapGrids::Ports::seams, "Seams, or a list of seam sets in the order of carving.")
        .param("count", &RemapGrids::Params::count, Unit::seams, any_number(),
               "Only the first so many seams, of the last set if there are several; the sign may be left out. Auto is all.")
        .param("interpolation", &RemapGrids::Params::interpolation, "Between voxels, where the lattice's vertices are not voxels.")
        .output("volume", &RemapGrids::Ports::volume, "The source carved: same grids, transforms and metadata.");
}

}  // namespace fluidcarve
