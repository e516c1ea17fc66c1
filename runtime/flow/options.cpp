#include "runtime/flow/options.h"

#include <algorithm>
#include <thread>

namespace fluidcarve {

double RunOptions::abreast(std::optional<std::size_t> calls) const {
    const auto cores = std::min(static_cast<std::size_t>(threads),
                                std::max<std::size_t>(1, std::thread::hardware_concurrency()));
    return static_cast<double>(
        calls ? std::max<std::size_t>(
                    1, std::min({cores, static_cast<std::size_t>(in_flight), *calls}))
              : cores);
}

}  // namespace fluidcarve
