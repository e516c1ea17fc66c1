#include "nodes/vdb.h"

#include "carve/base/words.h"
#include "carve/field/same_transform.h"
#include "carve/grid/named_grids.h"
#include "carve/stream/openvdb_types.h"
#include "carve/volume/triplet.h"
#include "formats/vdb/conventions.h"
#include "formats/vdb/header_region.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/params/file_sequence.h"
#include "nodes/params/grid_choice.h"
#include "nodes/params/placement_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace fluidcarve {

namespace {

enum class Application { detect, none, blender, houdini, embergen, bifrost };

}  // namespace

template <>
struct ChoiceNames<Application> {
    static constexpr std::array names = {
        std::pair{"auto", Application::detect},       std::pair{"none", Application::none},
        std::pair{"blender", Application::blender},   std::pair{"houdini", Application::houdini},
        std::pair{"embergen", Application::embergen}, std::pair{"bifrost", Application::bifrost}};
};

namespace {

/// Shortens a type name for messages: "Tree_vec3s_5_4_3" to "vec3s". Types with other trees keep
/// their whole name.
std::string short_type(std::string type) {
    constexpr std::string_view before = "Tree_", after = "_5_4_3";
    if (!type.starts_with(before) || !type.ends_with(after)) return type;
    return type.substr(before.size(), type.size() - before.size() - after.size());
}

/// An open file, in whose header it finds the grids that a pipeline names.
class Contents {
public:
    Contents(const std::string& path, Application application,
             std::uint64_t budget = ~std::uint64_t{0})
        : file_(path, budget),
          header_(file_.header()),
          conventions_(application == Application::detect
                           ? detected_conventions(header_)
                           : conventions_of(ParamTraits<Application>::text(application))) {}

    VdbFile& file() { return file_; }
    const VdbHeader& header() const { return header_; }

    /// Indices in the header of the grids for an output: one, or three for a triplet.
    /// @throws Failure (input) if there is no such grid, or it has another type
    std::vector<std::size_t> places(const std::string& output, const GridChoice& choice) const {
        const auto name =
            choice.name.empty() ? name_in_file(header(), conventions_, output) : choice.name;
        const auto has = [&](const std::string& each) { return header().find(each).has_value(); };
        const auto parts = triplet_names(name);
        if (choice.kind == GridKind::vector && !has(name) && std::ranges::all_of(parts, has))
            return {place(parts[0], GridKind::scalar), place(parts[1], GridKind::scalar),
                    place(parts[2], GridKind::scalar)};
        return {place(name, choice.kind)};
    }

    /// Number of grids of a name.
    std::ptrdiff_t count(const std::string& name) const {
        return std::ranges::count(header_.grids, name, &VdbHeader::Entry::name);
    }

    /// Name of the grid that an output will be. @param places  as of `places`
    std::string name_of(const std::vector<std::size_t>& places) const {
        const auto& name = header().grids[places.front()].name;
        return places.size() == 3 ? base(name) : name;
    }

    /// Requires that the file has a grid that nodes take from the volume, and of a type that they
    /// take.
    /// @throws Failure (input) naming them
    void require(const Pick& pick) const {
        const auto refuse = [&](const std::string& message) {
            throw Failure(fmt::format("{} {}", header_.path, message), Failure::Kind::input);
        };
        const auto parts = triplet_names(pick.part);
        const auto found = header_.find(pick.part);
        const bool triplet = !found && std::ranges::all_of(parts, [&](const std::string& each) {
            return header_.find(each).has_value();
        });
        if (!found && !triplet)
            refuse(lacks_grid(pick.part, header_.names(), fmt::format(", but {}", pick.taker)));
        const bool scalar = pick.type == typeid(FloatGrid);
        if (!scalar && pick.type != typeid(VectorGrid)) return;
        const auto& wanted = scalar ? FloatGrid::gridType() : VectorGrid::gridType();
        const auto& is = triplet ? VectorGrid::gridType() : header_.grids[*found].type;
        if (is != wanted)
            refuse(fmt::format("has the grid '{}' as {}, but {} as {}", pick.part, short_type(is),
                               pick.taker, short_type(wanted)));
    }

