#pragma once

#include "carve/solver/costs/energy_volume.h"

#include <array>
#include <cstddef>

namespace fluidcarve {

/// A box of columns: from `begin` to before `end` along lateral, slice and frame.
struct ColumnBox {
    std::array<std::size_t, 3> begin, end;
};

/// The columns of an energy as a grid in lateral, slice and frame. Entries of a seam differ by at
/// most 1 between neighbouring columns.
class Columns {
public:
    static constexpr int directions = 6;
    static constexpr std::size_t none = ~std::size_t{0};
    /// The opposite direction.
    static constexpr unsigned back(unsigned direction) { return direction ^ 1; }

    explicit Columns(const EnergyVolume& energy) : Columns(energy.shape()) {}
    explicit Columns(const EnergyVolume::Shape& shape)
        : Columns(shape.lattice[lateral_dimension(shape.axis)],
                  shape.lattice[slice_dimension(shape.axis)], static_cast<int>(shape.frames),
                  shape.closed, shape.around) {}
    /// @param closed  the last slice is a neighbour of the first
    /// @param around  the last lateral column is a neighbour of the first
    Columns(int laterals, int slices, int frames, bool closed, bool around = false)
        : laterals_(static_cast<std::size_t>(laterals)),
          slices_(static_cast<std::size_t>(slices)),
          frames_(static_cast<std::size_t>(frames)),
          closed_(closed && slices > 1),
          around_(around && laterals > 1) {}

    std::size_t laterals() const { return laterals_; }
    std::size_t slices() const { return slices_; }
    std::size_t frames() const { return frames_; }
    /// Whether the lines along a dimension are rings.
    /// @param along  0 lateral, 1 slice, 2 frame
    bool ring(std::size_t along) const { return along == 0 ? around_ : along == 1 && closed_; }
    std::size_t per_frame() const { return laterals_ * slices_; }
    std::size_t count() const { return per_frame() * frames_; }
    std::size_t at(std::size_t lateral, std::size_t slice, std::size_t t) const {
        return lateral + laterals_ * (slice + slices_ * t);
    }

    /// The three indices of a column.
    struct Place {
        std::size_t lateral, slice, t;
    };
    Place place(std::size_t column) const {
        return {column % laterals_, column / laterals_ % slices_, column / laterals_ / slices_};
    }

    /// The neighbours of a column: before and behind it along lateral, slice, frame; or `none`.
    /// @param column  its index
    /// @param at      place(column)
    std::array<std::size_t, directions> neighbours(std::size_t column, const Place& at) const {
        std::array<std::size_t, directions> out;
        const auto row = laterals_ - 1, ring = laterals_ * (slices_ - 1), frame = per_frame();
        out[0] = at.lateral > 0 ? column - 1 : around_ ? column + row : none;
        out[1] = at.lateral + 1 < laterals_ ? column + 1 : around_ ? column - row : none;
        out[2] = at.slice > 0 ? column - laterals_ : closed_ ? column + ring : none;
        out[3] = at.slice + 1 < slices_ ? column + laterals_ : closed_ ? column - ring : none;
        out[4] = at.t > 0 ? column - frame : none;
        out[5] = at.t + 1 < frames_ ? column + frame : none;
        return out;
    }

private:
    std::size_t laterals_, slices_, frames_;
    bool closed_, around_;
};

}  // namespace fluidcarve
