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
    /// An attracted vertex is worth a way through this many vertices of the highest energy.
    static constexpr float attraction_of_highest = 64;

    struct Shape {
        std::array<int, 3> lattice;  ///< vertices along u, v and w
        Axis axis;                   ///< of the columns
        std::size_t frames;
        bool closed = false;  ///< column k = K-1 is a neighbour of k = 0
        bool around = false;  ///< the last lateral column is a neighbour of the first
    };
    /// A volume whose energies are all 0.
    /// @param limits  of the energies
    /// @throws Failure as FrameStore
    explicit EnergyVolume(const Shape& shape, const Limits& limits = {});
    /// A volume of 32-bit costs instead of codes.
    /// @param costs  laid out as codes, frame after frame; infinite ones are protected
    EnergyVolume(const Shape& shape, std::vector<float> costs);

    /// Sets the cost of any step, in space and in time.
    void set_rigidity(const std::array<float, 2>& rigidity) { rigidity_ = rigidity; }
    const std::array<float, 2>& rigidity() const { return rigidity_; }
    /// Declares the entries to be prices of slabs of the volume `of` (SlabPrices), which must
    /// outlive this.
    void set_slabs(const EnergyVolume& of) { slabs_of_ = &of; }
    bool slabs() const { return slabs_of_ != nullptr; }
    /// The volume whose slabs are priced; else this one.
    const EnergyVolume& seen() const { return slabs_of_ ? *slabs_of_ : *this; }
    /// Sets how many entries on each side share the energy of an entry that remove() deletes; 0:
    /// none.
    void set_spread(int entries) { spread_ = entries; }
    /// Makes remove() hand on the edge cost of a deleted entry, if edges are counted, in place of
    /// its energy.
    void hand_on_edges() { hands_on_edges_ = true; }
    int spread() const { return spread_; }
    /// Frees steps of rigidity where the field is 0.
    void step_freely_in_nothing() { free_in_nothing_ = true; }
    bool steps_freely_in_nothing() const { return free_in_nothing_; }
    /// Adds a field, all 0. New edges in it cost something.
    /// @param weight  cost per unit by which the field changes across an edge
    /// @param limits  of the field
    void add_field(float weight, const Limits& limits = {});
    /// Sets the field of frames, from `t` on.
    /// @param codes  field codes, frame after frame, each laid out as its energies
    /// @throws Failure as FrameStore
    void set_field(std::size_t t, std::span<const std::uint16_t> codes) { field_->set(t, codes); }
    /// The field of a column. @param column  as in Seams::Seam::at
    const FieldRun& field(std::size_t column) const { return field_->runs()[column]; }
    /// The field codes of a frame, laid out as its energies.
    std::vector<std::uint16_t> field_codes(std::size_t t) const;
    bool has_field() const { return field_.has_value(); }
    float field_weight() const { return weight_; }
    void set_field_weight(float weight) { weight_ = weight; }
    /// Adds the cost of edges. Call it once energies and field are set. From then on an entry costs
    /// its energy plus the edge that its removal makes between the entries on either side; for a
    /// column's first and last entry, the edge between itself and the next.
    /// @param limits  of the energies without edges
    /// @throws Failure as FrameStore
    void count_edges(const Limits& limits = {});
    /// The costs of steps; points into the volume.
    StepCosts steps() const {
        const auto price = [&](float rigidity) {
            return StepPrice{rigidity, field_ && free_in_nothing_ ? 0 : rigidity, weight_};
        };
        return {{price(rigidity_[0]), price(rigidity_[1])},
                field_ ? field_->runs().data() : nullptr};
    }

    /// Counts the protected and attracted vertices. Until then protects() and attracts() are
    /// false.
    void find_marks();
    bool protects() const { return protects_; }
    std::size_t attracted() const { return attracted_; }  ///< attracted vertices left
    bool attracts() const { return attracted_ > 0; }
    EntryCosts costs() const { return {attraction_}; }
    /// A finite cost that stands for a protected vertex where it must be weighed against others.
    float barrier() const { return attraction_ * static_cast<float>(frames_summed_); }

    /// The costs for a seam that is the same in all frames: one frame of costs, summed over the
    /// frames, as 32-bit floats instead of codes.
    EnergyVolume sum() const;
    /// Whether entries are 32-bit costs instead of codes.
    bool summed() const { return !sums_.empty(); }

    int width() const { return width_; }  ///< entries per column; one less after each deletion
    int laterals() const { return laterals_; }
    int slices() const { return slices_; }  ///< columns per frame are laterals * slices
    std::size_t columns_per_frame() const {
        return static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_);
    }
    std::size_t frames() const { return frames_; }
    std::size_t stride() const { return stride_; }  ///< entries from a column to the next
    /// Bytes of energies and field, in memory or in files.
    std::uint64_t bytes() const;
    bool closed() const { return closed_; }
    bool around() const { return around_; }

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
    void remove(std::span<const std::uint16_t> at) { remove(at, {0, width_ - 1}); }

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
    /// Holds codes if there are no costs.
    EnergyVolume(const Shape& shape, std::vector<float> costs, const Limits& limits);

    /// Number of summed frames that attract at an entry.
    std::size_t attracted_at(std::size_t place) const;
    /// Adds the energy of an entry to its neighbours.
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

    int width_, laterals_, slices_, spread_ = 0;
    std::size_t frames_, stride_;
    bool closed_, around_, hands_on_edges_ = false;
    bool free_in_nothing_ = false;
    FrameStore codes_;
    std::vector<float> sums_;
    std::vector<float> energies_;  ///< sums_ without attraction; only if vertices are attracted
    std::size_t frames_summed_ = 1;
    const EnergyVolume* slabs_of_ = nullptr;
    bool protects_ = false;
    std::size_t attracted_ = 0;
    float attraction_ = 0;
    std::array<float, 2> rigidity_{};
    std::optional<FieldColumns> field_;  ///< with the energies before count_edges()
    float weight_ = 0;
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
