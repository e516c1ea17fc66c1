#include "formats/seam_file/curves.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/seam/carve_map.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/ply.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/geometry_file/wireframe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fluidcarve {

namespace {

/// A colour for the n-th seam: neighbours in the order of finding differ most, as their hues are a
/// golden section of the circle apart.
std::array<std::uint8_t, 3> colour_of(std::size_t n) {
    const double hue = std::fmod(static_cast<double>(n) * (std::numbers::phi - 1), 1.0);
    std::array<std::uint8_t, 3> out{};
    for (std::size_t c = 0; c < 3; ++c) {
        // A hue as the height of three waves, a third of the circle apart.
        const double wave =
            std::abs(std::fmod(6 * hue + std::array{0.0, 4.0, 2.0}[c], 6.0) - 3) - 1;
        out[c] = static_cast<std::uint8_t>(
            std::lround(255 * (0.25 + 0.75 * std::clamp(wave, 0.0, 1.0))));
    }
    return out;
}

/// Finds the curves of one frame.
class Finder {
public:
    Finder(const Lattice& lattice, const Seams& seams, std::size_t t,
           const std::array<int, 2>& every)
        : lattice_(lattice),
          seams_(seams),
          t_(t),
          laterals_(lined_vertices(seams.laterals(), every[0])),
          slices_(lined_vertices(seams.slices(), every[1])) {}

    std::vector<SeamCurves> find() {
        std::vector<SeamCurves> out(seams_.seams.size() + seams_.pairs.size());
        const std::size_t step = seams_.paired() ? 2 : 1;
        for (std::size_t n = 0; n < out.size(); ++n) out[n].colour = colour_of(n / step);
        for (int k = 0; k < seams_.slices(); ++k)
            for (int lateral = 0; lateral < seams_.laterals(); ++lateral) {
                const bool across = std::ranges::binary_search(slices_, k),
                           along = std::ranges::binary_search(laterals_, lateral);
                if (!across && !along) continue;
                number_[column(lateral, k)] = next_++;
                place(seams_.seams, seams_.kind, lateral, k, out, 0, step);
                place(seams_.pairs, opposite(seams_.kind), lateral, k, out, 1, step);
            }
        const auto edges = edges_between();
        for (auto& each : out) each.edges = edges;
        return out;
    }

private:
    std::size_t column(int lateral, int k) const {
        return static_cast<std::size_t>(lateral) +
               static_cast<std::size_t>(seams_.laterals()) * static_cast<std::size_t>(k);
    }

    /// Adds the vertices of all seams of a window in a column.
    /// @param first, step  of their places in `out`
    void place(const std::vector<Seams::Seam>& seams, Seams::Kind kind, int lateral, int k,
               std::vector<SeamCurves>& out, std::size_t first, std::size_t step) {
        entries_.clear();
        for (const auto& seam : seams)
            entries_.push_back(seam.at[column(lateral, k) + t_ * seams_.columns_per_frame()]);
        if (kind == Seams::Kind::remove) to_original(entries_, sorted_);
        const double behind = kind == Seams::Kind::insert ? 0.5 : 0;
        for (std::size_t n = 0; n < seams.size(); ++n) {
            const auto at = vertex_of(seams_.axis, entries_[n] + behind,
                                      static_cast<double>(lateral), static_cast<double>(k));
            out[first + n * step].vertices.push_back(lattice_.position(openvdb::Vec3d(at.data())));
        }
    }

    /// The edges that all seams share: between neighbouring columns on a curve.
    std::vector<std::array<std::uint32_t, 2>> edges_between() const {
        std::vector<std::array<std::uint32_t, 2>> out;
        for (const int k : slices_)
            for (int lateral = 0; lateral + 1 < seams_.laterals(); ++lateral)
                out.push_back({number_[column(lateral, k)], number_[column(lateral + 1, k)]});
        for (const int lateral : laterals_) {
            for (int k = 0; k + 1 < seams_.slices(); ++k)
                out.push_back({number_[column(lateral, k)], number_[column(lateral, k + 1)]});
            if (seams_.slices_close())
                out.push_back(
                    {number_[column(lateral, seams_.slices() - 1)], number_[column(lateral, 0)]});
        }
        return out;
    }

