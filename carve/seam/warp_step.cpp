// The code of carve steps made from a warp. It is separate from carve_step.cpp, since it needs
// smoothed displacements, which need carve steps.
#include "carve/seam/carve_step.h"
#include "carve/seam/smooth_displacement.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

namespace fluidcarve {

void CarveStep::find_displacements(const Warp& warp, std::size_t t) {
    column_ends_.reserve(columns_.count());
    common_ = {static_cast<double>(origin_), static_cast<double>(last_before())};
    for (int k = 0; k < columns_.slices; ++k)
        for (int lateral = 0; lateral < columns_.laterals; ++lateral) {
            const auto [first, last] = warp.ends(t, lateral, k);
            column_ends_.push_back({origin_ + first, last_before() + last});
            common_ = {std::max(common_.begin, origin_ + first),
                       std::min(common_.end, last_before() + last)};
        }
    soft_ = std::make_shared<const SmoothDisplacement>(SmoothDisplacement::of(*this, warp, t));

    struct Found {
        int first, last;
        float least = 0, most = 0;
    };
    const auto found = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, columns_.count(), 64), Found{high() + 1, low() - 1},
        [&](const tbb::blocked_range<std::size_t>& range, Found out) {
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto column = soft_->column(c);
                for (std::size_t n = 0; n < column.size(); ++n) {
                    if (column[n] == 0) continue;
                    const int entry = start_ + static_cast<int>(n);
                    out = {std::min(out.first, entry), std::max(out.last, entry),
                           std::min(out.least, column[n]), std::max(out.most, column[n])};
                }
            }
            return out;
        },
        [](const Found& a, const Found& b) {
            return Found{std::min(a.first, b.first), std::max(a.last, b.last),
                         std::min(a.least, b.least), std::max(a.most, b.most)};
        });
    // Freed entries count as moved.
    first_moved_ = common_.begin > origin_ ? low() : found.first;
    last_moved_ = common_.end < last_before() ? high() : found.last;
    most_down_ = static_cast<int>(std::ceil(-found.least));
    most_up_ = static_cast<int>(std::ceil(found.most));
}

}  // namespace fluidcarve
