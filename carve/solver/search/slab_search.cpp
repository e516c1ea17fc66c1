#include "carve/solver/search/slab_search.h"

#include <algorithm>

namespace fluidcarve {

void SlabSearch::price(int thickness) {
    prices_.reset();
    prices_ = measured_.priced(volume_, thickness,
                               thick_.weights.empty.value_or(SlabPrices::emptiness.front()), taken_,
                               limits_);
    if (static_) sum_ = prices_->sum();
}

Seams::Seam SlabSearch::find(const FindSeam& solver, int thickness, Window left, int number,
                             const Tick& tick) {
    // Solvers that continue from the last seam start over: prices change everywhere.
    const auto once = [&] { return solver(prices(), left, 2 * number, tick); };
    auto out = once();
    if (thick_.weights.empty) return out;
    for (std::size_t n = 1; n < SlabPrices::emptiness.size(); ++n) {
        const auto at = in_all_frames(out.at);
        if (measured_.content_share(volume_, at, thickness,
                                    {left.first, left.last + thickness - 1}) >= SlabPrices::enough)
            break;
        measured_.set_empty(*prices_, volume_, thickness, SlabPrices::emptiness[n], taken_);
        if (static_) sum_ = prices_->sum();
        out = once();
    }
    return out;
}

SeamEntries SlabSearch::in_all_frames(std::span<const std::uint16_t> at) const {
    return static_ ? SeamEntries::repeated(at, volume_.frames())
                   : SeamEntries(std::vector<std::uint16_t>(at.begin(), at.end()));
}

void SlabSearch::take(std::span<const std::uint16_t> at, int thickness) {
    const auto all = in_all_frames(at);
    if (doubled_) return taken_.push_back({all, thickness});
    for (int n = 0; n < thickness; ++n) volume_.remove(all);
    for (auto& slab : taken_)
        for (std::size_t c = 0; c < all.size(); ++c) {
            auto& entry = slab.at.all()[c];
            if (entry > all[c])
                entry = static_cast<std::uint16_t>(std::max<int>(all[c], entry - thickness));
        }
    taken_.push_back({all, 0});
}

}  // namespace fluidcarve
