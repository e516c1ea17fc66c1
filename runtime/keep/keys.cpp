#include "runtime/keep/keys.h"

#include <algorithm>

namespace fluidcarve {
namespace {

/// Raise it whenever the computation of keys changes.
constexpr std::uint64_t key_version = 1;

bool among(const std::vector<std::string>* fields, const std::string& name) {
    return !fields || std::find(fields->begin(), fields->end(), name) != fields->end();
}

}  // namespace

bool counts(const ParamSpec& param) { return param.shape.kind != Shape::Kind::input_path && param.shape.kind != Shape::Kind::output_path; }

Keys::Keys(const Pipeline& pipeline, const std::vector<int>& frames, const std::map<std::size_t, std::map<int, int>>& stands_in, FileHashes& files,
           std::function<bool(std::size_t node, std::size_t place)> wants)
    : pipeline_(pipeline), frames_(frames), stands_in_(stands_in), files_(files), wants_(std::move(wants)) {
    reset();
}

void Keys::reset() {
    const auto nodes = pipeline_.nodes.size();
    kept_.assign(nodes, {});
    taken_.assign(nodes, {});
    gathered_.assign(nodes, std::nullopt);
    for (std::size_t n = 0; n < nodes; ++n) {
        kept_[n].resize(pipeline_.nodes[n].rate == Rate::frame ? frames_.size() : 1);
        taken_[n].resize(frames_.size());
    }
}

std::vector<std::string> Keys::files(std::size_t n, std::size_t place) const {
    const auto& node = pipeline_.nodes[n];
    int frame = frames_.at(place);
    if (const auto of_node = stands_in_.find(n); of_node != stands_in_.end())
        if (const auto other = of_node->second.find(frame); other != of_node->second.end()) frame = other->second;
    std::vector<std::string> out;
    for (const auto& spec : node.type->params) {
        if (spec.shape.kind != Shape::Kind::input_path) continue;
        const auto& path = spec.path(node.params.get());
        if (!path.text().empty()) out.push_back(path.at(frame));
    }
    return out;
}

Key Keys::contents(std::size_t n, std::size_t place) {
    ContentHash hash;
    for (const auto& path : files(n, place)) {
        const auto content = files_.of(path);
        hash.key(content ? content->key : Key{});
    }
    return hash.digest();
}

std::optional<Key> Keys::plugin(std::size_t n) const {
    const auto found = pipeline_.plugins.find(pipeline_.nodes[n].type->name);
    if (found == pipeline_.plugins.end()) return std::nullopt;
    const auto content = files_.of(found->second);
    return content ? content->key : Key{};
}

void Keys::describe(ContentHash& hash, std::size_t n, const std::vector<std::string>* fields) const {
    const auto& node = pipeline_.nodes[n];
    const auto& type = *node.type;
    hash.number(key_version).text(type.name).number(static_cast<std::uint64_t>(type.version));
    // The author of a plugin may have forgotten to raise the version.
    if (const auto content = plugin(n)) hash.key(*content);
    for (const auto& param : type.params) {
        if (!counts(param) || !among(fields, param.name)) continue;
        const bool grows = type.growth && type.growth->param == param.name;
        hash.text(param.name).text(grows ? type.growth->rest(node.params.get()) : param.text(node.params.get()));
    }
}

void Keys::add_inputs(ContentHash& hash, std::size_t n, std::size_t place, const std::vector<std::string>* fields, std::optional<bool> per_frame) {
    const auto& node = pipeline_.nodes[n];
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
        const auto& spec = node.type->inputs[i];
        if (!among(fields, spec.name)) continue;
        for (std::size_t l = 0; l < node.inputs[i].size(); ++l) {
            const auto& link = node.inputs[i][l];
            const auto& source = pipeline_.nodes[link.node];
            if (per_frame && *per_frame != (source.rate == Rate::frame)) continue;
            hash.text(spec.name).text(node.input_names[i][l]).text(source.outputs[link.output].name).key(result(link.node, place));
        }
    }
}

Key Keys::taken(std::size_t n, std::size_t place) {
    const std::lock_guard lock(mutex_);
    auto& known = taken_[n][place];
    if (known) return *known;
    const auto& type = *pipeline_.nodes[n].type;
    const bool digests = type.digest != typeid(void);
    ContentHash hash;
    if (digests) describe(hash.text("digest"), n, &type.digest_fields);
    hash.number(static_cast<std::uint64_t>(frames_[place]));
    add_inputs(hash, n, place, digests ? &type.digest_fields : nullptr, digests ? std::nullopt : std::optional(true));
    known = hash.digest();
    return *known;
}

Key Keys::gathered(std::size_t n) {
    const std::lock_guard lock(mutex_);
    auto& known = gathered_[n];
    if (known) return *known;
    ContentHash hash;
    describe(hash.text("gathered"), n, nullptr);
    for (const auto frame : frames_) hash.number(static_cast<std::uint64_t>(frame));
    for (std::size_t place = 0; place < frames_.size(); ++place)
        if (wants_(n, place)) hash.key(taken(n, place));
    add_inputs(hash, n, 0, nullptr, false);
    hash.key(contents(n, 0));
    known = hash.digest();
    return *known;
}

Key Keys::kept(std::size_t n, std::size_t place) {
    const std::lock_guard lock(mutex_);
    const auto& node = pipeline_.nodes[n];
    if (node.rate != Rate::frame) place = 0;
    auto& known = kept_[n][place];
    if (known) return *known;
    if (node.rate != Rate::frame && pipeline_.nodes[n].streams_in()) {
        known = gathered(n);
        return *known;
    }
    ContentHash hash;
    describe(hash.text("result"), n, nullptr);
    // A body that runs once sees the first frame of the sequence.
    hash.number(static_cast<std::uint64_t>(frames_.at(place)));
    if (pipeline_.nodes[n].streams_in()) hash.key(gathered(n));
    else if (node.gathers)
        for (const auto frame : frames_) hash.number(static_cast<std::uint64_t>(frame));
    add_inputs(hash, n, place, nullptr, std::nullopt);
    hash.key(contents(n, place));
    known = hash.digest();
    return *known;
}

Key Keys::result(std::size_t n, std::size_t place) {
    const auto& node = pipeline_.nodes[n];
    const auto key = kept(n, place);
    if (!node.type->growth) return key;
    ContentHash hash;
    hash.key(key).text(node.type->param(node.type->growth->param)->text(node.params.get()));
    return hash.digest();
}

}  // namespace fluidcarve
