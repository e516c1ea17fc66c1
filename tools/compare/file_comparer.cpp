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

void PartDifference::add_sums(const PartDifference& other) {
    compared += other.compared;
    over += other.over;
    warned += other.warned;
    only_a += other.only_a;
    only_b += other.only_b;
    not_finite += other.not_finite;
    sum += other.sum;
    squares += other.squares;
}

bool PartDifference::add(const PartDifference& frame) {
    add_sums(frame);
    if (!frame.worst || (worst && frame.peak <= peak)) return false;
    peak = frame.peak;
    worst = frame.worst;
    return true;
}

}  // namespace fluidcarve
