#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

namespace fluidcarve {

/// The loop that is wanted.
struct LoopRequest {
    std::size_t least = 2, most = 2;  ///< lengths, frames
    std::optional<std::size_t> fade;  ///< frames; nothing: a quarter of the length
};

/// A part of a sequence as a loop. Its last frames fade into those a length before them.
struct Loop {
    std::size_t first = 0, length = 1, fade = 0;  ///< first: index of a frame
    /// Mean difference of the frames that fade into each other.
    double difference = std::numeric_limits<double>::max();

    /// What a frame of the loop shows.
    struct Shown {
        std::size_t at = 0;               ///< index of the frame
        std::size_t before = 0;           ///< index of the frame into which it fades
        std::optional<std::size_t> fade;  ///< index in the fade; nothing: it shows `at` alone
        double share = 0;                 ///< of `before`

        /// Index of the frame with the larger share.
        std::size_t nearer() const { return share < 0.5 ? at : before; }
    };
    /// @param n  place in the loop, from 0; counted modulo the length
    Shown shown(std::size_t n) const;
};

/// Index of the frame that lies a loop before another; the first if there is none.
std::size_t frame_before(std::size_t at, std::size_t length);

/// The loop that closes best, among all wanted lengths and all first frames.
/// @param frames      of the sequence, at least `most`
/// @param difference  of two frames by their index
Loop best_loop(const LoopRequest& request, std::size_t frames,
               const std::function<double(std::size_t, std::size_t)>& difference);

}  // namespace fluidcarve
