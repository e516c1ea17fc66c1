#pragma once

#include <unistd.h>

namespace fluidcarve {

/// An open file of the system, closed at the end of its scope.
struct Descriptor {
    int number;  ///< below 0: it could not be opened
    ~Descriptor() {
        if (number >= 0) close(number);
    }
};

}  // namespace fluidcarve
