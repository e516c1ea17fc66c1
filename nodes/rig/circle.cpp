#include "nodes/rig/circle.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {
struct Radii {
    std::array<double, 2> of{};
};
}  // namespace

/// The radii are stated as `r` or `[r1, r2]`.
template <>
struct ParamTraits<Radii> {
    static Shape shape() { return {Shape::Kind::any_of, {}, {ParamTraits<double>::shape(), ParamTraits<std::vector<double>>::shape()}}; }
    static std::optional<Radii> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar) {
            const auto radius = reader.number(value, false);
            return radius ? std::optional(Radii{{*radius, *radius}}) : std::nullopt;
        }
        const auto radii = ParamTraits<std::vector<double>>::parse(value, reader);
        if (!radii) return std::nullopt;
        if (radii->size() != 2) return reader.fault(value, fmt::format("must have one number or two, not {}", radii->size())), std::nullopt;
        return Radii{{(*radii)[0], (*radii)[1]}};
    }
    static std::string text(const Radii& radii) { return fmt::format("[{}, {}]", radii.of[0], radii.of[1]); }
};

namespace {

struct RigCircle {
    struct Params {
        Vec3 center{};
        Vec3 normal{0, 0, 1};
        Radii radius;
        double start = 0;
    };
    struct Ports {
        Ref<Rig> rig;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (Vec3d(params.normal.data()).length() == 0) check.fault("normal", "'normal' has no direction");
        if (!(params.radius.of[0] > 0 && params.radius.of[1] > 0)) check.fault("radius", "'radius' must be more than 0");
    }
    static void foresee(const Params& params, Outlook& ahead) { ahead.lies(region_of(rig_of(params))); }
    static void run(const Params& params, Ports& io, Context&) { io.rig = std::make_shared<Rig>(rig_of(params)); }

private:
    static Rig rig_of(const Params& params) {
        return circle_rig(Vec3d(params.center.data()), Vec3d(params.normal.data()), params.radius.of, std::fmod(params.start, 360) * M_PI / 180);
    }
};

}  // namespace

Rig circle_rig(const Vec3d& center, const Vec3d& normal, const std::array<double, 2>& radii, double start) {
    const auto n = normal.unit();
    const auto across = [&](const Vec3d& axis) { return axis - axis.dot(n) * n; };
    const auto x = across({1, 0, 0}).length() > 1e-6 ? across({1, 0, 0}).unit() : across({0, 1, 0}).unit();
    return oval_rig({center, radii[0] * x, radii[1] * x.cross(n), start}, n);
}

NodeType rig_circle() {
    using Params = RigCircle::Params;
    return Declare<RigCircle>("rig.circle", "A closed rig along a circle or an oval. The lattice's `u` points outwards, `v` along the normal.")
        .required("center", &Params::center, Unit::world, any_number(), "Centre of the circle.")
        .param("normal", &Params::normal, Unit::none, any_number(), "Normal of the circle's plane. The rig runs clockwise, seen from the normal's tip.")
        .required("radius", &Params::radius, Unit::world, at_least(0),
                  "Radius, above 0. An oval has two, `[r1, r2]`: along the world's x axis projected into its plane (the y axis, if the normal is along x), and "
                  "across.")
        .param("start", &Params::start, Unit::none, any_number(),
               "Angle of the first plane, in degrees from the direction of the first radius, clockwise. The lattice closes there.")
        .output("rig", &RigCircle::Ports::rig, "The rig.");
}

}  // namespace fluidcarve
