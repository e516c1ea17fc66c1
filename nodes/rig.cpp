#include "nodes/rig.h"

#include "carve/base/failure.h"
#include "carve/base/numbers.h"
#include "carve/rig/circle.h"
#include "carve/rig/points.h"
#include "carve/rig/rig.h"
#include "carve/rig/transform.h"
#include "carve/volume/volume.h"
#include "formats/geometry_file/curve_file.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"
#include "nodes/params/one_or_two.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

struct RigCircle {
    struct Params {
        Vec3 center{};
        Vec3 normal{0, 0, 1};
        OneOrTwo<double> radius;
        double start = 0;
    };
    struct Ports {
        Ref<Rig> rig;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_direction("normal", params.normal, check);
        if (!(params.radius.of[0] > 0 && params.radius.of[1] > 0))
            check.fault("radius", "'radius' must be more than 0");
    }
    static void foresee(const Params& params, Outlook& ahead) {
        ahead.lies(region_of(rig_of(params)));
    }
    static void run(const Params& params, Ports& io, Context&) {
        io.rig = std::make_shared<Rig>(rig_of(params));
    }

private:
    static Rig rig_of(const Params& params) {
        return circle_rig(Vec3d(params.center.data()), Vec3d(params.normal.data()),
                          params.radius.of, std::fmod(params.start, 360) * M_PI / 180);
    }
};

}  // namespace

NodeType rig_circle() {
    using Params = RigCircle::Params;
    return Declare<RigCircle>("rig.circle",
                              "A closed rig along a circle or an oval. The lattice's `u` points "
                              "outwards, `v` along the normal.")
        .required("center", &Params::center, Unit::world, any_number(), "Centre of the circle.")
        .param("normal", &Params::normal, Unit::none, any_number(),
               "Normal of the circle's plane. The rig runs clockwise, seen from the normal's tip.")
        .required("radius", &Params::radius, Unit::world, at_least(0),
                  "Radius, above 0. An oval has two, `[r1, r2]`: along the world's x axis "
                  "projected into its plane (the y axis, if the normal is along x), and across.")
        .param("start", &Params::start, Unit::none, any_number(),
               "Angle of the first plane, in degrees from the direction of the first radius, "
               "clockwise. The lattice closes there.")
        .output("rig", &RigCircle::Ports::rig, "The rig.");
}

namespace {

/// Which axis of the file becomes which of the shot.
enum class Turn { as_is, y_to_z, z_to_y };

}  // namespace

template <>
struct ChoiceNames<Turn> {
    static constexpr std::array names = {std::pair{"as_is", Turn::as_is},
                                         std::pair{"y_to_z", Turn::y_to_z},
                                         std::pair{"z_to_y", Turn::z_to_y}};
};

namespace {

Vec3d turned(const Vec3d& p, Turn turn) {
    switch (turn) {
        case Turn::as_is: break;
        case Turn::y_to_z: return {p.x(), -p.z(), p.y()};
        case Turn::z_to_y: return {p.x(), p.z(), -p.y()};
    }
    return p;
}

struct RigCurve {
    struct Params {
        InputPath path;
        Auto<bool> closed;
        Vec3 up{0, 0, 1};
        Turn axes = Turn::as_is;
        Vec3 translate{};
        double scale = 1;
    };
    struct Ports {
        Ref<Rig> rig;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_direction("up", params.up, check);
    }

    static void survey(const Params& params, Survey& survey) {
        Region region;
        for (const auto& [name, turn] : ChoiceNames<Turn>::names)
            if (turn != params.axes)
                region.otherwise.push_back({fmt::format("`axes: {}` in rig.curve", name), {}});
        for (const int frame : survey.frames()) {
            if (params.path.per_frame() && !survey.needs(frame)) continue;
            if (const auto fault = look(params, frame, region); !fault.empty())
                survey.missing(frame, fault);
            if (!params.path.per_frame()) break;
        }
        survey.lies("rig", region);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(context.frame());
        io.rig =
            std::make_shared<Rig>(checked(placed(read(params, path), params, params.axes), path));
    }

private:
    /// Adds the curve of a frame to a region, with the stated axes and with the others.
    /// @return the fault of its file; empty: none
    static std::string look(const Params& params, int frame, Region& region) {
        std::error_code ignored;
        const auto path = params.path.at(frame);
        if (!std::filesystem::exists(path, ignored)) return path + " does not exist";
        try {
            const auto rig = read(params, path);
            const auto add = [](const Rig& placed, std::vector<Region::Box>& boxes) {
                std::ranges::copy(region_of(placed).boxes, std::back_inserter(boxes));
            };
            add(checked(placed(rig, params, params.axes), path), region.boxes);
            auto other = region.otherwise.begin();
            for (const auto& [name, turn] : ChoiceNames<Turn>::names)
                if (turn != params.axes) add(placed(rig, params, turn), (other++)->boxes);
            return {};
        } catch (const Failure& failure) {
            return failure.what();
        }
    }

