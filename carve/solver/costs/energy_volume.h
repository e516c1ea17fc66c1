#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/limits.h"
#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/field_columns.h"
#include "carve/solver/costs/step_costs.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace fluidcarve {

/// What an entry costs the seam that takes it: its energy; infinity if it is protected; a negative
/// cost if it is attracted. A seam of least cost passes no protected vertex, and takes attracted
/// ones where that is worth the detour.
struct EntryCosts {
    float attraction = 0;  ///< an attracted entry costs minus this

    float operator()(std::uint16_t code) const {
        if (code < protected_code) return decode_energy(code);
        return code == protected_code ? std::numeric_limits<float>::infinity() : -attraction;
    }
    float operator()(float cost) const { return cost; }
};

/// The energy `E(i,j,k,t)` in which seams are found, and from which found seams are deleted. It has
/// one list of energy codes per frame (layout: sample_columns()). Besides energy, seams may pay for
/// steps between columns, and for the edges that their removal makes in a field.
class EnergyVolume {
public:
    struct Shape {
        std::array<int, 3> lattice;  ///< vertices along u, v and w
        Axis axis;                   ///< of the columns
        std::size_t frames;
        bool closed = false;  ///< column k = K-1 is a neighbour of k = 0
        bool around = false;  ///< the last lateral column is a neighbour of the first
    };
    /// @param limits  of the energies, and again of the field
    /// @param costs   32-bit costs instead of codes, laid out as these, frame after frame; infinite
    ///   ones are protected. Empty: codes, all 0
    /// @throws Failure as FrameStore
    explicit EnergyVolume(const Shape& shape, const Limits& limits = {},
                          std::vector<float> costs = {});
    /// The same shape with columns along u, as long as width(): a volume of it is laid out as this
    /// one is, when no entry is deleted yet.
    const Shape& shape() const { return shape_; }

    /// Sets what steps and edges cost; before count_edges().
    void set_step_prices(const StepPrices& prices) { step_prices_ = prices; }
    const StepPrices& step_prices() const { return step_prices_; }
    /// The costs of steps; points into the volume.
    StepCosts steps() const { return {step_prices_, field_ ? field_->runs().data() : nullptr}; }

    /// Declares the entries to be prices of slabs of the volume `of` (SlabPrices), which must
    /// outlive this.
    void set_slabs(const EnergyVolume& of) { slabs_of_ = &of; }
    bool slabs() const { return slabs_of_ != nullptr; }
    /// The volume whose slabs are priced; else this one.
    const EnergyVolume& seen() const { return slabs_of_ ? *slabs_of_ : *this; }

    /// Sets how many entries on each side share the energy of an entry that remove() deletes.
    /// @param entries  0: none
    /// @param edges    they share its edge cost, if edges are counted, in place of its energy
    void set_spread(int entries, bool edges) {
        spread_ = entries;
        spreads_edges_ = edges;
    }
    int spread() const { return spread_; }

    /// Sets the field of frames, from `t` on. The field of the others is 0 until it is set. To be
    /// called by one thread at a time: the first call makes the field.
    /// @param codes  field codes, frame after frame, each laid out as its energies
    /// @throws Failure as FrameStore
    void set_field(std::size_t t, std::span<const std::uint16_t> codes);
    /// The field of a column. @param column  as in Seams::Seam::at
    const FieldRun& field(std::size_t column) const { return field_->runs()[column]; }
    /// The field codes of a frame, laid out as its energies.
    std::vector<std::uint16_t> field_codes(std::size_t t) const;
    bool has_field() const { return field_.has_value(); }
    /// Adds the cost of edges in the field to the energies; once, when both are set. From then on
    /// an entry costs its energy plus the edge that its removal makes between the entries on either
    /// side; for a column's first and last entry, the edge between itself and the next.
    /// @param limits  of the energies without edges
    /// @throws Failure as FrameStore
    void count_edges(const Limits& limits);

    /// Counts the protected and attracted vertices. Until then protects() and attracts() are
    /// false.
    void find_marks();
    bool protects() const { return marks_.protect; }
    std::size_t attracted() const { return marks_.attracted; }  ///< attracted vertices left
    bool attracts() const { return marks_.attracted > 0; }
    EntryCosts costs() const { return {marks_.attraction}; }
    /// A finite cost that stands for a protected vertex where it must be weighed against others.
    float barrier() const { return marks_.barrier; }

