#include "nodes/python/python_nodes.h"

#include "carve/field/dense.h"
#include "carve/points/point_grid.h"
#include "carve/points/points.h"
#include "formats/geometry_file/ply.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/python/python_script.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;

/// Names of the types in numpy, in the order of NumberType.
constexpr std::array<std::string_view, 8> numpy_types{"int8",  "uint8",  "int16",   "uint16",
                                                      "int32", "uint32", "float32", "float64"};

/// Points as columns, in their file's space.
PointTable columns_of(const Points& points, const Context& context) {
    if (points.ply) return *points.ply;
    std::vector<std::string> left_out;
    auto out = ply_of(*points.grid, left_out);
    if (!left_out.empty())
        context.warn(fmt::format("scripts do not get the attributes {}, and the result lacks them",
                                 fmt::join(left_out, ", ")));
    return out;
}

/// Writes the columns of points into the worker's memory. @return their description for the
/// request
Json write_columns(const PointTable& points, const Placement& placement, std::byte* data,
                   std::uint64_t& at) {
    Json columns = Json::array();
    for (const auto& column : points.columns) {
        std::memcpy(data + at, column.values.data(), column.values.size());
        columns.push_back({{"name", column.name},
                           {"type", numpy_types.at(static_cast<std::size_t>(column.type))},
                           {"at", at}});
        at += (column.values.size() + 7) / 8 * 8;
    }
    const auto& move = placement.translate;
    return {{"count", points.size},
            {"columns", std::move(columns)},
            {"scale", placement.scale},
            {"translate", {move[0], move[1], move[2]}}};
}

/// The columns that the worker returned. @param like  has the type names of the source's file
PointTable read_columns(Worker& worker, const Json& answer, const PointTable& like) {
    PointTable out{like.encoding,
                   like.comments,
                   like.empty_elements,
                   {},
                   answer.at("count").get<std::size_t>()};
    for (const auto& each : answer.at("columns")) {
        const auto name = each.at("name").get<std::string>();
        const auto type = static_cast<NumberType>(
            std::ranges::find(numpy_types, each.at("type").get<std::string>()) -
            numpy_types.begin());
        const auto bytes = out.size * bytes_of(type), at = each.at("at").get<std::uint64_t>();
        const auto* const data =
            reinterpret_cast<const char*>(worker.answered.seen(at + bytes)) + at;
        const auto* const before = like.column(name);
        out.columns.push_back(
            {name,
             before && before->type == type ? before->type_name : std::string(name_of(type)),
             type,
             {data, data + bytes}});
    }
    return out;
}

struct PointsPython {
    using Params = PythonParams;
    struct Ports {
        Named<Points> inputs;
        Ref<Points> points;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (check.stated("inputs") && check.connections("inputs") == 0)
            return check.fault("inputs", "'inputs' names no points; name at least one");
        check_script(params, "points", check.names("inputs"), check);
    }
    static NodeTraits traits(const Params& params) { return script_traits(params); }

    static void run(const Params& params, Ports& io, Context& context) {
        std::vector<PointTable> inputs;
        std::uint64_t bytes = 0;
        for (const auto& [name, points] : io.inputs) {
            inputs.push_back(columns_of(*points, context));
            bytes += inputs.back().bytes() + 8 * inputs.back().columns.size();
        }
        if (!grid_fits(static_cast<double>(bytes), context.limits().memory))
            throw Failure("the points take more than --memory allows; raise it");
        Points out = *io.inputs.front().second;
        call_script(
            params, "points", context,
            [&](Worker& worker) {
                auto* const data = worker.given.grown(bytes);
                std::uint64_t at = 0;
                Json points;
                for (std::size_t n = 0; n < inputs.size(); ++n)
                    points[io.inputs[n].first] = write_columns(
                        inputs[n],
                        io.inputs[n].second->ply ? io.inputs[n].second->placement : Placement{},
                        data, at);
                return Json{{"wants", "points"},
                            {"bytes", worker.given.size()},
                            {"points", std::move(points)},
                            {"like", io.inputs.front().first}};
            },
            [&](Worker& worker, const Json& answer) {
                auto made = read_columns(worker, answer, inputs.front());
                if (out.ply) {
                    out.ply = std::make_shared<PointTable>(std::move(made));
                    return;
                }
                const auto grid = grid_of(made);
                grid->setName(out.grid->getName());
                out.grid = grid;
            });
        io.points = std::make_shared<Points>(std::move(out));
    }
};

}  // namespace

NodeType points_python() {
    Declare<PointsPython> node("points.python",
                               "Particles changed, added or taken away by your own function in "
                               "Python, `points(p, ..., at)`.");
    node.input("inputs", &PointsPython::Ports::inputs,
               "Particles by name: `{p: drops}`. The function gets each as a dict of arrays: `P`, "
               "the positions in the world, (n, 3), and each attribute, (n,) or (n, 3). It returns "
               "such a dict, of any number of points; the result is stored as the first input is.");
    return declare_python(node)
        .output("points", &PointsPython::Ports::points, "The particles.")
        .kept();
}

}  // namespace fluidcarve
