#include "carve/seam/choice.h"

#include "carve/field/extent.h"
#include "carve/seam/carve_map.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

namespace fluidcarve {

namespace {

constexpr int most_rows = 128;   ///< of a plane
constexpr int most_planes = 32;  ///< of a frame

/// How many numbers of seams are compared, in equal steps up to all, besides none.
constexpr std::size_t parts = 8;

constexpr float visible_share = 0.02f;  ///< of the greatest value of a frame: lower values are
                                        ///< empty space
constexpr Softness softness{3, 0};      ///< the default of carves

/// Largest number of seams that may be chosen: all; of doubled slabs, as many whole slabs as a
/// third of the lattice's vertices holds, since more would show repeats side by side.
std::size_t most_of(const Seams& set) {
    if (!set.thick() || set.kind == Seams::Kind::remove) return set.size();
    const int third = set.before() / 3;
    return std::min(set.size(), static_cast<std::size_t>(third - third % set.thickness));
}

/// The numbers of seams that are compared: from none to as many as may be chosen, in whole slabs.
std::vector<std::size_t> counts_of(const Seams& set) {
    const auto most = most_of(set), slab = static_cast<std::size_t>(set.thickness),
               slabs = (most + slab - 1) / slab;
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n <= parts; ++n)
        if (const auto count = std::min(most, (n * slabs + parts / 2) / parts * slab);
            out.empty() || count > out.back())
            out.push_back(count);
    return out;
}

/// A part of a plane of the lattice.
struct Plane {
    int slice, first_row;
    PlaneSamples source;
};

/// Planes at even distances, the middle rows of each.
std::vector<Plane> planes_of(const Seams& set, const Lattice& lattice, const FloatGrid& field) {
    const int slices = set.slices(), count = std::min(slices, most_planes),
              rows = std::min(set.laterals(), most_rows);
    std::vector<Plane> out;
    for (int n = 0; n < count; ++n)
        out.push_back({(2 * n + 1) * slices / (2 * count), (set.laterals() - rows) / 2,
                       PlaneSamples(set.before(), rows)});
    tbb::parallel_for(std::size_t{0}, out.size(), [&](std::size_t n) {
        auto& [slice, first_row, source] = out[n];
        const openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler> sample(field);
        for (int row = 0; row < source.rows; ++row)
            for (int u = 0; u < source.width; ++u) {
                const auto at = vertex_of<double>(set.axis, u, first_row + row, slice);
                source.row(row)[u] = sample.isSample(
                    near_place(field.worldToIndex(lattice.position(openvdb::Vec3d(at.data())))));
            }
    });
    return out;
}

/// A plane carved by some seams, then scaled evenly to a number of vertices.
PlaneSamples carved(const Plane& plane, const CarveMap& map, int width) {
    const auto& source = plane.source;
    PlaneSamples out(width, source.rows);
    const CarveStep* const step = map.empty() ? nullptr : &map.steps().front();
    const int left = step ? step->after() : source.width;
    const double scale = width > 1 ? static_cast<double>(left - 1) / (width - 1) : 0;
    for (int row = 0; row < source.rows; ++row) {
        const auto* const values = source.row(row);
        // The source of a carved entry.
        const auto from = [&](int entry) {
            if (!step) return static_cast<double>(entry);
            const int at = step->start() + entry;
            return at - step->origin() +
                   static_cast<double>(step->soft()->entry(
                       at, step->columns().first_lateral + plane.first_row + row,
                       step->columns().first_slice + plane.slice));
        };
        for (int u = 0; u < width; ++u) {
            const double place = u * scale;
            const int low = std::min(static_cast<int>(place), left - 1),
                      high = std::min(low + 1, left - 1);
            const double at = std::clamp(from(low) + (place - low) * (from(high) - from(low)), 0.0,
                                         source.width - 1.0);
            const int before = static_cast<int>(at),
                      behind = std::min(before + 1, source.width - 1);
            out.row(row)[u] = static_cast<float>(
                values[before] +
                (at - before) * static_cast<double>(values[behind] - values[before]));
        }
    }
    return out;
}

}  // namespace

SeamChoice::SeamChoice(Ref<Seams> seams)
    : seams_(std::move(seams)), counts_(counts_of(*seams_)), distances_(counts_.size()) {}

void SeamChoice::add(const Lattice& lattice, const FloatGrid& field, int frame) {
    if (seams_->size() == 0) return;
    const auto& set = *seams_;
    const int all = static_cast<int>(set.size()), after = set.before() + growth(set.kind, all);
    const auto planes = planes_of(set, lattice, field);
    float highest = 0;
    for (const auto& plane : planes)
        highest = std::max(highest, *std::ranges::max_element(plane.source.values));
    const float visible = visible_share * highest;
    std::vector<CarveMap> maps;
    for (const auto count : counts_)
        maps.emplace_back(lattice, std::vector<Ref<Seams>>{seams_}, frame, count,
                          std::span(&softness, 1));
    std::vector<Distances> found(maps.size() * planes.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t n) {
        const auto& plane = planes[n % planes.size()];
        const auto result = carved(plane, maps[n / planes.size()], after);
        found[n] = {nearest_patches(result, plane.source, visible, all),
                    nearest_patches(plane.source, result, visible, all)};
    });
    for (std::size_t n = 0; n < found.size(); ++n) {
        distances_[n / planes.size()].of_result += found[n].of_result;
        distances_[n / planes.size()].of_input += found[n].of_input;
    }
}

std::vector<double> SeamChoice::distances() const {
    const double even = distances_.front().sum();
    std::vector<double> out;
    for (const auto& each : distances_) out.push_back(even > 0 ? each.sum() / even : 1);
    return out;
}

std::size_t SeamChoice::best() const {
    const auto all = distances();
    return counts_[static_cast<std::size_t>(std::ranges::min_element(all) - all.begin())];
}

}  // namespace fluidcarve
