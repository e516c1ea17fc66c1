#pragma once

namespace fluidcarve {

/// A range of entries along the carved axis that a seam may take, both ends included.
struct Window {
    int first = 0;
    int last = 0;
    int size() const { return last - first + 1; }
};

}  // namespace fluidcarve
