#include "nodes/seams.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/seam/carve_map.h"
#include "carve/seam/seams.h"
#include "carve/seam/similarity.h"
#include "carve/time/time_map.h"
#include "carve/volume/volume.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/ply.h"
#include "formats/geometry_file/wireframe.h"
#include "formats/seam_file/curves.h"
#include "formats/seam_file/seam_file.h"
#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace fluidcarve {

namespace {

constexpr std::size_t most_frames = 8;  ///< that are looked at
constexpr int most_rows = 128;          ///< of a plane
constexpr int most_planes = 32;         ///< of a frame

constexpr std::size_t parts =
    8;  ///< of the seams: so many numbers of seams are compared, and none at all

constexpr float visible_share = 0.02f;  ///< of the greatest value of a frame: less is empty space
constexpr Softness softness{3, 0};      ///< as carves have it unless they say otherwise

/// How many seams of a set may be chosen: all; of slabs that are doubled, as many whole ones as a
/// third of the lattice's vertices holds, since more repeats stand side by side.
std::size_t most_of(const Seams& set) {
    if (!set.thick() || set.kind == Seams::Kind::remove) return set.size();
    const int third = set.carved() / 3;
    return std::min(set.size(), static_cast<std::size_t>(third - third % set.thickness));
}

/// The numbers of seams that are compared: from none to as many as may be chosen, in whole slabs.
std::vector<std::size_t> counts_of(const Seams& set) {
    const auto most = most_of(set), slab = static_cast<std::size_t>(set.thickness),
               slabs = (most + slab - 1) / slab;
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n <= parts; ++n)
        if (const auto count = std::min(most, (n * slabs + parts / 2) / parts * slab);
            out.empty() || count > out.back())
            out.push_back(count);
    return out;
}

/// What is compared of one number of seams: each patch of the result with the input, and the other
/// way round.
struct Distances {
    PatchSum of_result, of_input;
    double sum() const { return of_result.root_mean() + of_input.root_mean(); }
};

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
        if (warp_told(ahead)) ahead.fault(nothing_to_choose);
    }
    static bool wants(const Params&, const Context& context) {
        const auto all = context.frames().size(), shown = std::min(all, most_frames);
        // The middle frame of each of so many parts.
        for (std::size_t n = 0; n < shown; ++n)
            if ((2 * n + 1) * all / (2 * shown) == context.place()) return true;
        return false;
    }

    void add(const Params& params, const Ports& io, Context& context) {
        if (context.per_frame() && !wants(params, context)) return;
        const auto& seams = *io.seams;
        if (seams.warp) throw Failure(nothing_to_choose);
        if (seams.paired())
            throw Failure(
                "the seams come in pairs, between which the size stays, so that there is no rest "
                "for a warp; leave this node out, or `pair_window`");
        if (counts_.empty()) {
            counts_ = counts_of(seams);
            distances_.resize(counts_.size());
        }
        if (seams.size() > 0) compare(io, context.frame());
    }

    void finish(const Params&, Ports& io, Context& context) {
        std::size_t best = 0;
        std::vector<double> shares;
        for (std::size_t n = 0; n < counts_.size(); ++n) {
            const double even = distances_.front().sum();
            shares.push_back(even > 0 ? distances_[n].sum() / even : 1);
            if (shares[n] < shares[best]) best = n;
        }
        const auto taken = counts_.at(best);
        const auto out = std::make_shared<Seams>(*io.seams);
        out->seams.erase(out->seams.begin() + static_cast<std::ptrdiff_t>(taken), out->seams.end());
        if (taken == 0) out->kind = Seams::Kind::remove;
        context.report("choice", {{"seams", taken},
                                  {"of", io.seams->size()},
                                  {"counts", counts_},
                                  {"distance", shares}});
        io.chosen = out;
    }

