#pragma once

#include "nodes/seam/energy/code.h"
#include "nodes/seam/energy/step_costs.h"
#include "nodes/seams/seams.h"
#include "nodes/seams/slab_store.h"
#include "nodes/seams/window.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace fluidcarve {

/// What an entry costs the seam that takes it: its energy; infinity if it is protected; if it is attracted, less than
/// nothing. Seams of least cost pass no protected vertex and as many attracted ones as is worth the way.
struct Costs {
    float attraction = 0;  ///< how much less than nothing

    float operator()(std::uint16_t code) const {
        if (code < protected_code) return decode_energy(code);
        return code == protected_code ? std::numeric_limits<float>::infinity() : -attraction;
    }
    float operator()(float cost) const { return cost; }
};

/// The energy `E(i,j,k,t)` in which seams are found, and from which found seams are deleted: one slab of energy codes
/// per frame (layout: sample_energy). Beside their energy seams may pay for steps between columns, and for the edges that
/// their removal makes in a field.
class EnergyVolume {
public:
    /// An attracted vertex is worth a way through so many of the highest energy.
    static constexpr float attraction_of_highest = 64;

    /// All energies 0. @throws Failure as SlabStore
    /// @param closed  column k = K-1 is a neighbour of k = 0
    EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::uint64_t memory_budget, const std::string& folder, bool closed = false);
    /// 32-bit costs in place of codes. @param costs  laid out as slabs, frame after frame
    EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::vector<float> costs, bool closed);

    /// What steps cost from now on, in space and in time.
    void set_rigidity(const std::array<float, 2>& rigidity) { rigidity_ = rigidity; }
    const std::array<float, 2>& rigidity() const { return rigidity_; }
    /// How far a deleted entry's energy is handed on, in entries to both sides; 0: it is gone (remove).
    void set_spread(int entries) { spread_ = entries; }
    int spread() const { return spread_; }
    /// Makes room for a field, whose new edges are to cost something. @throws Failure as SlabStore
    /// @param weight  for each unit by which the field changes across an edge
    void add_field(float weight, std::uint64_t memory_budget, const std::string& folder);
    /// The codes of a frame's field, laid out as its energies.
    std::span<std::uint16_t> field(std::size_t t) { return field_->slab(t); }
    std::span<const std::uint16_t> field(std::size_t t) const { return field_->slab(t); }
    bool has_field() const { return field_.has_value(); }
    float field_weight() const { return weight_; }
    void set_field_weight(float weight) { weight_ = weight; }
    /// Once energies and field are there: from now on an entry costs, beside its energy, the edge that its removal makes
    /// between the entries on either side; of a column's first and last entry, between itself and the next.
    /// @throws Failure as SlabStore
    void count_edges(std::uint64_t memory_budget, const std::string& folder);
    /// What steps cost; points into the volume.
    StepCosts steps() const { return {rigidity_, field_ ? field_->slab(0).data() : nullptr, stride_, weight_}; }

    /// Looks for protected and attracted vertices in the slabs. Until then there are none.
    void find_marks();
    bool protects() const { return protects_; }
    std::size_t attracted() const { return attracted_; }  ///< vertices that are left
    bool attracts() const { return attracted_ > 0; }
    Costs costs() const { return {attraction_}; }
    /// A cost that stands for a protected vertex where it must be weighed against others.
    float barrier() const { return attraction_ * static_cast<float>(frames_summed_); }

    /// What a seam costs that is the same in all frames: one frame of costs summed over the frames, 32-bit floats in
    /// place of codes.
    EnergyVolume sum() const;
    /// Whether entries are costs in 32-bit floats.
    bool summed() const { return !sums_.empty(); }

    int width() const { return width_; }  ///< entries per column, fewer after each deletion
    int laterals() const { return laterals_; }
    int slices() const { return slices_; }  ///< columns per frame are laterals * slices
    std::size_t columns_per_frame() const { return static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(slices_); }
    std::size_t frames() const { return frames_; }
    std::size_t stride() const { return stride_; }  ///< entries from a column to the next
    bool closed() const { return closed_; }

    std::span<std::uint16_t> slab(std::size_t t) { return slabs_.slab(t); }
    const std::uint16_t* slab(std::size_t t) const { return slabs_.slab(t).data(); }
    /// A frame's entries: codes (std::uint16_t), or float if summed().
    template <class Cell>
    const Cell* cells(std::size_t t) const {
        if constexpr (std::is_same_v<Cell, float>) return sums_.data() + t * columns_per_frame() * stride_;
        else return slab(t);
    }
    /// The same for the energies of a sum, in which attracted vertices count 0.
    const float* energies() const { return energies_.empty() ? sums_.data() : energies_.data(); }

    /// Deletes one entry of each column; what is behind it moves up. First its energy goes in equal shares to the entries of the
    /// window that are within `spread()` of it and not marked (importance diffusion, Cho et al. 2009): so the next seam finds it
    /// dearer there, and seams do not bunch.
    /// @param at      as Seams::Seam::at, each below width() and inside the window
    /// @param window  in which seams are found now
    void remove(std::span<const std::uint16_t> at, Window window);
    /// The same, where the window is all of the axis.
    void remove(std::span<const std::uint16_t> at) { remove(at, {0, width_ - 1}); }

    /// What a seam meets. In a sum, marked vertices count once for each frame that marks them.
    struct Met {
        std::size_t zeros = 0;  ///< columns without energy
        std::size_t attracted = 0;
        std::size_t blocked = 0;  ///< columns in which it passes a protected vertex
    };
    /// @param at  as for remove
    Met met(std::span<const std::uint16_t> at) const;

private:
    std::size_t attracted_at(std::size_t place) const;  ///< in how many of the frames that a sum is of
    /// Hands the energy of an entry on to those beside it. @param column  as in Seams::Seam::at
    void hand_on(std::size_t column, int entry, Window window);
    /// What an entry of a column costs with the edge that its removal makes; columns as in Seams::Seam::at.
    std::uint16_t with_edge(std::size_t column, int entry) const;

    int width_, laterals_, slices_, spread_ = 0;
    std::size_t frames_, stride_;
    bool closed_;
    SlabStore slabs_;
    std::vector<float> sums_;
    std::vector<float> energies_;  ///< beside sums_, if vertices are attracted
    std::size_t frames_summed_ = 1;
    bool protects_ = false;
    std::size_t attracted_ = 0;
    float attraction_ = 0;
    std::array<float, 2> rigidity_{};
    std::optional<SlabStore> field_, without_edges_;  ///< and the energies as they were before count_edges
    float weight_ = 0;
};

/// Calls back with a function that gives the cost at (column, entry), columns as in Seams::Seam::at.
template <class Call>
auto with_costs(const EnergyVolume& energy, const Call& call) {
    const auto in = [&](auto cell) {
        using Cell = decltype(cell);
        return call([&energy, costs = energy.costs(), per_frame = energy.columns_per_frame()](std::size_t c, int entry) {
            return costs(energy.cells<Cell>(c / per_frame)[c % per_frame * energy.stride() + static_cast<std::size_t>(entry)]);
        });
    };
    return energy.summed() ? in(float{}) : in(std::uint16_t{});
}

}  // namespace fluidcarve
