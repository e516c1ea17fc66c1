#pragma once

#include "graph/build_pipeline.h"
#include "graph/document.h"
#include "graph/pipeline.h"
#include "runtime/run/run.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

// Pipelines that are run within this process.

/// @throws std::runtime_error with all that is wrong with the file
inline fluidcarve::Document document_in(const std::string& file,
                                        const std::vector<std::string>& settings) {
    fluidcarve::Problems problems;
    auto out = fluidcarve::read_document(file, settings, problems);
    if (!problems.empty()) throw std::runtime_error(to_text(problems));
    return out;
}

/// @throws std::runtime_error with all that is wrong with the document
inline fluidcarve::Pipeline pipeline_of(const fluidcarve::Document& document,
                                        const fluidcarve::Registry& registry) {
    fluidcarve::Problems problems;
    auto out = fluidcarve::build_pipeline(document, registry, problems);
    if (!problems.empty()) throw std::runtime_error(to_text(problems));
    return out;
}

/// Two threads, three frames in flight, without cache, and nothing is told.
/// @param memory  bytes
inline fluidcarve::RunRequest quiet_request(std::uint64_t memory = std::uint64_t{1} << 32) {
    fluidcarve::RunRequest out;
    out.options.threads = 2;
    out.options.in_flight = 3;
    out.options.memory = memory;
    out.options.cache = false;
    out.quiet = true;
    return out;
}

/// @throws std::runtime_error if not all is done
inline void run_to_end(const fluidcarve::Pipeline& pipeline, const fluidcarve::Registry& registry,
                       const fluidcarve::RunRequest& request) {
    if (fluidcarve::run_pipeline(pipeline, registry, request, [] { return false; }) !=
        fluidcarve::exit_code::done)
        throw std::runtime_error(pipeline.name + " failed");
}
