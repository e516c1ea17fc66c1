#include "nodes/rig/curve.h"

#include "graph/text/problem.h"
#include "nodes/rig/curve_file.h"
#include "nodes/rig/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <utility>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {
/// Which axis of the file becomes which of the shot.
enum class Turn { as_is, y_to_z, z_to_y };
}  // namespace

template <>
struct ChoiceNames<Turn> {
    static constexpr std::array names = {std::pair{"as_is", Turn::as_is}, std::pair{"y_to_z", Turn::y_to_z}, std::pair{"z_to_y", Turn::z_to_y}};
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
        if (Vec3d(params.up.data()).length() == 0) check.fault("up", "'up' has no direction");
    }

    static void survey(const Params& params, Survey& survey) {
        Region region;
        for (const auto& [name, turn] : ChoiceNames<Turn>::names)
            if (turn != params.axes) region.otherwise.push_back({fmt::format("`axes: {}` in rig.curve", name), {}});
        for (const int frame : survey.frames()) {
            if (params.path.per_frame() && !survey.needs(frame)) continue;
            if (const auto fault = look(params, frame, region); !fault.empty()) survey.missing(frame, fault);
            if (!params.path.per_frame()) break;
        }
        survey.lies("rig", region);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto path = params.path.at(context.frame());
        io.rig = std::make_shared<Rig>(checked(placed(read(params, path), params, params.axes), path));
    }

private:
    /// Adds to a region where the curve of a frame lies, with these axes and with others. @return what is wrong with its file; empty: nothing
    static std::string look(const Params& params, int frame, Region& region) {
        std::error_code ignored;
        const auto path = params.path.at(frame);
        if (!std::filesystem::exists(path, ignored)) return path + " does not exist";
        try {
            const auto rig = read(params, path);
            const auto add = [](const Rig& placed, std::vector<Region::Box>& boxes) { std::ranges::copy(region_of(placed).boxes, std::back_inserter(boxes)); };
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
        for (auto& point : rig.points) point = params.scale * turned(point, axes) + Vec3d(params.translate.data());
        return rig;
    }

    static Rig checked(Rig rig, const std::string& path) {
        if (const auto fault = rig_fault(rig); !fault.empty()) throw Failure(fmt::format("{}: {}", path, fault), Failure::Kind::input);
        return rig;
    }
};

}  // namespace

NodeType rig_curve() {
    using Params = RigCurve::Params;
    return Declare<RigCurve>("rig.curve", "A rig from a curve in a file, or one per frame from a sequence of files.")
        .required("path", &Params::path,
                  "A .obj file with a curve as lines (`l`), a .ply file in ascii with its points in order, or a .csv file with a point per line, columns x, y, "
                  "z. With a frame token such as #### the rig moves.")
        .param("closed", &Params::closed, "Whether the rig returns from its last point to its first. auto: yes, if the file ends with its first point.")
        .param("up", &Params::up, Unit::none, any_number(), "Direction of the lattice's `v` at the first point; made orthogonal to the path.")
        .param(
            "axes", &Params::axes,
            "Which of the file's axes points up in the shot. as_is: the shot's axes are the file's. y_to_z: the file has y up and the shot z, as when Blender "
            "exports an OBJ file with its default settings; (x, y, z) becomes (x, -z, y). z_to_y: the other way round; (x, y, z) becomes (x, z, -y). Applied "
            "first; `up` is a direction in the shot.")
        .param("translate", &Params::translate, Unit::world, any_number(), "Position of the file's origin in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6),
               "The shot's world units per unit of the file, applied after `axes` and before `translate`.")
        .output("rig", &RigCurve::Ports::rig, "The rig.");
}

}  // namespace fluidcarve
