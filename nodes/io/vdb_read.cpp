#include "nodes/io/vdb_read.h"

#include "nodes/io/vdb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace fluidcarve {
namespace {

enum class Missing { error, skip, hold };
enum class GridKind { scalar, vector };

struct GridChoice {
    std::string name;  ///< in the file; empty: the output's
    GridKind kind = GridKind::scalar;
};

}  // namespace

template <>
struct ChoiceNames<Missing> {
    static constexpr std::array names = {std::pair{"error", Missing::error}, std::pair{"skip", Missing::skip}, std::pair{"hold", Missing::hold}};
};

template <>
struct ChoiceNames<GridKind> {
    static constexpr std::array names = {std::pair{"float", GridKind::scalar}, std::pair{"vector", GridKind::vector}};
};

/// `float`, or `{name: vel, type: vector}`.
template <>
struct ParamTraits<GridChoice> {
    static Shape shape() {
        const auto kind = ParamTraits<GridKind>::shape();
        return {Shape::Kind::any_of, {}, {kind, {Shape::Kind::map, {}, {}, {{"name", ParamTraits<std::string>::shape()}, {"type", kind}}}}};
    }

    static std::optional<GridChoice> parse(const Value& value, ValueReader& reader) {
        GridChoice out;
        if (value.kind == Value::Kind::scalar) return parse_kind(value, reader, out) ? std::optional(out) : std::nullopt;
        if (value.kind != Value::Kind::map) return reader.unwanted(value, to_text(shape())), std::nullopt;
        bool good = true;
        for (const auto& field : value.fields) {
            if (field.name == "type") {
                good = parse_kind(field.value, reader, out) && good;
            } else if (field.name == "name") {
                const auto name = ParamTraits<std::string>::parse(field.value, reader);
                good = good && name;
                out.name = name.value_or("");
            } else {
                Value key;
                key.mark = field.mark;
                reader.fault(key, fmt::format("has no field '{}'{}", field.name, did_you_mean(field.name, {"name", "type"})));
                good = false;
            }
        }
        if (good && !value.find("type")) {
            reader.fault(value, "lacks 'type': float or vector");
            good = false;
        }
        return good ? std::optional(out) : std::nullopt;
    }

    static std::string text(const GridChoice& choice) {
        const auto kind = ParamTraits<GridKind>::text(choice.kind);
        return choice.name.empty() ? kind : fmt::format("{{name: {}, type: {}}}", choice.name, kind);
    }

private:
    static bool parse_kind(const Value& value, ValueReader& reader, GridChoice& out) {
        for (const auto& [name, kind] : ChoiceNames<GridKind>::names) {
            if (value.kind != Value::Kind::scalar || value.text != name) continue;
            out.kind = kind;
            return true;
        }
        const auto best = nearest(value.text, {"float", "vector"});
        reader.fault(value, fmt::format("wants float or vector, not {}{}", value.describe(), best.empty() ? "" : fmt::format("; did you mean '{}'?", best)));
        return false;
    }
};

namespace {

/// "vec3s" for "Tree_vec3s_5_4_3"; other trees keep their whole name.
std::string short_type(std::string type) {
    constexpr std::string_view before = "Tree_", after = "_5_4_3";
    if (!type.starts_with(before) || !type.ends_with(after)) return type;
    return type.substr(before.size(), type.size() - before.size() - after.size());
}

Payload typed(const openvdb::GridBase::ConstPtr& grid, GridKind kind) {
    return kind == GridKind::scalar ? Payload(openvdb::gridConstPtrCast<FloatGrid>(grid)) : Payload(openvdb::gridConstPtrCast<VectorGrid>(grid));
}

struct VdbRead {
    struct Params {
        InputPath path;
        std::map<std::string, GridChoice> grids;
        Missing missing = Missing::error;
    };
    struct Ports {
        Ref<Volume> volume;
        NamedOutputs grids;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.grids.count("volume"))
            check.fault("grids", "vdb.read has an output 'volume' of its own; name this one otherwise: {density: {name: volume, type: float}}");
        if (params.missing != Missing::error && !params.path.per_frame())
            check.fault("missing", fmt::format("'{}' is for sequences; the path has no frame token such as ####", ParamTraits<Missing>::text(params.missing)));
    }

