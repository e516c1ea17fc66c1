#include "nodes/preview/seam_lines.h"

#include "carve/seam/carve_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

/// One dimension of the columns, extended by half a vertex at both ends.
class Rimmed {
public:
    /// @param closed  the first column follows the last; no extension
    explicit Rimmed(int size, bool closed = false) : size_(size), closed_(closed) {}
    int size() const { return size_ + (closed_ ? 1 : 2); }
    int column(int n) const { return closed_ ? n % size_ : std::clamp(n - 1, 0, size_ - 1); }
    double coordinate(int n) const {
        return closed_ ? n % size_ : std::clamp(n - 1.0, -0.5, size_ - 0.5);
    }

private:
    int size_;
    bool closed_;
};

/// Intersects the seams of one frame with the plane of a picture.
class Surfaces {
public:
    Surfaces(const Lattice& lattice, const Seams& seams, std::size_t t,
             const openvdb::math::Transform& space, View view, int plane)
        : lattice_(lattice),
          seams_(seams),
          t_(t),
          space_(space),
          view_(view),
          plane_(plane),
          laterals_(seams.laterals(), seams.around),
          slices_(seams.slices(), seams.slices_close()) {}

    std::vector<PictureLine> lines() {
        struct Reach {
            double low, high;
        };
        std::vector<Reach> reach;
        for (int k = 0; k < slices_.size(); ++k)
            for (int lateral = 0; lateral < laterals_.size(); ++lateral) {
                const auto first = depth(place(-0.5, lateral, k));
                const auto last = depth(place(seams_.before() - 0.5, lateral, k));
                reach.push_back({std::min(first, last), std::max(first, last)});
            }
        const auto row = static_cast<std::size_t>(laterals_.size());
        for (int k = 0; k + 1 < slices_.size(); ++k)
            for (int lateral = 0; lateral + 1 < laterals_.size(); ++lateral) {
                const auto* const near =
                    &reach[static_cast<std::size_t>(k) * row + static_cast<std::size_t>(lateral)];
                const double low =
                    std::min({near[0].low, near[1].low, near[row].low, near[row + 1].low});
                const double high =
                    std::max({near[0].high, near[1].high, near[row].high, near[row + 1].high});
                if (low <= 0 && high >= 0) cross(lateral, k);
            }
        return std::move(lines_);
    }

private:
    Vec3d place(double entry, int lateral, int k) const {
        const double other = laterals_.coordinate(lateral), z = slices_.coordinate(k);
        return space_.worldToIndex(
            lattice_.position(Vec3d(vertex_of(seams_.axis, entry, other, z).data())));
    }
    double depth(const Vec3d& at) const { return at[static_cast<int>(view_)] - plane_; }

    /// Where a column crosses a surface.
    struct Crossing {
        std::pair<int, int> surface;  ///< tells surfaces apart
        double at;                    ///< along the carved axis, in the uncarved lattice
        bool operator<(const Crossing& other) const { return surface < other.surface; }
    };

    /// All seams of a window in one column.
    void cross_seams(const std::vector<Seams::Seam>& seams, Seams::Kind kind, int lateral, int k,
                     std::vector<Crossing>& out) {
        const auto column = static_cast<std::size_t>(laterals_.column(lateral)) +
                            static_cast<std::size_t>(seams_.laterals()) *
                                static_cast<std::size_t>(slices_.column(k)) +
                            t_ * seams_.columns_per_frame();
        entries_.clear();
        for (const auto& seam : seams) entries_.push_back(seam.at[column]);
        if (kind == Seams::Kind::remove) to_original(entries_, sorted_);
        const double behind = kind == Seams::Kind::insert ? 0.5 : 0;
        out.clear();
        for (std::size_t n = 0; n < entries_.size(); ++n)
            out.push_back({{static_cast<int>(n), 0}, entries_[n] + behind});
    }

    /// The places of a column from which on the warp moves another whole vertex further: where it
    /// moves by a whole number and a half. It may do so several times.
    void cross_warp(int lateral, int k, std::vector<Crossing>& out) {
        shifts_.resize(static_cast<std::size_t>(seams_.before()));
        seams_.warp->column(t_, laterals_.column(lateral), slices_.column(k), shifts_);
        out.clear();
        for (std::size_t u = 0; u + 1 < shifts_.size(); ++u) {
            const double from = shifts_[u], to = shifts_[u + 1];
            const int low = static_cast<int>(std::floor(std::min(from, to) + 0.5)),
                      high = static_cast<int>(std::floor(std::max(from, to) + 0.5));
            for (int level = low; level < high; ++level) {
                const auto before = std::ranges::count_if(
                    out, [&](const Crossing& other) { return other.surface.first == level; });
                out.push_back({{level, static_cast<int>(before)},
                               static_cast<double>(u) + (level + 0.5 - from) / (to - from)});
            }
        }
        std::ranges::sort(out, std::less<>());
    }