    /// The placement of a grid; points may have an offset from the other grids.
    Placement with_offset(const openvdb::GridBase& grid, Placement placement) const {
        if (is_point_grid(grid) && conventions_ && conventions_->points_off)
            placement.offset = openvdb::Vec3d(-0.5);
        return placement;
    }

    /// Converts the grids at these indices to an output.
    Payload typed(const std::vector<openvdb::GridBase::ConstPtr>& grids, const GridChoice& choice,
                  const Placement& placement) const {
        if (choice.kind == GridKind::scalar)
            return Payload(openvdb::gridConstPtrCast<FloatGrid>(placed(grids[0], placement)));
        openvdb::GridBase::ConstPtr vectors = grids[0];
        if (grids.size() == 3)
            vectors =
                merged(make_triplet(base(grids[0]->getName()),
                                    {as_float(grids[0]), as_float(grids[1]), as_float(grids[2])}));
        else if (conventions_ && conventions_->staggered &&
                 vectors->getGridClass() == openvdb::GRID_UNKNOWN)
            vectors = staggered(*vectors);
        return Payload(openvdb::gridConstPtrCast<VectorGrid>(placed(vectors, placement)));
    }

private:
    static FloatGrid::ConstPtr as_float(const openvdb::GridBase::ConstPtr& grid) {
        return openvdb::gridConstPtrCast<FloatGrid>(grid);
    }
    static std::string base(const std::string& component) {
        return component.substr(0, component.size() - 2);
    }

    static openvdb::GridBase::ConstPtr staggered(const openvdb::GridBase& grid) {
        const auto out =
            std::const_pointer_cast<openvdb::GridBase>(grid.copyGridReplacingMetadata(grid));
        out->setGridClass(openvdb::GRID_STAGGERED);
        StoredForm stored;
        stored.made_staggered = true;
        stored.class_in_file = grid[openvdb::GridBase::META_GRID_CLASS] != nullptr;
        set_stored_form(*out, std::move(stored));
        return out;
    }

    std::size_t place(const std::string& name, GridKind kind) const {
        const auto found = header_.place(name);
        const auto& type = header_.grids[found].type;
        const auto& wanted =
            kind == GridKind::scalar ? FloatGrid::gridType() : VectorGrid::gridType();
        if (type == wanted) return found;
        const auto remedy =
            type == FloatGrid::gridType() ? "; state it as float"
            : type == VectorGrid::gridType()
                ? "; state it as vector"
                : "; only float and vec3s grids can be named, others travel within the volume";
        throw Failure(fmt::format("{}: grid '{}' is of type {}, not {}{}", header_.path, name,
                                  short_type(type), short_type(wanted), remedy),
                      Failure::Kind::input);
    }