    static void survey(const Params& params, Survey& survey) {
        bool any = false;
        for (const int frame : survey.frames()) any = any || there(params, frame);
        if (!any && !survey.frames().empty()) {
            const auto first = survey.frames().front();
            const auto path = params.path.at(first);
            return survey.missing(first, survey.frames().size() == 1 || !params.path.per_frame()
                                             ? fmt::format("{} does not exist", path)
                                             : fmt::format("{} does not exist, nor does any other frame", path));
        }
        if (params.missing == Missing::hold) return;
        for (const int frame : survey.frames()) {
            if (there(params, frame)) continue;
            if (params.missing == Missing::skip) survey.leave_out(frame);
            else survey.missing(frame, fmt::format("{} does not exist", params.path.at(frame)));
        }
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(params.missing == Missing::hold ? held(params, context) : context.frame());
        const auto header = read_vdb_header(path);
        std::map<std::string, std::size_t> places;
        for (const auto& [output, choice] : params.grids)
            if (context.wants(output)) places[output] = place(header, choice.name.empty() ? output : choice.name, choice.kind);

        if (context.wants("volume")) io.volume = std::make_shared<Volume>(read_vdb(path));
        for (const auto& [output, n] : places)
            io.grids[output] = typed(io.volume ? io.volume->grids.at(n) : read_vdb_grid(path, header.grids[n].unique_name), params.grids.at(output).kind);
    }

private:
    static bool there(const Params& params, int frame) {
        std::error_code ignored;
        return std::filesystem::exists(params.path.at(frame), ignored);
    }

    static int held(const Params& params, const Context& context) {
        const auto& frames = context.frames();
        for (std::size_t n = context.place() + 1; n-- > 0;)
            if (there(params, frames[n])) return frames[n];
        for (std::size_t n = context.place() + 1; n < frames.size(); ++n)
            if (there(params, frames[n])) return frames[n];
        return context.frame();
    }

    static std::size_t place(const VdbHeader& header, const std::string& name, GridKind kind) {
        const auto found = header.place(name);
        const auto& type = header.grids[found].type;
        const auto& wanted = kind == GridKind::scalar ? FloatGrid::gridType() : VectorGrid::gridType();
        if (type == wanted) return found;
        const auto remedy = type == FloatGrid::gridType()    ? "; state it as float"
                            : type == VectorGrid::gridType() ? "; state it as vector"
                                                             : "; only float and vec3s grids can be named, others travel within the volume";
        throw Failure(fmt::format("{}: grid '{}' is of type {}, not {}{}", header.path, name, short_type(type), short_type(wanted), remedy),
                      Failure::Kind::input);
    }
};

}  // namespace

NodeType vdb_read() {
    return Declare<VdbRead>("vdb.read", "Reads OpenVDB files: all grids of each frame, some of them as outputs of their own.")
        .required("path", &VdbRead::Params::path, "File, or sequence with a frame token such as ####.")
        .param("grids", &VdbRead::Params::grids,
               "Grids to offer as outputs, each by its type: `density: float`; or under another name: `velocity: {name: vel, type: vector}`. "
               "Of several grids of one name, `name[1]` is the second.")
        .param("missing", &VdbRead::Params::missing,
               "What to do about a frame without a file: stop; leave the frame out of the whole run; or hold the nearest earlier frame, else the next.")
        .output("volume", &VdbRead::Ports::volume, "All grids of the file, in its order, with all metadata.")
        .outputs_from("grids", &VdbRead::Ports::grids, [](const VdbRead::Params& params) {
            std::vector<std::pair<std::string, std::type_index>> out;
            for (const auto& [name, choice] : params.grids)
                out.emplace_back(name, choice.kind == GridKind::scalar ? std::type_index(typeid(FloatGrid)) : std::type_index(typeid(VectorGrid)));
            return out;
        });
}

}  // namespace fluidcarve
