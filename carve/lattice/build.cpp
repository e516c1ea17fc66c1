#include "carve/lattice/build.h"

#include "carve/base/failure.h"
#include "carve/lattice/directions.h"
#include "carve/rig/transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

/// Indices of a plane's neighbours. At the ends of an open rig, the plane is its own neighbour.
struct Neighbours {
    std::size_t count;
    bool closed;
    std::size_t before(std::size_t k) const { return k > 0 ? k - 1 : closed ? count - 1 : 0; }
    std::size_t after(std::size_t k) const { return k + 1 < count ? k + 1 : closed ? 0 : k; }
};

std::vector<Vec3d> smoothed_directions(const std::vector<Vec3d>& w, bool closed) {
    const Neighbours near{w.size(), closed};
    std::vector<Vec3d> out;
    for (std::size_t k = 0; k < w.size(); ++k)
        out.push_back((w[near.before(k)] + w[k] + w[near.after(k)]).unit());
    return out;
}

/// Largest distance by which smoothing moved points sideways, world units. Movement along the path
/// does not count: the path is resampled anyway.
double sideways(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, bool closed) {
    const Neighbours near{from.size(), closed};
    double out = 0;
    for (std::size_t k = 0; k < from.size(); ++k) {
        const auto shift = to[k] - from[k], along = from[near.after(k)] - from[near.before(k)];
        const double square = along.lengthSqr();
        out = std::max(out,
                       (square > 0 ? shift - along.dot(shift) / square * along : shift).length());
    }
    return out;
}

/// Number of vertices on the way around a rig: the outermost stand about one spacing apart.
int vertices_around(double radius, double spacing) {
    return static_cast<int>(
        std::lround(2 * M_PI * std::max(1.0, vertices_along({0, radius}, spacing) - 1)));
}

/// Number of vertices along v.
double vertices_beside(const LatticeSpec& spec) {
    return spec.around ? vertices_around(spec.u[1], spec.spacing)
                       : vertices_along(spec.v, spec.spacing);
}

/// Builds one lattice along a rig, and smooths until no cell is folded.
class Builder {
public:
    Builder(const Rig& rig, const LatticeSpec& spec, std::optional<int> planes)
        : rig_(rig), spec_(spec), planes_(planes) {}

    BuiltLattice build() {
        auto line = resampled(rig_, spec_.spacing, planes_);
        require_room(line.points.size());
        auto w = plane_directions(line, rig_.closed, spec_.closed_form);
        assemble(line, w);
        if (out_.folds.cells > 0 && !reaches_across(rig_, spec_)) {
            if (spec_.smooth == Smooth::points) smooth_points(line);
            if (spec_.smooth == Smooth::directions) smooth_directions(line, w);
        }
        out_.lattice.description = describe();
        out_.lattice.hash = lattice_hash(out_.lattice);
        return std::move(out_);
    }

private:
    /// Refuses a lattice so fine that no solver could hold it: folds and overlaps would be looked
    /// for a long time.
    void require_room(std::size_t planes) const {
        constexpr double most = 8e9;  // vertices; a solver takes 2 bytes for each, in every frame
        const double i = vertices_along(spec_.u, spec_.spacing), j = vertices_beside(spec_),
                     all = i * j * static_cast<double>(planes);
        if (all <= most) return;
        throw Failure(fmt::format(
            "a spacing of {:g} makes {:.0f} x {:.0f} x {} vertices, which take {:.0f} GB in each "
            "frame; take about the size of a voxel, and {:.2g} at least",
            spec_.spacing, i, j, planes, 2e-9 * all, spec_.spacing * std::cbrt(all / most)));
    }

    void smooth_points(const Resampled& start) {
        Rig rig = rig_;
        rig.oval.reset();
        rig.points = start.points;
        // Keeps the rest of an open rig behind its last resampled point. Otherwise every iteration
        // would shorten the rig.
        if (!rig.closed && (rig_.points.back() - rig.points.back()).length() > 1e-3 * spec_.spacing)
            rig.points.push_back(rig_.points.back());
        const auto original = rig.points;
        while (out_.folds.cells > 0 && out_.iterations < spec_.max_iterations) {
            rig = smoothed(rig, 1);
            ++out_.iterations;
            const auto line = resampled(rig, spec_.spacing, planes_);
            assemble(line, plane_directions(line, rig.closed, spec_.closed_form));
        }
        out_.moved = sideways(original, rig.points, rig.closed);
    }

    void smooth_directions(const Resampled& line, std::vector<Vec3d>& w) {
        for (; out_.folds.cells > 0 && out_.iterations < spec_.max_iterations; ++out_.iterations) {
            w = smoothed_directions(w, rig_.closed);
            assemble(line, w);
        }
    }

    void assemble(const Resampled& line, const std::vector<Vec3d>& w) {
        const auto v = untwisted(line, w, rig_.closed, rig_.up);
        auto& lattice = out_.lattice;
        lattice.shape = form_of(spec_).shape;
        lattice.shape[2] = static_cast<int>(w.size());
        lattice.spacing = spec_.spacing;
        lattice.closed = rig_.closed;
        lattice.around = spec_.around;
        lattice.closed_form = spec_.closed_form;
        lattice.planes.clear();
        for (std::size_t k = 0; k < w.size(); ++k) {
            const auto u = (spec_.flip_u ? -1.0 : 1.0) * v[k].cross(w[k]).unit();
            const auto first =
                spec_.around ? line.points[k] : line.points[k] + spec_.u[0] * u + spec_.v[0] * v[k];
            lattice.planes.push_back({first, u, v[k], w[k]});
        }
        out_.step = line.step;
        out_.folds = count_folds(lattice, lattice.shape[0], lattice.shape[1]);
    }

    std::string describe() const {
        const auto& lattice = out_.lattice;
        if (lattice.around)
            return fmt::format(
                "lattice of {} x {} x {} vertices around {}, radius {:g}, spacing {:g}",
                lattice.shape[0], lattice.shape[1], lattice.shape[2], to_text(rig_), spec_.u[1],
                lattice.spacing);
        return fmt::format(
            "lattice of {} x {} x {} vertices along {}, u from {:g}, v from {:g}, spacing {:g}",
            lattice.shape[0], lattice.shape[1], lattice.shape[2], to_text(rig_), spec_.u[0],
            spec_.v[0], lattice.spacing);
    }

    const Rig& rig_;
    const LatticeSpec& spec_;
    std::optional<int> planes_;
    BuiltLattice out_;
};

}  // namespace

BuiltLattice build_lattice(const Rig& rig, const LatticeSpec& spec, std::optional<int> planes) {
    if (const auto fault = rig_fault(rig); !fault.empty()) throw Failure(fault);
    return Builder(rig, spec, planes).build();
}

double vertices_along(const std::array<double, 2>& extent, double spacing) {
    return std::floor((extent[1] - extent[0]) / spacing + 1e-3) + 1;
}

LatticeForm form_of(const LatticeSpec& spec) {
    return {{static_cast<int>(vertices_along(spec.u, spec.spacing)),
             static_cast<int>(vertices_beside(spec)), 0},
            false,
            spec.around};
}

bool reaches_across(const Rig& rig, const LatticeSpec& spec) {
    if (!rig.oval) return false;
    const double radius = rig.oval->x.length();
    return std::abs(radius - rig.oval->y.length()) <= 1e-12 * radius &&
           (spec.flip_u || spec.around ? spec.u[1] : -spec.u[0]) >= radius;
}

}  // namespace fluidcarve
