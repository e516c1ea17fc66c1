#include "carve/solver/costs/sample.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/extent.h"
#include "carve/field/leaf_cell.h"
#include "carve/lattice/alignment.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/column_places.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

// The encoding of values, and the message about a value that cannot be encoded.
struct EnergyCode {
    static std::uint16_t encode(float value) { return encode_energy(value); }
    static constexpr std::uint16_t invalid = invalid_energy_code;
    static constexpr auto what = "the energy is {} at {}; energies must be from {:g} to {:.3g}";
    static float least() { return 0; }
    static float most() { return decode_energy(highest_energy_code); }
};
struct FieldCode {
    static std::uint16_t encode(float value) { return encode_field(value); }
    static constexpr std::uint16_t invalid = invalid_field_code;
    static constexpr auto what =
        "the field is {} at {}; a solver takes values from {:g} to {:g}: put it through "
        "energy.remap, which maps it to 0 to 1";
    static float least() { return -highest_field; }
    static float most() { return highest_field; }
};

/// Encodes entries of a column one by one.
/// @param among   entries to read; all others get the code of `beyond`
template <class Code, class Read>
ColumnSampler::Sampled encode_each(Read& read, const Window& among, float beyond,
                                   std::span<std::uint16_t> codes) {
    const auto code_beyond = Code::encode(beyond);
    const auto first = static_cast<std::size_t>(among.first),
               end = first + static_cast<std::size_t>(among.size());
    std::ranges::fill(codes.first(first), code_beyond);
    for (auto entry = first; entry < end; ++entry)
        codes[entry] = Code::encode(read(static_cast<int>(entry)));
    std::ranges::fill(codes.subspan(end), code_beyond);
    const bool whole = code_beyond != 0;
    return {whole ? Window{0, static_cast<int>(codes.size()) - 1} : among,
            std::ranges::find(codes, Code::invalid) == codes.end()};
}

/// Box outside of which a grid has its background everywhere.
openvdb::CoordBBox box_of_values(const openvdb::FloatGrid& grid) {
    openvdb::CoordBBox out;
    auto tile = grid.tree().cbeginValueAll();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (!same_bits(*tile, grid.background())) out.expand(tile.getBoundingBox());
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) out.expand(leaf->getNodeBoundingBox());
    return out;
}

/// Reads values by voxel index. All readers move to a column and then read its entries: its
/// vertices stand on a line at equal distances.
class ByIndex {
public:
    /// @param entries  of each column
    ByIndex(const openvdb::FloatGrid& grid, const Alignment& alignment, Axis axis, int entries)
        : values_(grid.getConstAccessor()),
          alignment_(alignment),
          step_(alignment.step[static_cast<std::size_t>(axis)]),
          entries_(entries) {}
    void move_to(const std::array<int, 3>& first) {
        first_ = alignment_.voxel(first[0], first[1], first[2]);
    }
    float operator()(int entry) { return values_.getValue(at(entry)); }
    /// Encodes the column run by run: the entries in one leaf at once, and entries outside of
    /// leaves by one value.
    template <class Code>
    ColumnSampler::Sampled encode(std::span<std::uint16_t> codes) {
        if (!in_same_blocks()) find_runs();
        ColumnSampler::Sampled out{{0, -1}};
        int entry = 0;
        for (const auto& run : runs_) {
            const auto codes_of_run =
                codes.subspan(static_cast<std::size_t>(entry), static_cast<std::size_t>(run.size));
            if (run.values) {
                const auto* value = run.values + Leaf::coordToOffset(at(entry));
                for (auto& code : codes_of_run) {
                    code = Code::encode(*value);
                    out.valid = out.valid && code != Code::invalid;
                    value += offset_;
                }
            } else {
                const auto code = Code::encode(run.value);
                std::ranges::fill(codes_of_run, code);
                out.valid = out.valid && code != Code::invalid;
            }
            if (run.values || codes_of_run.front() != 0) {
                if (out.content.last < 0) out.content.first = entry;
                out.content.last = entry + run.size - 1;
            }
            entry += run.size;
        }
        return out;
    }

private:
    using Leaf = openvdb::FloatTree::LeafNodeType;
    /// Entries in one leaf, or beside each other outside of leaves with one value.
    struct Run {
        int size;
        const float* values;  ///< of the leaf, if there is one
        float value;          ///< otherwise
    };