private:
    void compare(const Ports& io, int frame) {
        const auto& set = *io.seams;
        const int all = static_cast<int>(set.size()), after = set.carved() + growth(set.kind, all);
        const auto planes = planes_of(set, *io.lattice, *io.field);
        float highest = 0;
        for (const auto& plane : planes)
            highest = std::max(highest, *std::ranges::max_element(plane.source.values));
        const float visible = visible_share * highest;
        std::vector<CarveMap> maps;
        for (const auto count : counts_)
            maps.emplace_back(*io.lattice, std::vector<Ref<Seams>>{io.seams}, frame, count,
                              softness);
        std::vector<Distances> found(maps.size() * planes.size());
        tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t n) {
            const auto& plane = planes[n % planes.size()];
            const auto result = carved(plane, maps[n / planes.size()], after);
            found[n] = {nearest_patches(result, plane.source, visible, all),
                        nearest_patches(plane.source, result, visible, all)};
        });
        for (std::size_t n = 0; n < found.size(); ++n) {
            distances_[n / planes.size()].of_result += found[n].of_result;
            distances_[n / planes.size()].of_input += found[n].of_input;
        }
    }

    /// A part of a plane of the lattice.
    struct Plane {
        int slice, first_row;
        PlaneSamples source;
    };

    /// Planes at even distances, the middle rows of each.
    static std::vector<Plane> planes_of(const Seams& set, const Lattice& lattice,
                                        const FloatGrid& field) {
        const int slices = set.slices(), count = std::min(slices, most_planes),
                  rows = std::min(set.lateral(), most_rows);
        std::vector<Plane> out;
        for (int n = 0; n < count; ++n)
            out.push_back({(2 * n + 1) * slices / (2 * count), (set.lateral() - rows) / 2,
                           PlaneSamples(set.carved(), rows)});
        tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t n) {
            auto& [slice, first_row, source] = out[n];
            const openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler> sample(field);
            for (int row = 0; row < source.rows; ++row)
                for (int u = 0; u < source.width; ++u) {
                    const auto at = vertex_of<double>(set.axis, u, first_row + row, slice);
                    source.row(row)[u] =
                        sample.wsSample(lattice.position(openvdb::Vec3d(at.data())));
                }
        });
        return out;
    }

    /// A plane carved by some seams, and scaled evenly from there on to a number of vertices.
    static PlaneSamples carved(const Plane& plane, const CarveMap& map, int width) {
        const auto& source = plane.source;
        PlaneSamples out(width, source.rows);
        const CarveStep* const step = map.empty() ? nullptr : &map.steps().front();
        const int left = step ? step->after() : source.width;
        const double scale = width > 1 ? static_cast<double>(left - 1) / (width - 1) : 0;
        for (int row = 0; row < source.rows; ++row) {
            const auto* const values = source.row(row);
            // Where an entry that the seams leave comes from.
            const auto from = [&](int entry) {
                if (!step) return static_cast<double>(entry);
                const int at = step->start() + entry;
                return at - step->origin() +
                       static_cast<double>(
                           step->soft()->entry(at, step->first_lateral() + plane.first_row + row,
                                               step->first_slice() + plane.slice));
            };
            for (int u = 0; u < width; ++u) {
                const double place = u * scale;
                const int low = std::min(static_cast<int>(place), left - 1),
                          high = std::min(low + 1, left - 1);
                const double at = std::clamp(from(low) + (place - low) * (from(high) - from(low)),
                                             0.0, source.width - 1.0);
                const int before = static_cast<int>(at),
                          behind = std::min(before + 1, source.width - 1);
                out.row(row)[u] = static_cast<float>(
                    values[before] +
                    (at - before) * static_cast<double>(values[behind] - values[before]));
            }
        }
        return out;
    }

    std::vector<std::size_t> counts_;
    std::vector<Distances> distances_;  ///< of each of the counts
};

}  // namespace

NodeType seams_choose() {
    return Declare<Choose>(
               "seams.choose",
               "Keeps the first seams of a set, as many as look best together with a warp of what "
               "is left of the carve: all of them, some or none. How a carve looks is estimated by "
               "its similarity to the field, with even scaling in place of the warp. Slabs that "
               "are "
               "doubled are kept up to a third of the lattice's vertices: more repeats would stand "
               "side by side.")
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
    /// Seams run otherwise in each frame.
    static bool animates(const Params&) { return true; }

    static void check(const Params& params, NodeCheck& check) {
        const auto ending = ending_of(params.path.text());
        if (ending != ".ply" && ending != ".obj")
            check.fault("path",
                        "writes .ply files, with colours, and .obj files: let the name end in one "
                        "of these");
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const std::array every{params.every.value_or(every_by_default(io.seams->lateral())),
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
    /// What a file of seams of frames will do, if it is there.
    static std::optional<FramesCarved> in_time(const Params& params) {
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
        std::optional<FramesCarved> in_time;  ///< seams of frames are written as all others are
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
