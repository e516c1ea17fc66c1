#pragma once

#include "carve/base/failure.h"

#include <string>

namespace fluidcarve::test {

/// The message of the Failure that a call throws; empty if it throws none.
template <class Call>
std::string failure_of(const Call& call) {
    try {
        call();
    } catch (const Failure& failure) {
        return failure.what();
    }
    return {};
}

}  // namespace fluidcarve::test
