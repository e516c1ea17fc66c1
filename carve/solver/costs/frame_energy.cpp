#include "carve/solver/costs/frame_energy.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/dense.h"
#include "carve/field/extent.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/half.h"
#include "carve/solver/costs/marks.h"
#include "carve/solver/costs/sample.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace fluidcarve {

namespace {

std::size_t plane_size(const std::array<int, 3>& shape) {
    return static_cast<std::size_t>(shape[0]) * static_cast<std::size_t>(shape[1]);
}

/// Counts taken while a frame is sampled.
struct Counts {
    std::size_t attract = 0, protect = 0;
    bool content = false;  ///< whether the energy at a vertex differs from the background
};

/// Samples a frame column by column, and halves it.
class Halves {
public:
    Halves(const FrameGrids& grids, const Lattice& lattice, Axis axis, Measure measure)
        : make_energy_(energy_sampler(grids.energy, lattice, axis, measure)),
          make_field_(grids.field ? field_sampler(*grids.field, lattice, axis) : nullptr),
          background_(encode_energy(grids.energy.background())),
          width_(lattice.shape[dimension(axis)]),
          laterals_(lattice.shape[lateral_dimension(axis)]),
          slices_(lattice.shape[slice_dimension(axis)]) {
        if (grids.attract) attract_.emplace(*grids.attract, lattice, axis);
        if (grids.protect) protect_.emplace(*grids.protect, lattice, axis);
    }

    Counts sample(FrameEnergy& out) {
        const int laterals = halved(laterals_), slices = halved(slices_),
                  across = (laterals + block - 1) / block;
        const auto counts = tbb::parallel_reduce(
            tbb::blocked_range<int>(0, across * ((slices + block - 1) / block)), Counts{},
            [&](const tbb::blocked_range<int>& range, Counts before) {
                for (int n = range.begin(); n < range.end(); ++n) {
                    const int lateral = block * (n % across), k = block * (n / across);
                    sample({lateral, std::min(lateral + block, laterals)},
                           {k, std::min(k + block, slices)}, before, out);
                }
                return before;
            },
            [](const Counts& a, const Counts& b) {
                return Counts{a.attract + b.attract, a.protect + b.protect, a.content || b.content};
            });
        bad_energy_.require_none(make_energy_, laterals_);
        if (make_field_) bad_field_.require_none(make_field_, laterals_);
        return counts;
    }

private:
    /// Coarse columns to either side that are sampled together: they pass the same leaves.
    static constexpr int block = 4;

    struct Range {
        int begin, end;
    };
    /// Samples the fine columns of some coarse columns.
    void sample(const Range& laterals, const Range& slices, Counts& counts, FrameEnergy& out) {
        const auto width = static_cast<std::size_t>(width_), coarse_width = halved(width);
        std::vector<std::uint16_t> codes(width);
        MeanEnergy energy(width);
        MeanField field(width);
        const auto sample_energy = make_energy_();
        const auto sample_field = make_field_ ? make_field_() : nullptr;
        auto attract = marker(attract_), protect = marker(protect_);
        const auto add = [&](int lateral, int k) {
            auto content = sampled(*sample_energy, bad_energy_, lateral, k, codes);
            counts.content = counts.content ||
                             std::ranges::any_of(
                                 content, [&](std::uint16_t code) { return code != background_; });
            const auto attracted = attract ? (*attract)(lateral, k, attracted_code, codes) : 0,
                       guarded = protect ? (*protect)(lateral, k, protected_code, codes) : 0;
            counts.attract += attracted;
            counts.protect += guarded;
            if (attracted + guarded > 0) content = codes;
            energy.add(content, static_cast<std::size_t>(content.data() - codes.data()));
            if (!sample_field) return;
            content = sampled(*sample_field, bad_field_, lateral, k, codes);
            field.add(content, static_cast<std::size_t>(content.data() - codes.data()));
        };
        for (int k = slices.begin; k < slices.end; ++k)
            for (int lateral = laterals.begin; lateral < laterals.end; ++lateral) {
                for (int fine_k = 2 * k; fine_k < std::min(2 * k + 2, slices_); ++fine_k)
                    for (int fine = 2 * lateral; fine < std::min(2 * lateral + 2, laterals_);
                         ++fine)
                        add(fine, fine_k);
                const auto column =
                    static_cast<std::size_t>(lateral) +
                    static_cast<std::size_t>(halved(laterals_)) * static_cast<std::size_t>(k);
                energy.end(std::span(out.energy).subspan(column * coarse_width, coarse_width));
                if (sample_field)
                    field.end(std::span(out.field).subspan(column * coarse_width, coarse_width));
            }
    }
    /// @return the pairs of entries outside of which all codes are 0
    std::span<std::uint16_t> sampled(ColumnSampler& sample, FirstInvalid& bad, int lateral, int k,
                                     std::span<std::uint16_t> codes) const {
        const auto [content, valid] = sample(lateral, k, codes);
        if (!valid)
            bad.meet(static_cast<std::size_t>(lateral) +
                     static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k));
        if (content.last < 0) return codes.first(0);
        const auto first = static_cast<std::size_t>(content.first) / 2 * 2,
                   end = std::min(static_cast<std::size_t>(content.last) / 2 * 2 + 2, codes.size());
        return codes.subspan(first, end - first);
    }
    static std::optional<MaskColumns::Marker> marker(const std::optional<MaskColumns>& mask) {
        return mask && !mask->empty() ? std::optional<MaskColumns::Marker>(*mask) : std::nullopt;
    }

