#include "carve/remap/voxels/soft_block.h"

#include "carve/simd/eight.h"

#include <span>

namespace fluidcarve {

namespace {

using openvdb::Coord;

constexpr Eight along_line{0, 1, 2, 3, 4, 5, 6, 7};

/// Displacements of eight entries of a column.
FLUIDCARVE_INLINE Eight eight_entries(const SmoothDisplacement& soft, std::span<const float> column,
                                      int entry) {
    const int from = entry - soft.first(), most = static_cast<int>(column.size()) - 1;
    if (from >= 0 && from + 7 <= most) return eight_at(column.data() + from);
    Eight out;
    for (int n = 0; n < 8; ++n)
        out[n] = column[static_cast<std::size_t>(std::clamp(from + n, 0, most))];
    return out;
}

/// Sets a point's bit.
FLUIDCARVE_INLINE void mark(std::array<std::uint8_t, SoftSources::voxels / 8>& bits,
                            std::ptrdiff_t point) {
    auto& row = bits[static_cast<std::size_t>(point) / 8];
    row = static_cast<std::uint8_t>(row | 1 << (point & 7));
}

/// The sources of eight points of a line, in the direction of rising entries.
struct LineSources {
    EightPlaces shift;
    Eight part;
    unsigned freed;  ///< a bit for each point
};

/// Finds the sources of lines under a step.
class SourceFinder {
public:
    SourceFinder(const CarveStep& step, const Beside& beside)
        : step_(step),
          soft_(*step.soft()),
          beside_(beside),
          axis_(step.axis()),
          lateral_(step.lateral_axis()),
          slice_(step.slice_axis()),
          low_(step.low()),
          high_(step.high()),
          origin_(step.origin()),
          last_before_(step.last_before()) {}

    /// @param vertex  of the voxel of the first point
    /// @return whether the line is in the step's lattice; if not, nothing is found
    FLUIDCARVE_INLINE bool find(const Coord& vertex, LineSources& out) const {
        out.freed = 0;
        // A point between two columns, or between two entries of one, moves by their mean.
        auto low_vertex = vertex, high_vertex = vertex;
        if (beside_.side < 0) --low_vertex[beside_.axis];
        if (beside_.side > 0) ++high_vertex[beside_.axis];
        if (!carved(low_vertex) || !carved(high_vertex)) return false;
        auto moved = displacements(low_vertex);
        if (beside_.side != 0) {
            const auto other = displacements(high_vertex);
            moved += (other - moved) * 0.5f;
        }
        auto at = vertex.asVec3d();
        at[beside_.axis] += 0.5 * beside_.side;
        const double u = at[axis_];
        // Coordinates are whole or halves: as floats they are exact.
        const auto down = eight_of(static_cast<float>(origin_ - u)) - along_line,
                   up = eight_of(static_cast<float>(last_before_ - u)) - along_line;
        const auto d = least(-least(-moved, -down), up);
        const auto towards_0 = __builtin_convertvector(d, EightPlaces);
        out.shift = towards_0 + (__builtin_convertvector(towards_0, Eight) > d);  // true is -1
        out.part = d - __builtin_convertvector(out.shift, Eight);
        const auto ends = step_.ends(at, 1);
        if (u < low_ || u + 7 > high_ || u < ends.begin || u + 7 > ends.end)
            leave_or_free(u, ends, out);
        return true;
    }

private:
    bool carved(const Coord& vertex) const { return step_.columns().has(vertex); }
    FLUIDCARVE_INLINE Eight displacements(const Coord& vertex) const {
        return eight_entries(soft_, soft_.column(vertex[lateral_], vertex[slice_]), vertex[axis_]);
    }
    /// Points beyond the ends stay, or are freed.
    void leave_or_free(double u, const CarveStep::Ends& ends, LineSources& out) const {
        for (int n = 0; n < 8; ++n) {
            const double point = u + n;
            const bool held = point >= low_ && point <= high_;
            if (held && point >= ends.begin && point <= ends.end) continue;
            if (held && point >= origin_ && point <= last_before_) {
                out.freed |= 1u << n;
                continue;
            }
            out.shift[n] = 0;
            out.part[n] = 0;
        }
    }

    const CarveStep& step_;
    const SmoothDisplacement& soft_;
    const Beside beside_;
    const int axis_, lateral_, slice_, low_, high_, origin_, last_before_;
};

}  // namespace

FLUIDCARVE_WIDE void find_sources(const StepLines& lines, const Coord& block, const Beside& beside,
                                  SoftSources& out) {
    const SourceFinder finder(lines.step, beside);
    const auto [p, q] = lines.across;
    auto corner = block;
    if (lines.direction < 0) corner[lines.index_axis] += 7;
    const auto first = lines.alignment.vertex(corner);
    const auto from_first = [&](int axis) {
        auto voxel = corner;
        ++voxel[axis];
        return lines.alignment.vertex(voxel) - first;
    };
    const auto along_p = from_first(p), along_q = from_first(q);
    const auto step =
        static_cast<std::ptrdiff_t>(lines.direction) * offset_stride(lines.index_axis);
    const auto begin =
        std::ptrdiff_t{corner[lines.index_axis] & 7} * offset_stride(lines.index_axis);
    out.in_lines.fill(0);
    out.freed.fill(0);
    auto smallest = EightPlaces{} + std::numeric_limits<int>::max(),
         largest = EightPlaces{} + std::numeric_limits<int>::min();
    LineSources line;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            if (!finder.find(first + Coord(i * along_p.x() + j * along_q.x(),
                                           i * along_p.y() + j * along_q.y(),
                                           i * along_p.z() + j * along_q.z()),
                             line))
                continue;
            smallest = line.shift < smallest ? line.shift : smallest;
            largest = line.shift > largest ? line.shift : largest;
            auto to = begin + i * offset_stride(p) + j * offset_stride(q);
            for (std::size_t n = 0; n < 8; ++n, to += step) {
                out.shift[static_cast<std::size_t>(to)] = line.shift[n];
                out.part[static_cast<std::size_t>(to)] = line.part[n];
                mark(out.in_lines, to);
                if (line.freed >> n & 1) mark(out.freed, to);
            }
        }
    out.least = smallest[0];
    out.most = largest[0];
    for (int n = 0; n < 8; ++n) {
        out.least = std::min(out.least, smallest[n]);
        out.most = std::max(out.most, largest[n]);
    }
}

}  // namespace fluidcarve