    const Lattice& lattice_;
    const Seams& seams_;
    std::size_t t_;
    std::vector<int> laterals_, slices_;
    std::uint32_t next_ = 0;
    /// `[column]`: index of its vertex.
    std::vector<std::uint32_t> number_ = std::vector<std::uint32_t>(seams_.columns_per_frame());
    std::vector<std::uint16_t> entries_, sorted_;
};

std::string ply_text(const std::vector<SeamCurves>& curves, const Provenance& provenance) {
    std::size_t vertices = 0, edges = 0;
    for (const auto& each : curves) vertices += each.vertices.size(), edges += each.edges.size();
    std::vector<std::string> statements{fmt::format("element vertex {}", vertices)};
    for (const auto* const name : {"x", "y", "z"})
        statements.push_back(fmt::format("property float {}", name));
    const auto colours = [&] {
        for (const auto* const name : {"red", "green", "blue"})
            statements.push_back(fmt::format("property uchar {}", name));
    };
    colours();
    statements.push_back(fmt::format("element edge {}", edges));
    for (const auto* const name : {"vertex1", "vertex2"})
        statements.push_back(fmt::format("property int {}", name));
    colours();
    auto out = ply_header_text(NumberForm::little, provenance_comments(provenance, ply_comment),
                               statements);
    const bool swap = is_swapped(NumberForm::little);
    const auto put_colour = [&](const SeamCurves& each) {
        for (const auto part : each.colour) put_number(out, part, NumberType::uint8, swap);
    };
    for (const auto& each : curves)
        for (const auto& at : each.vertices) {
            for (int n = 0; n < 3; ++n) put_number(out, at[n], NumberType::float32, swap);
            put_colour(each);
        }
    std::size_t first = 0;
    for (const auto& each : curves) {
        for (const auto& edge : each.edges) {
            for (const auto vertex : edge)
                put_number(out, static_cast<double>(first + vertex), NumberType::int32, swap);
            put_colour(each);
        }
        first += each.vertices.size();
    }
    return out;
}

std::string obj_text(const std::vector<SeamCurves>& curves, const Provenance& provenance) {
    std::string out;
    for (const auto& line : provenance_comments(provenance, hash_comment)) out += line + "\n";
    std::size_t first = 1;
    for (std::size_t n = 0; n < curves.size(); ++n) {
        out += fmt::format("o seam_{:04}\n", n);
        for (const auto& at : curves[n].vertices)
            out += fmt::format("v {:.9g} {:.9g} {:.9g}\n", at.x(), at.y(), at.z());
        for (const auto& edge : curves[n].edges)
            out += fmt::format("l {} {}\n", first + edge[0], first + edge[1]);
        first += curves[n].vertices.size();
    }
    return out;
}

}  // namespace

std::vector<SeamCurves> seam_curves(const Lattice& lattice, const Seams& seams, int frame,
                                    const std::array<int, 2>& every) {
    // A map of 0 seams only checks whether they fit.
    static_cast<void>(CarveMap(lattice, {Ref<Seams>(Ref<Seams>(), &seams)}, frame, 0));
    const auto t = std::ranges::find(seams.frames, frame) - seams.frames.begin();
    return Finder(lattice, seams, static_cast<std::size_t>(t), every).find();
}

void write_seam_curves(const std::string& path, const std::vector<SeamCurves>& curves,
                       const Provenance& provenance) {
    OutputFile::write(path, ending_of(path) == ".obj" ? obj_text(curves, provenance)
                                                      : ply_text(curves, provenance));
}

}  // namespace fluidcarve
