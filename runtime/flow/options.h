#pragma once

#include "carve/base/limits.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace fluidcarve {

/// Limits and options of one run.
struct RunOptions {
    int threads = 1;
    int in_flight = 2;         ///< maximum number of frames in memory at once
    std::uint64_t memory = 0;  ///< bytes that each node may hold in memory for the whole sequence
    std::string work_folder = Limits{}.folder;
    bool keep_going = false;  ///< run the other frames after a failure
    bool cache = true;        ///< read and write cached results in the work folder
    bool sync = false;        ///< wait until each written file is on the disk
    /// Bytes of cached results that remain after a run.
    std::uint64_t cache_size = std::uint64_t{50} * 1024 * 1024 * 1024;

    /// Number of bodies that can work at once.
    /// @param calls  of a body that is called per frame; nothing: its loops use all threads
    double abreast(std::optional<std::size_t> calls) const;
};

}  // namespace fluidcarve