    /// The costs for a seam that is the same in all frames: one frame of costs, summed over the
    /// frames, as 32-bit floats instead of codes.
    EnergyVolume sum() const;
    /// Whether entries are 32-bit costs instead of codes.
    bool summed() const { return !sums_.empty(); }

    /// Entries per column; one less after each deletion.
    int width() const { return shape_.lattice[0]; }
    int laterals() const { return shape_.lattice[1]; }
    int slices() const { return shape_.lattice[2]; }  ///< columns per frame are laterals * slices
    std::size_t columns_per_frame() const {
        return static_cast<std::size_t>(laterals()) * static_cast<std::size_t>(slices());
    }
    std::size_t frames() const { return shape_.frames; }
    std::size_t stride() const { return stride_; }  ///< entries from a column to the next
    /// Bytes of energies and field, in memory or in files.
    std::uint64_t bytes() const;

    std::span<std::uint16_t> codes(std::size_t t) { return codes_.entries(t); }
    const std::uint16_t* codes(std::size_t t) const { return codes_.entries(t).data(); }
    /// A frame's entries: codes (std::uint16_t), or float if summed().
    template <class Cell>
    const Cell* cells(std::size_t t) const {
        if constexpr (std::is_same_v<Cell, float>)
            return sums_.data() + t * columns_per_frame() * stride_;
        else return codes(t);
    }
    /// The entries of a sum as energies: attracted vertices count 0.
    const float* energies() const { return energies_.empty() ? sums_.data() : energies_.data(); }

    /// Deletes one entry of each column; the entries behind it move up. First, the entry's energy
    /// is added in equal shares to the unmarked entries of the window within `spread()` of it
    /// (importance diffusion, Cho et al. 2009). So seams do not bunch.
    /// @param at      as Seams::Seam::at, each below width() and inside the window
    /// @param window  the window in which seams are found now
    void remove(std::span<const std::uint16_t> at, Window window);
    /// The same with the whole axis as window.
    void remove(std::span<const std::uint16_t> at) { remove(at, {0, width() - 1}); }

    /// Counts of what a seam meets. In a sum, a marked vertex counts once for each frame that marks
    /// it.
    struct Met {
        std::size_t zeros = 0;      ///< columns where the seam meets no energy
        std::size_t attracted = 0;  ///< attracted vertices
        std::size_t blocked = 0;    ///< protected vertices that it passes
    };
    /// @param at  as for remove()
    Met met(std::span<const std::uint16_t> at) const;

private:
    /// What is known of marked vertices.
    struct KnownMarks {
        bool protect = false;       ///< whether some are protected
        std::size_t attracted = 0;  ///< number of attracted ones left
        float attraction = 0;       ///< EntryCosts::attraction
        float barrier = 0;          ///< attraction in all frames that a vertex stands for
    };

    /// Shares the energy of an entry among its neighbours in a column.
    /// @param column  as in Seams::Seam::at
    void hand_on(std::size_t column, int entry, Window window);
    /// Sets entries of a column to their energy plus the edge that their removal makes. Beyond the
    /// field's run there are no edges.
    /// @param column  as in Seams::Seam::at
    void set_edges(std::size_t column, int first, int last);
    bool edges_counted() const { return field_ && field_->has_energies(); }
    /// The energy codes of a column, edges included.
    std::uint16_t* codes_of(std::size_t column) {
        return codes_.entries(0).data() + column * stride_;
    }

    Shape shape_;
    std::size_t stride_;
    Limits limits_;
    FrameStore codes_;
    std::vector<float> sums_;
    std::vector<float> energies_;  ///< sums_ without attraction; only if vertices are attracted
    KnownMarks marks_;
    StepPrices step_prices_;
    std::optional<FieldColumns> field_;  ///< with the energies before count_edges()
    int spread_ = 0;
    bool spreads_edges_ = false;
    const EnergyVolume* slabs_of_ = nullptr;
};

/// Calls `call` with a function that returns the cost at (column, entry), columns as in
/// Seams::Seam::at.
template <class Call>
auto with_costs(const EnergyVolume& energy, const Call& call) {
    const auto in = [&](auto cell) {
        using Cell = decltype(cell);
        return call([&energy, costs = energy.costs(), per_frame = energy.columns_per_frame()](
                        std::size_t c, int entry) {
            return costs(energy.cells<Cell>(
                c / per_frame)[c % per_frame * energy.stride() + static_cast<std::size_t>(entry)]);
        });
    };
    return energy.summed() ? in(float{}) : in(std::uint16_t{});
}

}  // namespace fluidcarve
