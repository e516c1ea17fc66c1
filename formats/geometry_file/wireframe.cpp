#include "formats/geometry_file/wireframe.h"

#include "carve/lattice/lattice.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/provenance_comments.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string>
#include <vector>

namespace fluidcarve {

int every_by_default(int count) {
    constexpr int lines = 16;
    return (count + lines - 1) / lines;
}

std::vector<int> lined_vertices(int count, int every) {
    std::vector<int> out;
    for (int n = 0; n < count; n += every) out.push_back(n);
    if (out.back() != count - 1) out.push_back(count - 1);
    return out;
}

void write_wireframe(const std::string& path, const Lattice& lattice,
                     const std::array<int, 3>& every, const Provenance& provenance) {
    OutputFile file(path);
    std::ofstream out(file.aside(), std::ios::binary);
    out << "# " << lattice.description << "\n";
    for (const auto& line : provenance_comments(provenance, hash_comment)) out << line << "\n";
    std::array<std::vector<int>, 3> at;
    for (std::size_t n = 0; n < 3; ++n) at[n] = lined_vertices(lattice.shape[n], every[n]);
    for (const int k : at[2])
        for (const int j : at[1])
            for (const int i : at[0]) {
                const auto p = lattice.position(
                    {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
                out << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
            }

    const std::array size{at[0].size(), at[1].size(), at[2].size()};
    const std::array stride{std::size_t{1}, size[0], size[0] * size[1]};
    for (std::size_t along = 0; along < 3; ++along) {
        if (size[along] < 2) continue;
        const auto a = (along + 1) % 3, b = (along + 2) % 3;
        // Blender reads no more than the first two vertices of a line.
        for (std::size_t m = 0; m < size[a]; ++m)
            for (std::size_t n = 0; n < size[b]; ++n) {
                const auto first = 1 + m * stride[a] + n * stride[b],
                           last = first + (size[along] - 1) * stride[along];
                for (auto from = first; from < last; from += stride[along])
                    out << "l " << from << ' ' << from + stride[along] << '\n';
                if ((along == 2 && lattice.closed) || (along == 1 && lattice.around))
                    out << "l " << last << ' ' << first << '\n';
            }
    }
    file.commit(out);
}

}  // namespace fluidcarve
