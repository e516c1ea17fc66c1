#include "nodes/rig/curve.h"

#include "graph/text/problem.h"
#include "nodes/rig/curve_file.h"
#include "nodes/rig/rig.h"

#include <fmt/format.h>

#include <filesystem>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

struct RigCurve {
    struct Params {
        InputPath path;
        Auto<bool> closed;
        Vec3 up{0, 0, 1};
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
        for (const int frame : survey.frames()) {
            if (params.path.per_frame() && !survey.needs(frame)) continue;
            if (const auto fault = fault_of(params, frame); !fault.empty()) survey.missing(frame, fault);
            if (!params.path.per_frame()) return;
        }
    }

    static void run(const Params& params, Ports& io, Context& context) { io.rig = std::make_shared<Rig>(read(params, context.frame())); }

private:
    static std::string fault_of(const Params& params, int frame) {
        std::error_code ignored;
        if (const auto path = params.path.at(frame); !std::filesystem::exists(path, ignored)) return path + " does not exist";
        try {
            read(params, frame);
            return {};
        } catch (const Failure& failure) {
            return failure.what();
        }
    }

    static Rig read(const Params& params, int frame) {
        const auto path = params.path.at(frame);
        Rig out;
        out.points = read_curve(path);
        out.up = Vec3d(params.up.data());
        const bool returns = out.points.size() > 2 && out.points.back() == out.points.front();
        out.closed = params.closed.value_or(returns);
        if (out.closed && returns) out.points.pop_back();
        for (auto& point : out.points) point = params.scale * point + Vec3d(params.translate.data());
        if (const auto fault = rig_fault(out); !fault.empty()) throw Failure(fmt::format("{}: {}", path, fault), Failure::Kind::input);
        return out;
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
        .param("translate", &Params::translate, Unit::world, any_number(), "Position of the file's origin in the shot's world.")
        .param("scale", &Params::scale, Unit::none, between(1e-6, 1e6), "The shot's world units per unit of the file, applied before `translate`.")
        .output("rig", &RigCurve::Ports::rig, "The rig.");
}

}  // namespace fluidcarve
