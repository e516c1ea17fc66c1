#include "carve/seam/seams.h"

#include <cmath>

namespace fluidcarve {

std::array<int, 3> Seams::shape_after(std::size_t count) const {
    auto out = shape;
    if (paired() || in_time() || count == 0) return out;
    if (warp) out[dimension(axis)] = warped().size();
    else out[dimension(axis)] += growth(kind, static_cast<int>(count));
    return out;
}

int Seams::shift_after(std::size_t count) const {
    if (paired() || in_time() || count == 0) return 0;
    if (warp) return warped().first;
    const int n = static_cast<int>(count);
    switch (anchor.at) {
        case Anchor::At::low: return 0;
        case Anchor::At::middle: return -growth(kind, n / 2);
        case Anchor::At::high: return -growth(kind, n);
        case Anchor::At::vertex: return shifts.at(count);
    }
    return 0;
}

Window Seams::warped() const {
    // Smaller parts of a vertex are rounding errors.
    constexpr double none = 1e-4;
    const auto first = warp->scaled(warp->bounds().first), last = warp->scaled(warp->bounds().last);
    return {static_cast<int>(std::floor(first.least + none)),
            before() - 1 + static_cast<int>(std::ceil(last.most - none))};
}

void Seams::find_shifts() {
    shifts.clear();
    if (anchor.at != Anchor::At::vertex || paired()) return;
    shifts.push_back(0);
    if (seams.empty()) return;
    // `[column]`: displacement of the anchor's content. Removals are indices in the space that
    // earlier removals leave.
    std::vector<int> moves(columns(), 0);
    std::int64_t sum = 0;
    for (const auto& seam : seams) {
        for (std::size_t c = 0; c < moves.size(); ++c) {
            const bool moves_it =
                seam.at[c] < anchor.vertex - (kind == Kind::remove ? moves[c] : 0);
            if (!moves_it) continue;
            ++moves[c];
            ++sum;
        }
        const auto mean = static_cast<int>(
            std::lround(static_cast<double>(sum) / static_cast<double>(moves.size())));
        shifts.push_back(-growth(kind, mean));
    }
}

std::string Seams::lattice_hash_at(std::size_t t) const {
    std::size_t begin = 0, end = lattice_hash.find(',');
    for (; t > 0 && end != std::string::npos; --t) {
        begin = end + 1;
        end = lattice_hash.find(',', begin);
    }
    return lattice_hash.substr(begin, end - begin);
}

std::string to_text(const Anchor& anchor) {
    switch (anchor.at) {
        case Anchor::At::low: return "low";
        case Anchor::At::middle: return "middle";
        case Anchor::At::high: return "high";
        case Anchor::At::vertex: break;
    }
    return std::to_string(anchor.vertex);
}

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