    const MakeSampler make_energy_, make_field_;
    std::optional<MaskColumns> attract_, protect_;
    const std::uint16_t background_;
    const int width_, laterals_, slices_;
    FirstInvalid bad_energy_, bad_field_;
};

}  // namespace

void require_frame_fits(const FrameGrids& grids, const Lattice& lattice, std::uint64_t budget,
                        int finest) {
    const double bytes_per_vertex =
        sizeof(std::uint16_t) * (grids.field ? 2.0 : 1.0) / (finest * finest * finest);
    const auto bytes = [&](double spacing) {
        double out = bytes_per_vertex;
        for (const int vertices : lattice.shape)
            out *= std::floor((vertices - 1) * lattice.spacing / spacing + 1e-9) + 1;
        return out;
    };
    const double wanted = bytes(lattice.spacing);
    if (grid_fits(wanted, budget)) return;
    const auto size = grids.energy.voxelSize();
    const double voxel = std::max({size.x(), size.y(), size.z()});
    double fits = std::max(voxel, lattice.spacing);
    constexpr double wider = 1.25;
    while (!grid_fits(bytes(fits), budget)) fits *= wider;
    throw Failure(
        fmt::format("at a 'spacing' of {:.6g} the lattice has {} vertices, which take {} in each "
                    "frame, but --memory allows {}; the voxels of `energy` are {:.6g} wide: a "
                    "'spacing' of {:.6g} fits",
                    lattice.spacing, fmt::join(lattice.shape, " x "),
                    size_text(static_cast<std::uint64_t>(wanted)), size_text(budget), voxel, fits));
}

FrameEnergy sample_frame(const FrameGrids& grids, const Ref<Lattice>& lattice, Axis carved,
                         Measure measure, int finest) {
    const auto axis = sampled_axis(carved);
    FrameEnergy out;
    out.lattice = lattice;
    out.finest = finest;
    const auto shape = gathered_shape(lattice->shape, finest);
    out.energy.resize(plane_size(shape) * static_cast<std::size_t>(shape[2]));
    if (grids.field) out.field.resize(out.energy.size());
    Counts counts;
    if (finest == 1) {
        const auto background = encode_energy(grids.energy.background());
        sample_energy(grids.energy, *lattice, axis, out.energy, measure);
        counts.content =
            std::ranges::any_of(out.energy, [&](std::uint16_t code) { return code != background; });
        if (grids.attract)
            counts.attract =
                mark_vertices(*grids.attract, *lattice, axis, attracted_code, out.energy);
        if (grids.protect)
            counts.protect =
                mark_vertices(*grids.protect, *lattice, axis, protected_code, out.energy);
        if (grids.field)
            sample_columns(field_sampler(*grids.field, *lattice, axis), *lattice, axis, out.field);
    } else {
        counts = Halves(grids, *lattice, axis, measure).sample(out);
    }
    if (grids.attract) out.attract = counts.attract;
    if (grids.protect) out.protect = counts.protect;
    out.content = content_in(grids.energy, *lattice);
    // A count from a sample of voxels may miss the few that vertices meet.
    if (out.content.inside == 0 && counts.content) out.content.inside = 1;
    if (grids.attract) out.attract_missed = missed_range(*grids.attract);
    if (grids.protect) out.protect_missed = missed_range(*grids.protect);
    out.transform = grids.energy.transform().copy();
    if (const auto box = active_box(grids.energy); !box.empty())
        out.active = grids.energy.transform().indexToWorld(
            openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d()));
    if (grids.field) out.field_transform = grids.field->transform().copy();
    return out;
}

}  // namespace fluidcarve
