#include "graph/types/context.h"

#include "carve/base/failure.h"

namespace fluidcarve {

Context::Context() {
    static Host nobody;
    static const std::vector<int> one{1};
    host_ = &nobody;
    frames_ = &one;
}

void Context::check_cancelled() const {
    if (cancelled()) throw Cancelled{};
}

}  // namespace fluidcarve
