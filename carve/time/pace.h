#pragma once

#include "carve/base/values.h"

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The wanted map from frames of a retimed sequence to moments of its source. One of `speed`,
/// `count` and `curve` is stated.
struct PaceRequest {
    Auto<double> speed;  ///< frames of the source per frame; below 0: backwards
    Auto<int> count;     ///< number of frames that show the whole source
    /// [frame, frame of the source], rising in the first; linear between.
    std::vector<std::vector<double>> curve;
    Auto<int> start;  ///< number of the first frame; auto: that of the source
};

/// A moment between two frames of a sequence.
struct Moment {
    std::size_t place = 0;  ///< index of the frame before
    /// Position between that frame and the next, from 0 up to 1; 0: the frame itself.
    double share = 0;
    /// Frames of the source that pass from frame to frame here; below 0: backwards.
    double rate = 1;
};

class Pace {
public:
    /// @param source  frame numbers, rising, at least one
    /// @throws Failure if nothing is stated, if the curve leads beyond the source, or as
    ///   even_frames()
    Pace(const PaceRequest& request, std::vector<int> source);

    /// Frame numbers of the retimed sequence.
    const std::vector<int>& frames() const { return frames_; }
    /// @param frame  one of frames()
    Moment moment(int frame) const;

private:
    /// A point of the pace: `at` shows the source's frame `shows`, both as frame numbers.
    struct Point {
        double at = 0, shows = 0;
    };

    std::vector<int> source_;
    std::vector<Point> points_;  ///< linear between; one or more
    std::vector<int> frames_;
};

}  // namespace fluidcarve
