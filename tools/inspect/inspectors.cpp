#include "tools/inspect/inspectors.h"

#include "carve/base/words.h"
#include "tools/inspect/geometry.h"
#include "tools/inspect/image.h"
#include "tools/inspect/volume.h"

#include <algorithm>

namespace fluidcarve {

const std::vector<FileInspector>& inspectors() {
    static const std::vector<FileInspector> all{vdb_inspector(), geometry_inspector(),
                                                image_inspector()};
    return all;
}

const FileInspector* inspector_of(const std::string& path) {
    const auto ending = ending_of(path);
    const auto found = std::ranges::find_if(inspectors(), [&](const FileInspector& each) {
        return std::ranges::find(each.endings, ending) != each.endings.end();
    });
    return found == inspectors().end() ? nullptr : &*found;
}

}  // namespace fluidcarve