    VdbFile file_;
    const VdbHeader& header_;
    const Conventions* conventions_;
};

/// Checks that grids keep the shape of their voxels over a sequence and, in Blender's files, the
/// size of their domain: of an adaptive domain, Blender stores neither the place nor the true size
/// of the voxels.
class Steadiness {
public:
    /// Warns of the first grid that changes, once per sequence.
    /// @param places  indices in the header of the grids that the run reads
    void look(const VdbHeader& header, const std::set<std::size_t>& places, int frame,
              Survey& survey) {
        for (const auto place : places) {
            const auto& grid = header.grids[place];
            if (!grid.transform || told_) continue;
            const Space space{frame, grid.transform,
                              grid.metadata["file_base_resolution"]
                                  ? grid.metadata["file_base_resolution"]->str()
                                  : std::string()};
            const auto& first = first_.try_emplace(grid.unique_name, space).first->second;
            if (same_voxels(*first.transform, *space.transform) && first.domain == space.domain)
                continue;
            told_ = true;
            survey.warn(
                fmt::format("grid '{}' has {} in frame {}, but {} in frame {} (an adaptive "
                            "domain?): no lattice fits both; bake with a fixed domain",
                            grid.unique_name, text(first), first.frame, text(space), frame));
        }
    }

private:
    struct Space {
        int frame;
        openvdb::math::Transform::ConstPtr transform;
        std::string domain;
    };
    static std::string text(const Space& space) {
        return place_text(*space.transform) +
               (space.domain.empty() ? "" : fmt::format(" in a domain of {}", space.domain));
    }
    std::map<std::string, Space> first_;
    bool told_ = false;
};

/// Bytes of memory of the grids: as stated by the file's writer, or as counted, if that is more.
/// @param places  indices in the header of the grids that the run reads
/// @param named   the grids among them that are outputs of their own: nodes may turn their tiles
///   into voxels
std::uint64_t memory_of(Contents& contents, const std::set<std::size_t>& places,
                        const std::set<std::size_t>& named) {
    std::uint64_t out = 0;
    for (const auto place : places) {
        std::uint64_t most = 0;
        if (const auto bytes =
                contents.header().grids[place].metadata.getMetadata<openvdb::Int64Metadata>(
                    "file_mem_bytes");
            bytes && bytes->value() > 0)
            most = static_cast<std::uint64_t>(bytes->value());
        if (const auto counted = contents.file().memory(place))
            most = std::max({most, counted->tree, named.contains(place) ? counted->dense : 0});
        out += most;
    }
    return out;
}

struct VdbRead {
    struct Params {
        InputPath path;
        std::map<std::string, GridChoice> grids;
        Missing missing = Missing::error;
        Application profile = Application::detect;
        Vec3 translate{};
        double scale = 1;
    };
    struct Ports {
        Ref<Volume> volume;
        NamedOutputs grids;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.grids.count("volume"))
            check.fault("grids",
                        "vdb.read already has an output 'volume'; give this one another name: "
                        "{density: {name: volume, type: float}}");
        check_missing(params.path, params.missing, check);
    }

    /// Finds files that can't be read or lack a grid before the run starts.
    static void survey(const Params& params, Survey& survey) {
        HeaderSurvey headers(params, survey);
        survey_files(params.path, params.missing, survey,
                     [&](int frame, int file) { headers.look(frame, file); });
        headers.conclude();
    }

    static void run(const Params& params, Ports& io, Context& context) {
        Contents contents(file_of(params.path, params.missing, context), params.profile,
                          context.limits().memory);
        const auto placement = placement_of(params);
        std::map<std::string, std::vector<std::size_t>> places;
        for (const auto& [output, choice] : params.grids)
            if (context.wants(output)) places[output] = contents.places(output, choice);

        std::map<std::size_t, openvdb::GridBase::ConstPtr> grids;
        if (context.wants("volume")) {
            auto volume = std::make_shared<Volume>(contents.file().read());
            for (std::size_t n = 0; n < volume->grids.size(); ++n) grids[n] = volume->grids[n];
            for (auto& grid : volume->grids)
                grid = placed(grid, contents.with_offset(grid.header(), placement));
            io.volume = std::move(volume);
        }
        for (const auto& [output, all] : places) {
            std::vector<openvdb::GridBase::ConstPtr> made_of;
            for (const auto n : all) {
                auto& grid = grids[n];
                if (!grid) grid = contents.file().read(n);
                made_of.push_back(grid);
            }
            io.grids[output] = contents.typed(made_of, params.grids.at(output), placement);
        }
    }

private:
    /// What the headers of a sequence say.
    class HeaderSurvey {
    public:
        HeaderSurvey(const Params& params, Survey& survey) : params_(params), survey_(survey) {}

