#include "runtime/keep/dependencies.h"

#include <algorithm>
#include <iterator>

namespace fluidcarve {

std::vector<std::string> named_files(const Node& node, int frame) {
    std::vector<std::string> out;
    for (const auto& spec : node.type->params) {
        if (!spec.reads_file()) continue;
        const auto& path = spec.path(node.params.get());
        if (!path.text().empty()) out.push_back(path.at(frame));
    }
    if (node.traits.depends)
        std::ranges::move(node.traits.depends().files, std::back_inserter(out));
    return out;
}

Dependencies::OfNode Dependencies::of(std::size_t n) const {
    const auto& node = pipeline_.nodes[n];
    const auto& type = *node.type;
    OfNode out{type.name, type.version, std::nullopt, {}, {}};
    if (const auto plugin = pipeline_.plugins.find(type.name); plugin != pipeline_.plugins.end()) {
        const auto content = files_.content(plugin->second);
        out.plugin = content ? content->hash : Hash{};
    }
    for (const auto& param : type.params) {
        if (param.reads_file() || param.writes_file()) continue;
        const auto text = param.text(node.params.get());
        const bool grows = type.growth && type.growth->param == param.name,
                   either_way = type.growth && type.growth->best_effort == param.name;
        out.params.push_back(
            {param.name, text,
             either_way ? std::nullopt
                        : std::optional(grows ? type.growth->rest(node.params.get()) : text)});
    }
    if (node.traits.depends)
        if (const auto version = node.traits.depends().version; !version.empty())
            out.params.push_back({"VERSION", version, version});
    for (std::size_t i = 0; i < node.inputs.size(); ++i)
        for (std::size_t l = 0; l < node.inputs[i].size(); ++l) {
            const auto& link = node.inputs[i][l];
            out.inputs.push_back({type.inputs[i].name, node.input_names[i][l], link.node,
                                  taken_by(pipeline_, link)});
        }
    return out;
}

int Dependencies::read_frame(std::size_t n, std::size_t t) const {
    const int frame = frames().at(t);
    const auto of_node = stands_in_.find(n);
    if (of_node == stands_in_.end()) return frame;
    const auto other = of_node->second.find(frame);
    return other == of_node->second.end() ? frame : other->second;
}

std::vector<std::string> Dependencies::files(std::size_t n, std::size_t t) const {
    return named_files(pipeline_.nodes[n], read_frame(n, t));
}

std::vector<std::string> Dependencies::watched_files(std::size_t n, std::size_t t) const {
    auto out = files(n, t);
    if (read_frame(n, t) != frames().at(t))
        std::ranges::move(named_files(pipeline_.nodes[n], frames().at(t)), std::back_inserter(out));
    return out;
}

Hash Dependencies::contents(std::size_t n, std::size_t t) const {
    Hasher hash;
    for (const auto& path : files(n, t)) {
        const auto content = files_.content(path);
        hash.hash(content ? content->hash : Hash{});
    }
    return hash.digest();
}

}  // namespace fluidcarve
