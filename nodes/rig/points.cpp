#include "nodes/rig/points.h"

#include "graph/text/problem.h"

#include <fmt/format.h>

#include <charconv>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

using Points = std::vector<Vec3>;

std::vector<Vec3d> positions(const Points& points) {
    std::vector<Vec3d> out;
    for (const auto& point : points) out.emplace_back(point.data());
    return out;
}

std::optional<int> frame_number(const std::string& text) {
    int out = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional(out) : std::nullopt;
}

struct RigPoints {
    struct Params {
        Points points;
        std::map<std::string, Points> frames;
        bool closed = false;
        Vec3 up{0, 0, 1};
    };
    struct Ports {
        Ref<Rig> rig;
    };

    /// Tells that there is one rig per frame: the node has no input that would tell.
    static bool animates(const Params& params) { return !params.frames.empty(); }

    static void check(const Params& params, NodeCheck& check) {
        if (check.stated("points") == check.stated("frames"))
            return check.fault(check.stated("points") ? "frames" : "points", "needs either 'points', or 'frames' with points for each, and not both");
        if (Vec3d(params.up.data()).length() == 0) check.fault("up", "'up' has no direction");
        if (params.frames.empty()) return refuse(rig_of(params, positions(params.points)), "points", "", check);
        for (const auto& [frame, points] : params.frames) {
            if (!frame_number(frame)) check.fault("frames", fmt::format("'frames' needs a frame's number before each list of points, not '{}'", frame));
            refuse(rig_of(params, positions(points)), "frames", " in frame " + frame, check);
        }
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (params.frames.empty()) return ahead.lies(region_of(rig_of(params, positions(params.points))));
        std::vector<Region::Box> keys;
        for (const auto& [frame, points] : params.frames)
            for (const auto& point : points) keys.push_back({point, point});
        // Between two keys the rig is between their points.
        ahead.lies(Region{{around(keys)}, {}});
    }

    static void run(const Params& params, Ports& io, Context& context) {
        if (params.frames.empty()) {
            io.rig = std::make_shared<Rig>(rig_of(params, positions(params.points)));
            return;
        }
        std::map<int, std::vector<Vec3d>> keys;
        for (const auto& [frame, points] : params.frames) keys[*frame_number(frame)] = positions(points);
        io.rig = std::make_shared<Rig>(rig_of(params, points_at(keys, context.frame())));
    }

private:
    static Rig rig_of(const Params& params, std::vector<Vec3d> points) { return {std::move(points), params.closed, Vec3d(params.up.data()), {}}; }

    static void refuse(const Rig& rig, const char* field, const std::string& where, NodeCheck& check) {
        if (const auto fault = rig_fault(rig); !fault.empty()) check.fault(field, fmt::format("'{}' is no path{}: {}", field, where, fault));
    }
};

}  // namespace

std::vector<Vec3d> points_at(const std::map<int, std::vector<Vec3d>>& keys, int frame) {
    const auto after = keys.lower_bound(frame);
    if (after == keys.begin() || (after != keys.end() && after->first == frame)) return after->second;
    const auto before = std::prev(after);
    if (after == keys.end()) return before->second;
    if (before->second.size() != after->second.size())
        throw Failure(fmt::format("the rig has {} points in frame {}, but {} in frame {}: between two frames of different numbers it is not known",
                                  before->second.size(), before->first, after->second.size(), after->first));
    const double part = (static_cast<double>(frame) - before->first) / (static_cast<double>(after->first) - before->first);
    auto out = before->second;
    for (std::size_t n = 0; n < out.size(); ++n) out[n] += part * (after->second[n] - out[n]);
    return out;
}

NodeType rig_points() {
    return Declare<RigPoints>("rig.points", "A rig through stated points, joined by straight lines; static or moving.")
        .param("points", &RigPoints::Params::points, Unit::world, any_number(), "Two points or more, in order: `[[0, 0, 0], [0, 4, 0], [1, 6, 0]]`.")
        .param(
            "frames", &RigPoints::Params::frames, Unit::world, any_number(),
            "A moving rig, instead of `points`: a list of points for some frames, `{1: [[0, 0, 0], [0, 4, 0]], 20: [[0, 0, 0], [1, 4, 0]]}`. Between two such "
            "frames each point moves in a straight line; before the first and after the last it stands still.")
        .param("closed", &RigPoints::Params::closed, "Whether the rig returns from its last point to its first. Do not state the first point again.")
        .param("up", &RigPoints::Params::up, Unit::none, any_number(),
               "Direction of the lattice's `v` at the first point; made orthogonal to the path. If a closed rig runs counter-clockwise, seen from the tip of "
               "`up`, then `u` points inwards.")
        .output("rig", &RigPoints::Ports::rig, "The rig.");
}

}  // namespace fluidcarve