        void look(int frame, int file) {
            Contents contents(params_.path.at(file), params_.profile);
            const auto named = look_at_outputs(contents, frame);
            for (const auto& pick : survey_.picks()) contents.require(pick);
            auto places = named;
            if (survey_.wants("volume")) {
                std::vector<std::string> names;
                for (const auto& grid : contents.header().grids) {
                    places.insert(names.size());
                    names.push_back(grid.name);
                }
                survey_.delivers(frame, "volume", {std::move(names), std::nullopt});
            }
            steadiness_.look(contents.header(), places, frame, survey_);
            survey_.expect(frame, memory_of(contents, places, named));
        }
        void conclude() const {
            for (const auto& [name, first] : several_)
                survey_.warn(
                    fmt::format("there are several grids '{}': energies see '{}', and all are "
                                "carved by the same seams",
                                name, first.second));
            for (const auto& [output, of] : regions_)
                if (const auto region = of.region()) survey_.lies(output, *region);
        }

    private:
        /// @return indices in the header of the grids that outputs are made of
        std::set<std::size_t> look_at_outputs(const Contents& contents, int frame) {
            std::set<std::size_t> out;
            for (const auto& [output, choice] : params_.grids) {
                if (!survey_.wants(output)) continue;
                const auto places = contents.places(output, choice);
                if (const auto& grid = contents.header().grids[places.front()];
                    contents.count(grid.name) > 1) {
                    const std::pair named(places.front(), grid.unique_name);
                    auto& first = several_.try_emplace(grid.name, named).first->second;
                    first = std::min(first, named);
                }
                out.insert(places.begin(), places.end());
                for (const auto place : places)
                    regions_[output].add(contents.header().grids[place], placement_of(params_));
                survey_.delivers(frame, output, {{{contents.name_of(places)}}, std::nullopt});
            }
            return out;
        }

        const Params& params_;
        Survey& survey_;
        Steadiness steadiness_;
        std::map<std::string, HeaderRegion> regions_;
        /// The first grid that is taken, of those of one name: its place and name.
        std::map<std::string, std::pair<std::size_t, std::string>> several_;
    };
};

}  // namespace

NodeType vdb_read() {
    return Declare<VdbRead>(
               "vdb.read",
               "Reads OpenVDB files: all grids of each frame, and chosen grids as outputs.")
        .required("path", &VdbRead::Params::path,
                  "File, or sequence with a frame token such as ####.")
        .param("grids", &VdbRead::Params::grids,
               "Grids to offer as outputs, with their type: `density: float`, or under another "
               "name: `velocity: {name: vel, type: vector}`. If several grids have one name, "
               "`name[1]` is the second. A vector `vel` is also read from three float grids "
               "`vel.x`, `vel.y`, `vel.z`, and written back as three.")
        .param("missing", &VdbRead::Params::missing, missing_doc)
        .param("profile", &VdbRead::Params::profile,
               "The application that wrote the files. If a file has no grid of a name under "
               "`grids`, the application's name is tried (`velocity`: Houdini's `vel`, Bifrost's "
               "`voxel_velocity`). Blender's velocities count as staggered whatever their class, "
               "and its points are moved down by half a voxel. Auto recognises the application by "
               "the grids and metadata of each file.")
        .param("translate", &VdbRead::Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world; the writer undoes it. Values, "
               "also velocities, are not changed.")
        .param("scale", &VdbRead::Params::scale, Unit::none, between(1e-6, 1e6), placed_scale_doc)
        .output("volume", &VdbRead::Ports::volume,
                "All grids of the file, in its order, with all metadata.")
        .outputs_from("grids", &VdbRead::Ports::grids, [](const VdbRead::Params& params) {
            std::vector<std::pair<std::string, std::type_index>> out;
            for (const auto& [name, choice] : params.grids)
                out.emplace_back(name, choice.kind == GridKind::scalar
                                           ? std::type_index(typeid(FloatGrid))
                                           : std::type_index(typeid(VectorGrid)));
            return out;
        });
}

}  // namespace fluidcarve
