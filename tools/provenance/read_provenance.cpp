#include "tools/provenance/read_provenance.h"

#include "carve/base/words.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/image/image_provenance.h"
#include "formats/vdb/provenance_metadata.h"
#include "formats/vdb/vdb_file.h"

#include <fmt/format.h>

#include <string_view>

namespace fluidcarve {

Provenance read_provenance(const std::string& path) {
    using namespace std::string_view_literals;
    const InputFile file(path, {.what = "a file to explain"});
    const auto start = file.head(8);
    const auto begins = [&](std::string_view text) { return start.starts_with(text); };
    if (begins(" BDV"sv)) return provenance_in(read_vdb_header(path).metadata);
    if (begins("ply\n") || begins("ply\r") || begins("#usda") || ending_of(path) == ".obj")
        return provenance_of_comments(file);
    if (!begins("\x89PNG") && !begins("\xff\xd8\xff") && !begins("\x76\x2f\x31\x01"))
        throw Failure(fmt::format("{} is no file that states what made it; those are VDB, PNG, "
                                  "JPEG, EXR, PLY, OBJ and USDA files",
                                  path),
                      Failure::Kind::input);
    return provenance_of_image(file);
}

}  // namespace fluidcarve
