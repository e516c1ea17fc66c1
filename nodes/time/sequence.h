#pragma once

#include "graph/types/context.h"
#include "nodes/time/motion.h"
#include "nodes/time/volume_store.h"

#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A frame of a sequence, with the velocity that goes with it.
struct SequenceFrame {
    Volume volume;
    Ref<VectorGrid> velocity;  ///< null: none
};

/// All frames of a sequence, to be read in any order.
class Sequence {
public:
    /// Adds the context's frame.
    /// @param velocity  may be null, then in all frames
    void add(const Volume& source, const Ref<VectorGrid>& velocity, const Context& context);

    const std::vector<int>& numbers() const { return numbers_; }  ///< of the frames, rising
    std::size_t size() const { return numbers_.size(); }
    bool has_velocity() const { return has_velocity_; }
    /// May be called from many threads at once.
    SequenceFrame at(std::size_t place) const;

private:
    std::optional<VolumeStore> store_;
    std::vector<int> numbers_;
    bool has_velocity_ = false;
};

/// The grid that shows most in two frames: a density or a level set, else the float grid with the most active voxels. Nothing if there is none.
std::optional<std::pair<MovingFrame, MovingFrame>> shown_in(const SequenceFrame& a, const SequenceFrame& b);

}  // namespace fluidcarve
