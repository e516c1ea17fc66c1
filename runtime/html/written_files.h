#pragma once

#include "graph/pipeline.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// A PNG file that a node of the pipeline writes.
struct PagePicture {
    std::string node;
    std::string path;
    std::string png;       ///< the file's bytes
    std::string fault;     ///< why the page can't show it: "is not there"; empty: it can
    bool earlier = false;  ///< written by an earlier run, and not checked by this one
};

/// A page that a node of the pipeline writes: an HTML file to open beside the report.
struct PageLink {
    std::string node;
    std::string path;
    std::string address;  ///< from the report page
};

/// The files of a pipeline's writers, for the report page.
struct WrittenFiles {
    std::vector<PagePicture> pictures;
    std::vector<PageLink> pages;                 ///< existing ones
    std::map<std::string, std::uint64_t> bytes;  ///< node name to the bytes of its existing files
};

/// Looks at the files of all writers. Of a sequence of pictures only the first is shown, and no
/// picture above 24 MiB.
/// @param delivered  frame numbers
/// @param report     the run's report, as returned by Report::to_json
/// @param start      start of the run. Older files count as written by an earlier run, unless this
///   run found them up to date
/// @param page       the report page
WrittenFiles written_files(const Pipeline& pipeline, const std::vector<int>& delivered,
                           const nlohmann::ordered_json& report,
                           std::filesystem::file_time_type start,
                           const std::filesystem::path& page);

}  // namespace fluidcarve
