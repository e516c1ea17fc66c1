#include "tools/wedge/joined_page.h"

#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "nodes/page/page_html.h"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <utility>

namespace fluidcarve {

void write_joined_page(const std::string& title, const std::vector<PagePart>& parts,
                       const std::string& path) {
    std::vector<nlohmann::ordered_json> scenes;
    for (const auto& part : parts) {
        const auto page = InputFile(part.path, {.what = "a page"}).whole();
        try {
            for (auto& scene : scenes_of_page(page)) {
                scene["differs"] = part.differs;
                scenes.push_back(std::move(scene));
            }
        } catch (const Failure& failure) {
            throw Failure(fmt::format("{}: {}", part.path, failure.what()));
        }
    }
    const auto page = small_page(title, scenes).html;
    require_page_size(page,
                      fmt::format("name fewer values; there are {} combinations", parts.size()));
    OutputFile::write(path, page);
}

}  // namespace fluidcarve
