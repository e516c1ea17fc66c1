#pragma once

#include "tools/verbs/arguments.h"

#include <string>

namespace fluidcarve {

/// Arguments of the verb `view`.
struct ViewArguments {
    std::string path;    ///< of the page; empty: that of the pipeline's preview.page, or
                         ///< out/NAME.html for a pipeline NAME.yaml
    bool solve = false;  ///< find seams that are not in the work folder
    RunArguments run;

    void declare(CLI::App& verb);
};

/// The verb `view`: writes a page of a pipeline, and prints its path. Runs what the pipeline's
/// first preview.page needs; if it has none, one that shows what its preview.sheet or remap.grids
/// does. Without --solve, seams that no earlier run found are left out.
/// @return an exit code
int view_pipeline(const PipelineArguments& arguments, ViewArguments& view, Registry& registry);

/// The same document with a node `view` of type preview.page, or with the one that it has.
/// @param name  becomes the name of the node
/// @return what is wrong, if the pipeline has nothing to show; else empty
std::string add_page(Document& document, std::string& name);

/// Lets a node of type preview.page write another file.
void set_page_path(Document& document, const std::string& node, const std::string& path);

/// The file that a node of type preview.page writes.
std::string page_path(const Pipeline& pipeline, const std::string& node);

}  // namespace fluidcarve