    /// Whether this column passes the blocks of the column whose runs are known. All columns begin
    /// at the same place along the axis.
    bool in_same_blocks() const {
        if (runs_.empty()) return false;
        for (int n = 0; n < 3; ++n)
            if (step_[n] == 0 && (first_[n] ^ runs_begin_[n]) >> 3 != 0) return false;
        return true;
    }
    void find_runs() {
        runs_begin_ = first_;
        runs_.clear();
        for (int entry = 0; entry < entries_;) {
            const auto voxel = at(entry);
            const int count = std::min(in_block(voxel), entries_ - entry);
            entry += count;
            const auto* const leaf = values_.probeConstLeaf(voxel);
            const Run run{count, leaf ? leaf->buffer().data() : nullptr,
                          leaf ? 0 : values_.getValue(voxel)};
            const bool goes_on = !leaf && !runs_.empty() && !runs_.back().values &&
                                 same_bits(runs_.back().value, run.value);
            if (goes_on) runs_.back().size += count;
            else runs_.push_back(run);
        }
    }
    openvdb::Coord at(int entry) const {
        return first_ + openvdb::Coord(entry * step_.x(), entry * step_.y(), entry * step_.z());
    }
    /// How many entries, from a voxel on, lie in its block of 8^3 voxels.
    int in_block(const openvdb::Coord& voxel) const {
        int out = 8;
        for (int n = 0; n < 3; ++n) {
            const int left = step_[n] > 0 ? 7 - (voxel[n] & 7) : voxel[n] & 7;
            if (step_[n] != 0) out = std::min(out, left / std::abs(step_[n]) + 1);
        }
        return out;
    }

    openvdb::FloatGrid::ConstAccessor values_;
    const Alignment alignment_;
    const openvdb::Coord step_;
    const int entries_;
    /// From an entry to the next in a leaf.
    const std::ptrdiff_t offset_ = 64 * step_.x() + 8 * step_.y() + step_.z();
    openvdb::Coord first_;
    std::vector<Run> runs_;      ///< of a column
    openvdb::Coord runs_begin_;  ///< that column's first voxel
};

/// Samples values between voxels.
class Trilinear {
public:
    explicit Trilinear(const openvdb::FloatGrid& grid) : values_(grid.getConstAccessor()) {}
    /// @param q  index coordinates
    float operator()(const Vec3d& q) {
        using Sampler = openvdb::tools::BoxSampler;
        const auto low = voxel_below(q);
        float cell[2][2][2];
        const auto* const leaf = in_one_leaf(low) ? values_.probeConstLeaf(low) : nullptr;
        if (leaf) read_cell(*leaf, low, cell);
        else Sampler::getValues(cell, values_, low);
        return Sampler::trilinearInterpolation(cell, q - low.asVec3d());
    }

private:
    openvdb::FloatGrid::ConstAccessor values_;
};

/// Samples values at the vertices.
class AtVertices {
public:
    /// @param box  outside of which the grid has its background
    AtVertices(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& box,
               const Lattice& lattice, Axis axis)
        : sample_(grid),
          background_(grid.background()),
          reach_(box.empty() ? box : padded(box, 1)),
          places_(grid.transform(), lattice, axis) {}
    void move_to(const std::array<int, 3>& first) { places_.move_to(first); }
    float operator()(int entry) { return sample_(places_(entry)); }
    template <class Code>
    ColumnSampler::Sampled encode(std::span<std::uint16_t> codes) {
        return encode_each<Code>(*this, places_.within(reach_, static_cast<int>(codes.size())),
                                 background_, codes);
    }

private:
    Trilinear sample_;
    const float background_;
    const openvdb::CoordBBox reach_;  ///< of the voxels around a vertex that may have another value
    ColumnPlaces places_;
};

constexpr double most_samples = 1000;  // of the space nearest to a vertex

/// Averages over the space nearest to each vertex.
class OverCells {
public:
    OverCells(const openvdb::FloatGrid& grid, const Lattice& lattice, Axis axis)
        : sample_(grid), transform_(grid.transform()), lattice_(lattice), axis_(axis) {}
    void move_to(const std::array<int, 3>& first) { first_ = Vec3d(first[0], first[1], first[2]); }
    float operator()(int entry) {
        auto at = first_;
        at[static_cast<int>(axis_)] += entry;
        // Except around a rig, vertices of a plane are one spacing apart: only the distance
        // between planes varies.
        const auto& plane = lattice_.planes[static_cast<std::size_t>(at.z())];
        const auto across =
            0.5 * (lattice_.position(at + Vec3d(0, 0, 1)) - lattice_.position(at - Vec3d(0, 0, 1)));
        const double straight = std::abs(across.dot(plane.u.cross(plane.v))) / lattice_.spacing,
                     volume = straight * share_of_turn(at);
        const int samples =
            static_cast<int>(std::clamp(std::ceil(volume - whole), 1.0, most_samples));
        double sum = 0;
        for (int n = 0; n < samples; ++n) {
            const auto off = (n + 0.5) / samples - 0.5;
            sum +=
                sample_(snapped(transform_.worldToIndex(lattice_.position(at + Vec3d(0, 0, off)))));
        }
        return static_cast<float>(volume * sum / samples);
    }
    template <class Code>
    ColumnSampler::Sampled encode(std::span<std::uint16_t> codes) {
        return encode_each<Code>(*this, {0, static_cast<int>(codes.size()) - 1}, 0, codes);
    }

private:
    /// Around a rig: area of the part of a plane nearest to a vertex, in squares of the spacing.
    /// Else 1.
    double share_of_turn(const Vec3d& at) const {
        if (!lattice_.around) return 1;
        const double inner = std::max(at.x() - 0.5, 0.0), outer = at.x() + 0.5;
        return M_PI * (outer * outer - inner * inner) / lattice_.shape[1];
    }

