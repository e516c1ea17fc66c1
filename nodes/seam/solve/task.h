#pragma once

#include "nodes/seam/solve/params.h"
#include "nodes/seam/solve/space.h"
#include "nodes/seams/window.h"

#include <array>
#include <optional>
#include <string>

namespace fluidcarve {

/// What a solver is to find, as far as it is known before the energy is.
struct SeamTask {
    /// The seams of one window.
    struct Part {
        bool pair = false;  ///< whether the window is `pair_window`
        Seams::Kind kind = Seams::Kind::remove;
        Window window;
        bool static_ = false;
        std::string prefix() const { return pair ? "pair_" : ""; }  ///< of the names of its parameters, and of what is reported of it
    };
    Axis axis = Axis::u;
    std::array<int, 3> shape{};  ///< I, J, K of the space
    int count = 0;               ///< of seams in each part
    Part seams;
    std::optional<Part> pairs;
};

/// The task that parameters set in a space.
/// @throws Failure if the space is empty, if a window or the anchor leaves it, or if a window has too little room
SeamTask task_of(const SolverParams& params, const CarvedSpace& space);

/// The set of a task that has no seams yet.
Seams empty_seams(const SolverParams& params, const SeamTask& task, const CarvedSpace& space);

}  // namespace fluidcarve