    void cross(int lateral, int k) {
        if (seams_.warp)
            return cross(lateral, k,
                         [this](int j, int slice, auto& out) { cross_warp(j, slice, out); });
        cross(lateral, k, [this](int j, int slice, auto& out) {
            cross_seams(seams_.seams, seams_.kind, j, slice, out);
        });
        cross(lateral, k, [this](int j, int slice, auto& out) {
            cross_seams(seams_.pairs, opposite(seams_.kind), j, slice, out);
        });
    }

    /// Intersects all surfaces between four neighbouring columns, each as two triangles.
    /// @param crossings  finds those of a column, in the order of their surfaces
    template <class Crossings>
    void cross(int lateral, int k, const Crossings& crossings) {
        constexpr std::array<std::array<int, 2>, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t c = 0; c < 4; ++c)
            crossings(lateral + corners[c][0], k + corners[c][1], crossings_[c]);
        for (const auto& first : crossings_[0]) {
            std::array<Vec3d, 4> at;
            bool all = true;
            for (std::size_t c = 0; c < 4; ++c) {
                const auto found = std::ranges::lower_bound(crossings_[c], first, std::less<>());
                all = all && found != crossings_[c].end() && found->surface == first.surface;
                if (all) at[c] = place(found->at, lateral + corners[c][0], k + corners[c][1]);
            }
            // A surface of a warp may end between columns.
            if (!all) continue;
            cross(at[0], at[1], at[2]);
            cross(at[0], at[2], at[3]);
        }
    }

    void cross(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        const auto [right, up] = picture_axes(view_);
        std::array<std::array<double, 2>, 2> ends{};
        std::size_t found = 0;
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
            const double below = depth(from), above = depth(to);
            if ((below < 0) == (above < 0)) continue;
            const auto at = from + (to - from) * (below / (below - above));
            // Index coordinates refer to voxel centres, picture coordinates to voxel borders.
            ends[found++] = {at[right] + 0.5, at[up] + 0.5};
        }
        // A triangle that only touches the plane with a vertex gives no line.
        if (found == 2 && std::hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]) > 1e-6)
            lines_.push_back({ends[0], ends[1]});
    }

    const Lattice& lattice_;
    const Seams& seams_;
    std::size_t t_;
    const openvdb::math::Transform& space_;
    View view_;
    int plane_;
    Rimmed laterals_, slices_;
    std::array<std::vector<Crossing>, 4> crossings_;
    std::vector<std::uint16_t> entries_, sorted_;
    std::vector<float> shifts_;
    std::vector<PictureLine> lines_;
};

}  // namespace

bool seams_face(const Lattice& lattice, Axis axis, const openvdb::math::Transform& space,
                View view) {
    if (lattice.around) return false;
    const Vec3d middle(0.5 * (lattice.shape[0] - 1), 0.5 * (lattice.shape[1] - 1),
                       0.5 * (lattice.shape[2] - 1));
    Vec3d step(0);
    step[static_cast<int>(axis)] = 1;
    const auto along = space.worldToIndex(lattice.position(middle + step)) -
                       space.worldToIndex(lattice.position(middle));
    return std::abs(along[static_cast<int>(view)]) > 0.9 * along.length();
}

std::size_t require_seams(const Lattice& lattice, const Seams& seams, int frame) {
    // A map of 0 seams only checks whether they fit.
    static_cast<void>(CarveMap(lattice, {Ref<Seams>(Ref<Seams>(), &seams)}, frame, 0));
    return static_cast<std::size_t>(std::ranges::find(seams.frames, frame) - seams.frames.begin());
}

std::vector<PictureLine> seam_lines(const Lattice& lattice, const Seams& seams, int frame,
                                    const openvdb::math::Transform& space, View view, int plane) {
    return Surfaces(lattice, seams, require_seams(lattice, seams, frame), space, view, plane)
        .lines();
}

}  // namespace fluidcarve