    static constexpr double whole = 1e-6;
    Trilinear sample_;
    const openvdb::math::Transform& transform_;
    const Lattice& lattice_;
    const Axis axis_;
    Vec3d first_;
};

template <class Code, class Reader>
class SamplerOf : public ColumnSampler {
public:
    SamplerOf(const Lattice& lattice, Axis axis, Reader reader)
        : lattice_(lattice), axis_(axis), read_(std::move(reader)) {}

    Sampled operator()(int lateral, int k, std::span<std::uint16_t> codes) override {
        read_.move_to(vertex_of(axis_, 0, lateral, k));
        return read_.template encode<Code>(codes);
    }
    void report(int lateral, int k) override {
        read_.move_to(vertex_of(axis_, 0, lateral, k));
        for (int entry = 0; entry < lattice_.shape[dimension(axis_)]; ++entry) {
            const float value = read_(entry);
            if (Code::encode(value) != Code::invalid) continue;
            const auto at = vertex_of(axis_, entry, lateral, k);
            const auto world = lattice_.position(Vec3d(at[0], at[1], at[2]));
            throw Failure(
                fmt::format(fmt::runtime(Code::what), value,
                            fmt::format("({}), vertex ({})", numbers_text(world), numbers_text(at)),
                            Code::least(), Code::most()));
        }
    }

private:
    const Lattice& lattice_;
    const Axis axis_;
    Reader read_;
};

/// @param make_reader  makes what reads the values of one thread's columns
template <class Code, class MakeReader>
MakeSampler sampler_of(const Lattice& lattice, Axis axis, const MakeReader& make_reader) {
    return [&lattice, axis, make_reader] {
        return std::make_unique<SamplerOf<Code, decltype(make_reader())>>(lattice, axis,
                                                                          make_reader());
    };
}

/// Samples at the vertices.
template <class Code>
MakeSampler vertex_sampler(const openvdb::FloatGrid& grid, const Lattice& lattice, Axis axis) {
    if (const auto alignment = align(lattice, grid.transform()))
        return sampler_of<Code>(
            lattice, axis,
            [&grid, alignment = *alignment, axis, entries = lattice.shape[dimension(axis)]] {
                return ByIndex(grid, alignment, axis, entries);
            });
    return sampler_of<Code>(lattice, axis, [&grid, &lattice, axis, box = box_of_values(grid)] {
        return AtVertices(grid, box, lattice, axis);
    });
}

}  // namespace

MakeSampler energy_sampler(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis,
                           Measure measure) {
    if (measure == Measure::vertex || lattice.is_box())
        return vertex_sampler<EnergyCode>(energy, lattice, axis);
    return sampler_of<EnergyCode>(
        lattice, axis, [&energy, &lattice, axis] { return OverCells(energy, lattice, axis); });
}

MakeSampler field_sampler(const openvdb::FloatGrid& field, const Lattice& lattice, Axis axis) {
    return vertex_sampler<FieldCode>(field, lattice, axis);
}

void sample_columns(const MakeSampler& make, const Lattice& lattice, Axis axis,
                    std::span<std::uint16_t> codes) {
    const auto entries = static_cast<std::size_t>(lattice.shape[dimension(axis)]),
               laterals = static_cast<std::size_t>(lattice.shape[lateral_dimension(axis)]);
    FirstInvalid invalid;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, codes.size() / entries, 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const auto sample = make();
                          for (auto column = range.begin(); column < range.end(); ++column)
                              if (!(*sample)(static_cast<int>(column % laterals),
                                             static_cast<int>(column / laterals),
                                             codes.subspan(column * entries, entries))
                                       .valid)
                                  invalid.meet(column);
                      });
    invalid.require_none(make, static_cast<int>(laterals));
}

void FirstInvalid::require_none(const MakeSampler& make, int laterals) const {
    if (const auto column = first_.load(); column != none)
        make()->report(static_cast<int>(column % static_cast<std::size_t>(laterals)),
                       static_cast<int>(column / static_cast<std::size_t>(laterals)));
}

}  // namespace fluidcarve
