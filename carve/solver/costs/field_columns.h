#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/limits.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/lanes.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fluidcarve {

/// The part of a column in which a field is not 0. It begins and ends with an entry where the field
/// is 0, unless the column begins or ends there. So all edges of the field lie in it.
struct FieldRun {
    std::uint16_t* codes = nullptr;     ///< field codes of its entries
    std::uint16_t* energies = nullptr;  ///< energy codes of its entries without edge costs; null:
                                        ///< edges cost nothing
    int first = 0, end = 0;             ///< its entries; end is behind the last

    bool has(int entry) const { return entry >= first && entry < end; }
    std::uint16_t& energy(int entry) const { return energies[entry - first]; }
    /// The field at an entry of the column.
    float value(int entry) const {
        return decode_field(
            static_cast<std::uint16_t>(codes[entry - first] & -static_cast<int>(has(entry))));
    }
    /// The field at four entries from `entry` on. They may lie up to 8 entries outside the column,
    /// where the field is 0.
    Lanes values(int entry) const {
        return within(field_lanes(codes + (entry - first)), lanes_within(first, end - 1, entry));
    }
    /// The field at many entries, likewise.
    /// @param entry  the first of them
    void read(int entry, std::span<float> out) const;
    /// Deletes an entry of the column; those behind it move up.
    /// @param width   number of entries left
    /// @param column  energy codes of the entries left
    void remove(int entry, int width, const std::uint16_t* column);
};

/// The field of a sequence in columns. It stores only the part of each column that is not 0, so
/// its size is that of the content.
class FieldColumns {
public:
    /// A field of 0.
    /// @param columns  of a frame
    /// @param width    entries of a column
    /// @param limits   of codes; frames beyond them are held in files
    FieldColumns(std::size_t frames, std::size_t columns, int width, const Limits& limits);

    /// Sets frames, from `t` on.
    /// @param codes  their field codes, `[t][column][entry]`
    /// @throws Failure as FrameStore
    void set(std::size_t t, std::span<const std::uint16_t> codes);
    /// Makes room for the energies of all runs.
    /// @param limits  as for the field
    /// @throws Failure as FrameStore
    void add_energies(const Limits& limits);
    bool has_energies() const { return energies_.has_value(); }

    /// Runs of all frames, `[t][column]`.
    std::span<FieldRun> runs() { return runs_; }
    std::span<const FieldRun> runs() const { return runs_; }
    std::uint64_t bytes() const;  ///< of codes and runs

private:
    /// Codes of frames; in files beyond the limits.
    class Codes {
    public:
        Codes(std::size_t frames, Limits limits);
        /// Makes room for `count` codes of a frame, in place of its old ones.
        std::uint16_t* make(std::size_t t, std::size_t count);
        std::uint64_t bytes() const;

    private:
        Limits limits_;
        std::vector<FrameStore> stores_;
    };

    /// Makes room for the codes of a frame's runs, between margins.
    void make(Codes& codes, std::size_t t, std::uint16_t* FieldRun::*of);

    /// Codes before the first run and behind the last. Runs are read without branches, so codes
    /// beside them are read too, and ignored.
    std::size_t margin() const { return width_ + most_beside; }

    /// Entries before and behind a column that may be read.
    static constexpr std::size_t most_beside = 2 * lane_count;
    std::size_t columns_, width_;
    Codes fields_;
    std::optional<Codes> energies_;
    std::vector<std::uint16_t> nothing_;  ///< the codes of runs that are not set
    std::vector<FieldRun> runs_;
};

}  // namespace fluidcarve
