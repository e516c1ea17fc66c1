#include "nodes/seam/seams.h"

namespace fluidcarve {

std::array<int, 3> Seams::shape_after(std::size_t count) const {
    auto out = shape;
    if (paired()) return out;
    auto& size = out[static_cast<std::size_t>(axis)];
    size += kind == Kind::remove ? -static_cast<int>(count) : static_cast<int>(count);
    return out;
}

std::string Seams::lattice_hash_at(std::size_t t) const {
    std::size_t begin = 0, end = lattice_hash.find(',');
    for (; t > 0 && end != std::string::npos; --t) {
        begin = end + 1;
        end = lattice_hash.find(',', begin);
    }
    return lattice_hash.substr(begin, end - begin);
}

std::string to_text(Axis axis) { return axis == Axis::u ? "u" : "v"; }

std::string to_text(Seams::Kind kind) { return kind == Seams::Kind::remove ? "remove" : "insert"; }

void to_original(std::span<std::uint16_t> entries, std::vector<std::uint16_t>& scratch) {
    scratch.clear();
    for (auto& entry : entries) {
        std::size_t place = 0;
        while (place < scratch.size() && scratch[place] <= entry) {
            ++entry;
            ++place;
        }
        scratch.insert(scratch.begin() + static_cast<std::ptrdiff_t>(place), entry);
    }
}

}  // namespace fluidcarve
