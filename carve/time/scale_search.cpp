#include "carve/time/scale_search.h"

#include <cmath>

namespace fluidcarve {

double least_error_at(const std::function<double(double)>& error) {
    double best = 0, least = error(0);
    constexpr double finest = 0.05, farthest = 8, step = 1.5;
    for (double at = finest; at < farthest; at *= step)
        if (const double here = error(at); here < least) {
            least = here;
            best = at;
        }
    if (best == 0) return 0;
    const double golden = (std::sqrt(5.0) - 1) / 2;
    double low = best / step, high = best * step;
    double x = high - golden * (high - low), y = low + golden * (high - low), at_x = error(x),
           at_y = error(y);
    while (high - low > 0.02 * best) {
        const bool lower = at_x < at_y;
        (lower ? high : low) = lower ? y : x;
        (lower ? y : x) = lower ? x : y;
        (lower ? at_y : at_x) = lower ? at_x : at_y;
        auto& fresh = lower ? x : y;
        fresh = lower ? high - golden * (high - low) : low + golden * (high - low);
        (lower ? at_x : at_y) = error(fresh);
    }
    return (low + high) / 2;
}

}  // namespace fluidcarve
