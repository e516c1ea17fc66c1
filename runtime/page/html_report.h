#pragma once

#include "graph/pipeline.h"
#include "graph/views/origins.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture file that a node of the pipeline writes.
struct PagePicture {
    std::string node;
    std::string path;
    std::string png;       ///< its bytes
    std::string fault;     ///< why there are none: "is not there"
    bool earlier = false;  ///< it was there before this run, which did not look at it
};

/// What a page shows of the files that a pipeline writes.
struct WrittenFiles {
    std::vector<PagePicture> pictures;
    std::map<std::string, std::uint64_t> bytes;  ///< per node: of its files that are there
};

/// Looks at the files. Of a sequence of pictures the first is taken; a picture of many megabytes is not.
/// @param delivered  frames
/// @param report     of the run, as Report::to_json gives it
/// @param start      of the run: what was written before is an earlier run's, unless this one found it to be current
WrittenFiles written_files(const Pipeline& pipeline, const std::vector<int>& delivered, const nlohmann::ordered_json& report,
                           std::filesystem::file_time_type start);

/// What happened in a run as one HTML page that stands alone: no scripts, nothing that is loaded from elsewhere. For wide and narrow, light
/// and dark screens.
/// @param origins  of the pipeline's values
/// @param report   as Report::to_json gives it
/// @param when     the run was, for people
std::string to_html(const Pipeline& pipeline, const Registry& registry, const Origins& origins, const nlohmann::ordered_json& report, const WrittenFiles& files,
                    const std::string& when);

}  // namespace fluidcarve