    /// The rig in its file's space.
    static Rig read(const Params& params, const std::string& path) {
        Rig out;
        out.points = read_curve(path);
        out.up = Vec3d(params.up.data());
        const bool returns = out.points.size() > 2 && out.points.back() == out.points.front();
        out.closed = params.closed.value_or(returns);
        if (out.closed && returns) out.points.pop_back();
        return out;
    }

    /// The rig in the shot's world.
    static Rig placed(Rig rig, const Params& params, Turn axes) {
        for (auto& point : rig.points)
            point = params.scale * turned(point, axes) + Vec3d(params.translate.data());
        return rig;
    }

    static Rig checked(Rig rig, const std::string& path) {
        if (const auto fault = rig_fault(rig); !fault.empty())
            throw Failure(fmt::format("{}: {}", path, fault), Failure::Kind::input);
        return rig;
    }
};

}  // namespace

NodeType rig_curve() {
    using Params = RigCurve::Params;
    return Declare<RigCurve>(
               "rig.curve",
               "A rig from a curve in a file, or one per frame from a sequence of files.")
        .required("path", &Params::path,
                  "A .obj file with a curve as lines (`l`), a .ply file in ascii with its points "
                  "in order, or a .csv file with a point per line, columns x, y, z. With a frame "
                  "token such as #### the rig moves.")
        .param("closed", &Params::closed,
               "Whether the rig returns from its last point to its first. auto: yes, if the file "
               "ends with its first point.")
        .param("up", &Params::up, Unit::none, any_number(),
               "Direction of the lattice's `v` at the first point; made orthogonal to the path.")
        .param(
            "axes", &Params::axes,
            "Which of the file's axes points up in the shot. as_is: the shot's axes are the "
            "file's. y_to_z: the file has y up and the shot z, as when Blender exports an OBJ file "
            "with its default settings; (x, y, z) becomes (x, -z, y). z_to_y: the other way round; "
            "(x, y, z) becomes (x, z, -y). Applied first; `up` is a direction in the shot.")
        .param("translate", &Params::translate, Unit::world, any_number(),
               "Position of the file's origin in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6),
               "The shot's world units per unit of the file, applied after `axes` and before "
               "`translate`.")
        .output("rig", &RigCurve::Ports::rig, "The rig.");
}

namespace {

using Positions = std::vector<Vec3>;

std::vector<Vec3d> positions(const Positions& points) {
    std::vector<Vec3d> out;
    for (const auto& point : points) out.emplace_back(point.data());
    return out;
}

struct RigPoints {
    struct Params {
        Positions points;
        std::map<std::string, Positions> frames;
        bool closed = false;
        Vec3 up{0, 0, 1};
    };
    struct Ports {
        Ref<Rig> rig;
    };

    /// Tells that there is one rig per frame, since the node has no input.
    static NodeTraits traits(const Params& params) { return {.animates = !params.frames.empty()}; }

    static void check(const Params& params, NodeCheck& check) {
        if (check.stated("points") == check.stated("frames"))
            return check.fault(
                check.stated("points") ? "frames" : "points",
                "needs either 'points', or 'frames' with points for each, and not both");
        check_direction("up", params.up, check);
        if (params.frames.empty())
            return refuse(rig_of(params, positions(params.points)), "points", "", check);
        for (const auto& [frame, points] : params.frames) {
            if (!number_of<int>(frame))
                check.fault(
                    "frames",
                    fmt::format(
                        "'frames' needs a frame's number before each list of points, not '{}'",
                        frame));
            refuse(rig_of(params, positions(points)), "frames", " in frame " + frame, check);
        }
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (params.frames.empty())
            return ahead.lies(region_of(rig_of(params, positions(params.points))));
        std::vector<Region::Box> keys;
        for (const auto& [frame, points] : params.frames)
            for (const auto& point : points) keys.push_back({point, point});
        // Between two keys the rig's points lie between theirs.
        ahead.lies(Region{{around(keys)}, {}});
    }

