#include "nodes/remap/voxels/soft_block.h"

namespace fluidcarve {

namespace {

using openvdb::Coord;

using EightFloats = std::array<float, 8>;

/// Displacements of eight entries of a column.
EightFloats eight_of(const SmoothDisplacement& soft, std::span<const float> column, int entry) {
    EightFloats out;
    const int from = entry - soft.first(), most = static_cast<int>(column.size()) - 1;
    if (from >= 0 && from + 7 <= most) std::copy_n(column.data() + from, out.size(), out.begin());
    else
        for (int n = 0; n < 8; ++n) out[static_cast<std::size_t>(n)] = column[static_cast<std::size_t>(std::clamp(from + n, 0, most))];
    return out;
}

/// The sources of eight points of a line, in the direction of rising entries.
struct LineSources {
    std::array<std::int32_t, 8> shift{};
    EightFloats part{};
    unsigned freed = 0;  ///< a bit for each point
};

/// @param vertex  of the voxel of the first point
LineSources sources_of(const CarveStep& step, const Coord& vertex, const Beside& beside) {
    LineSources out;
    // A point between two columns, or between two entries of one, moves by their mean.
    auto low_vertex = vertex, high_vertex = vertex;
    if (beside.side < 0) --low_vertex[beside.axis];
    if (beside.side > 0) ++high_vertex[beside.axis];
    const int axis = step.axis(), lateral = step.lateral_axis();
    const auto carved = [&](const Coord& at) { return step.has_column(at[lateral], at.z()); };
    if (!carved(low_vertex) || !carved(high_vertex)) return out;
    const auto& soft = *step.soft();
    const auto read = [&](const Coord& at) { return eight_of(soft, soft.column(at[lateral], at.z()), at[axis]); };
    auto moved = read(low_vertex);
    if (beside.side != 0) {
        const auto other = read(high_vertex);
        for (std::size_t n = 0; n < moved.size(); ++n) moved[n] += (other[n] - moved[n]) * 0.5f;
    }
    auto at = vertex.asVec3d();
    at[beside.axis] += 0.5 * beside.side;
    const double u = at[axis];
    // Coordinates are whole or halves: as floats they are exact.
    const auto down = static_cast<float>(step.origin() - u), up = static_cast<float>(step.last_before() - u);
    // Without branches, for vector instructions.
    for (int n = 0; n < 8; ++n) {
        const auto i = static_cast<std::size_t>(n);
        const float d = std::min(std::max(moved[i], down - static_cast<float>(n)), up - static_cast<float>(n));
        const int towards_0 = static_cast<int>(d), below = towards_0 - (static_cast<float>(towards_0) > d ? 1 : 0);
        out.shift[i] = below;
        out.part[i] = d - static_cast<float>(below);
    }
    const auto [begin, end] = step.ends(at, 1);
    if (u >= step.low() && u + 7 <= step.high() && u >= begin && u + 7 <= end) return out;
    for (int n = 0; n < 8; ++n) {
        const double point = u + n;
        const bool held = point >= step.low() && point <= step.high();
        if (held && point >= begin && point <= end) continue;
        const auto i = static_cast<std::size_t>(n);
        out.shift[i] = 0;
        out.part[i] = 0;
        if (held && point >= step.origin() && point <= step.last_before()) out.freed |= 1u << n;
    }
    return out;
}

}  // namespace

void find_sources(const SoftLines& lines, const Coord& block, const Beside& beside, SoftSources& out) {
    const int p = lines.index_axis == 0 ? 1 : 0, q = lines.index_axis == 2 ? 1 : 2;
    Coord corner = block, beside_p, beside_q;
    if (lines.direction < 0) corner[lines.index_axis] += 7;
    const auto first = lines.alignment.vertex(corner);
    const auto from_first = [&](int axis) {
        auto voxel = corner;
        ++voxel[axis];
        return lines.alignment.vertex(voxel) - first;
    };
    const auto along_p = from_first(p), along_q = from_first(q);
    const auto step = static_cast<std::ptrdiff_t>(lines.direction) * offset_stride(lines.index_axis);
    out.freed.reset();
    out.least = out.most = 0;
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            const auto line = sources_of(
                lines.step, first + Coord(i * along_p.x() + j * along_q.x(), i * along_p.y() + j * along_q.y(), i * along_p.z() + j * along_q.z()), beside);
            auto to = (corner[lines.index_axis] & 7) * offset_stride(lines.index_axis) + i * offset_stride(p) + j * offset_stride(q) + std::ptrdiff_t{0};
            for (std::size_t n = 0; n < 8; ++n, to += step) {
                out.shift[static_cast<std::size_t>(to)] = line.shift[n];
                out.part[static_cast<std::size_t>(to)] = line.part[n];
                out.least = std::min(out.least, line.shift[n]);
                out.most = std::max(out.most, line.shift[n]);
                if (line.freed >> n & 1) out.freed.set(static_cast<std::size_t>(to));
            }
        }
}

}  // namespace fluidcarve
