#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "formats/file/full_path.h"
#include "formats/file/path_pattern.h"
#include "graph/file_claims.h"
#include "graph/pipeline_builder.h"

#include <fmt/format.h>

#include <optional>
#include <tuple>
#include <utility>

namespace fluidcarve {

namespace {

/// A path that a node states.
struct StatedPath {
    const Node* node;
    const ParamSpec* spec;
    PathPattern path;
    Mark mark;
};

std::vector<StatedPath> stated_paths(const std::vector<UnfinishedNode>& nodes, Shape::Kind kind) {
    std::vector<StatedPath> out;
    for (const auto& [node, value, references, unsure] : nodes)
        for (const auto& spec : node.type->params) {
            if (unsure || spec.shape.kind != kind) continue;
            const auto& path = spec.path(node.params.get());
            const auto* const field = value->find(spec.name);
            if (!path.text().empty())
                out.push_back({&node, &spec, path, field ? field->value.mark : node.mark});
        }
    return out;
}

/// The files that a pipeline claims.
struct AllClaims {
    std::vector<FileClaim> files;
    std::vector<std::pair<Mark, std::string>> who;  ///< per file

    void add(const StatedPath& stated, bool writes) {
        files.push_back({stated.path, writes});
        who.emplace_back(stated.mark, fmt::format("'{}' {} it here", stated.node->name,
                                                  writes ? "writes" : "reads"));
    }
};

/// The outputs of all nodes but one.
struct OtherOutputs {
    std::vector<std::string> all;
    bool found = false;  ///< one is the same, or may be
};

/// @param same  whether a path is that which is looked for
OtherOutputs outputs_beside(const std::vector<UnfinishedNode>& nodes, const UnfinishedNode& reader,
                            const auto& same) {
    OtherOutputs out;
    for (const auto& writer : nodes)
        for (const auto& spec : writer.node.type->params) {
            if (&writer == &reader || spec.shape.kind != Shape::Kind::output_path) continue;
            if (!writer.node.params) {
                out.found = true;
            } else if (const auto& path = spec.path(writer.node.params.get());
                       !path.text().empty()) {
                out.found = out.found || same(path);
                out.all.push_back(path.text());
            }
        }
    return out;
}

/// The first file that the program may not open, and why; empty: it may open all.
std::string refused(const PathPattern& files, const FrameSet& frames) {
    for (const auto frame : frames.frames()) {
        const auto file = files.at(frame);
        if (const auto refusal = Confinement::of_program().refusal(file); !refusal.empty())
            return file + " " + refusal;
        if (!files.per_frame()) break;
    }
    return {};
}

}  // namespace

void PipelineBuilder::check_paths(const FrameSet& frames) {
    const auto read = stated_paths(nodes_, Shape::Kind::input_path),
               written = stated_paths(nodes_, Shape::Kind::output_path);
    AllClaims claims;
    for (const auto& source : document_.sources) {
        claims.files.push_back({PathPattern::literal(source.source->name), false});
        claims.who.emplace_back(source, source.source->name == document_.name
                                            ? "this is the pipeline itself"
                                            : "the pipeline extends it");
    }
    for (const auto& each : read) claims.add(each, false);
    auto claim = claims.files.size();
    for (const auto& each : written) claims.add(each, true);
    const auto first = overwritten(claims.files, frames.frames());
    for (const auto& [node, spec, path, mark] : written) {
        if (node->rate == Rate::frame && !path.per_frame() &&
            (frames.frames().size() > 1 || sequences_.contains(node->name)))
            add(problems_, mark,
                fmt::format(
                    "{} writes a file for every frame: '{}' needs a frame token such as ####",
                    node->type->name, spec->name));
        if (node->rate != Rate::frame && path.per_frame() && !blame_reader(*node, mark, frames))
            add(problems_, mark,
                fmt::format(
                    "{} writes one file here, not one per frame: '{}' can't have a frame token",
                    node->type->name, spec->name));
        if (const auto other = first[claim++])
            add(problems_, mark,
                fmt::format("'{}' would overwrite a file of the same pipeline", node->name),
                claims.who[*other].first, claims.who[*other].second);
    }
}

bool PipelineBuilder::blame_reader(const Node& writer, const Mark& mark, const FrameSet& frames) {
    if (writer.rate != Rate::fixed || frames.frames().size() < 2) return false;
    std::set<std::size_t> seen;
    std::vector<std::size_t> open;
    const auto take = [&](const Node& node) {
        for (const auto& link : node.links())
            if (seen.insert(link.node).second) open.push_back(link.node);
    };
    for (take(writer); !open.empty();) {
        const auto& node = nodes_[open.back()].node;
        open.pop_back();
        take(node);
    }
    // Of several readers, the one whose file has a number in its name.
    std::optional<std::tuple<std::size_t, const ParamSpec*, std::string>> found;
    for (const auto n : seen)
        for (const auto& spec : nodes_[n].node.type->params) {
            if (!spec.reads_file()) continue;
            const auto& text = spec.path(nodes_[n].node.params.get()).text();
            const auto numbered = text.empty() ? text : with_frame_token(text);
            if (!text.empty() && (!found || (std::get<2>(*found).empty() && !numbered.empty())))
                found = {n, &spec, numbered};
        }
    if (!found) return false;
    const auto& [n, spec, numbered] = *found;
    const auto& reader = nodes_[n];
    const auto* const field = reader.value->find(spec->name);
    add(problems_, field ? field->value.mark : reader.node.mark,
        fmt::format("{} reads one file for all {} frames, but '{}' writes one for each: '{}' "
                    "needs a frame token, {}; or take the token from '{}'",
                    reader.node.type->name, frames.frames().size(), writer.name, spec->name,
                    numbered.empty() ? "such as ####" : fmt::format("as in '{}'", numbered),
                    writer.name),
        mark, fmt::format("'{}' writes a file per frame here", writer.name));
    return true;
}

void PipelineBuilder::check_written(const FrameSet& frames) {
    // Patterns of two kinds may name the same files.
    const auto files_of = [&](const PathPattern& path) {
        const auto file = [&](int frame) { return full_path(path.at(frame)); };
        return std::pair(file(frames.frames().front()), file(frames.frames().back()));
    };
    const auto require_writer = [&](const UnfinishedNode& reader, const ParamSpec& spec,
                                    const std::string& name, const PathPattern& path) {
        const auto others = outputs_beside(nodes_, reader, [&](const PathPattern& output) {
            return files_of(output) == files_of(path);
        });
        // What nodes with faults write is not known.
        if (others.found || nodes_.size() < known_.size()) return;
        add(problems_, reader.value->find(spec.name)->value.find(name)->value.mark,
            fmt::format("{} parameter '{}': no other node writes {}{}", reader.node.type->name,
                        spec.name, path.text(),
                        others.all.empty() ? "" : did_you_mean(path.text(), others.all)));
    };
    for (const auto& reader : nodes_)
        for (const auto& spec : reader.node.type->params) {
            if (!spec.written || !reader.node.params) continue;
            for (const auto& [name, path] : spec.written(reader.node.params.get()))
                require_writer(reader, spec, name, path);
        }
}

void PipelineBuilder::check_confinement(const FrameSet& frames) {
    if (!Confinement::of_program().on()) return;
    for (const auto& [node, value, references, unsure] : nodes_)
        for (const auto& spec : node.type->params) {
            const bool path = spec.reads_file() || spec.writes_file();
            const auto* const field = value->find(spec.name);
            if (!path || !field || !node.params) continue;
            if (const auto fault = refused(spec.path(node.params.get()), frames); !fault.empty())
                add(problems_, field->value.mark,
                    fmt::format("{} parameter '{}': {}", node.type->name, spec.name, fault));
        }
}

}  // namespace fluidcarve