    static void run(const Params& params, Ports& io, Context& context) {
        if (params.frames.empty()) {
            io.rig = std::make_shared<Rig>(rig_of(params, positions(params.points)));
            return;
        }
        std::map<int, std::vector<Vec3d>> keys;
        for (const auto& [frame, points] : params.frames)
            keys[*number_of<int>(frame)] = positions(points);
        io.rig = std::make_shared<Rig>(rig_of(params, points_at(keys, context.frame())));
    }

private:
    static Rig rig_of(const Params& params, std::vector<Vec3d> points) {
        return {std::move(points), params.closed, Vec3d(params.up.data()), {}};
    }

    static void refuse(const Rig& rig, const char* field, const std::string& where,
                       NodeCheck& check) {
        if (const auto fault = rig_fault(rig); !fault.empty())
            check.fault(field, fmt::format("'{}' is no path{}: {}", field, where, fault));
    }
};

}  // namespace

NodeType rig_points() {
    return Declare<RigPoints>(
               "rig.points",
               "A rig through stated points, joined by straight lines; static or moving.")
        .param("points", &RigPoints::Params::points, Unit::world, any_number(),
               "Two points or more, in order: `[[0, 0, 0], [0, 4, 0], [1, 6, 0]]`.")
        .param("frames", &RigPoints::Params::frames, Unit::world, any_number(),
               "A moving rig, instead of `points`: a list of points for some frames, `{1: [[0, 0, "
               "0], [0, 4, 0]], 20: [[0, 0, 0], [1, 4, 0]]}`. Between two such frames each point "
               "moves in a straight line; before the first and after the last it stands still.")
        .param("closed", &RigPoints::Params::closed,
               "Whether the rig returns from its last point to its first. Do not state the first "
               "point again.")
        .param("up", &RigPoints::Params::up, Unit::none, any_number(),
               "Direction of the lattice's `v` at the first point; made orthogonal to the path. If "
               "a closed rig runs counter-clockwise, seen from the tip of `up`, then `u` points "
               "inwards.")
        .output("rig", &RigPoints::Ports::rig, "The rig.");
}

namespace {

struct RigTransform {
    struct Params {
        int smooth = 0;
        double scale = 1;
        Vec3 pivot{};
        Vec3 translate{};
        double extend = 0;
    };
    struct Ports {
        Ref<Rig> rig, transformed;
    };
    static void foresee(const Params& params, Outlook& ahead) {
        const auto* const rig = ahead.region("rig");
        if (!rig) return;
        const auto change = [&](std::vector<Region::Box>& boxes) {
            // Smoothed points stay between the others.
            if (params.smooth > 0 && !boxes.empty()) boxes = {around(boxes)};
            for (auto& box : boxes)
                for (auto* const corner : {&box.low, &box.high})
                    for (std::size_t n = 0; n < 3; ++n)
                        (*corner)[n] = params.pivot[n] +
                                       params.scale * ((*corner)[n] - params.pivot[n]) +
                                       params.translate[n];
        };
        auto out = *rig;
        change(out.boxes);
        for (auto& other : out.otherwise) change(other.boxes);
        ahead.lies(widened(std::move(out), params.extend));
    }
    static void run(const Params& params, Ports& io, Context&) {
        if (params.extend > 0 && io.rig->closed)
            throw Failure(
                fmt::format("{} is closed: it has no ends to 'extend'", to_text(*io.rig)));
        auto rig = moved(smoothed(*io.rig, params.smooth), params.scale, Vec3d(params.pivot.data()),
                         Vec3d(params.translate.data()));
        if (params.extend > 0) rig = extended(rig, params.extend, params.extend);
        io.transformed = std::make_shared<Rig>(std::move(rig));
    }
};

}  // namespace

NodeType rig_transform() {
    using Params = RigTransform::Params;
    return Declare<RigTransform>("rig.transform",
                                 "Smooths, scales, moves and extends a rig, in this order.")
        .input("rig", &RigTransform::Ports::rig, "The rig.")
        .param("smooth", &Params::smooth, Unit::none, between(0, 1e6),
               "Number of smoothing steps. In each, every point becomes the mean of itself and its "
               "two neighbours. The ends of an open rig stay; a circle shrinks.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6),
               "Factor for all distances from `pivot`.")
        .param("pivot", &Params::pivot, Unit::world, any_number(),
               "The point that stays in place when the rig is scaled.")
        .param("translate", &Params::translate, Unit::world, any_number(),
               "Displacement after scaling.")
        .param("extend", &Params::extend, Unit::world, at_least(0),
               "Length by which an open rig is extended straight beyond both ends. Use it if the "
               "lattice would end within the smoke: seams tear the smoke there.")
        .output("rig", &RigTransform::Ports::transformed, "The changed rig.");
}

}  // namespace fluidcarve
