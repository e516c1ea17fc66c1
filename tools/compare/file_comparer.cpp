#include "tools/compare/file_comparer.h"

#include <cmath>

namespace fluidcarve {

double PartDifference::mean() const {
    return compared > not_finite ? sum / static_cast<double>(compared - not_finite) : 0;
}

double PartDifference::rms() const {
    return compared > not_finite ? std::sqrt(squares / static_cast<double>(compared - not_finite))
                                 : 0;
}

bool PartDifference::add(const PartDifference& frame) {
    compared += frame.compared;
    over += frame.over;
    warned += frame.warned;
    only_a += frame.only_a;
    only_b += frame.only_b;
    not_finite += frame.not_finite;
    sum += frame.sum;
    squares += frame.squares;
    if (!frame.worst || (worst && frame.peak <= peak)) return false;
    peak = frame.peak;
    worst = frame.worst;
    return true;
}

}  // namespace fluidcarve
