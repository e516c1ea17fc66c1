#pragma once

#include "carve/seam/seams.h"
#include "graph/types/payload.h"

#include <nlohmann/json.hpp>

#include <cstddef>

namespace fluidcarve {

/// A seam set with its report.
struct ReportedSeams {  // NOLINT(bugprone-exception-escape): JSON moves without exceptions
    Ref<Seams> seams;   ///< null: none
    nlohmann::ordered_json report;

    /// The first `count` seams and pairs, as if no more had been asked for.
    ReportedSeams first(std::size_t count) const;
};

}  // namespace fluidcarve
