#pragma once

#include "formats/file/content_hash.h"

namespace fluidcarve::test {

/// A key of its own for each number.
inline Hash key_of(int number) {
    return Hasher().number(static_cast<std::uint64_t>(number)).digest();
}

}  // namespace fluidcarve::test
