#include "graph/provenance.h"

#include "carve/base/find_or_null.h"
#include "graph/text/shell_word.h"
#include "graph/text/yaml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace fluidcarve {
namespace {

constexpr auto ascii = Letters::ascii;
/// Largest size of a text: an entry then fits into a segment of a JPEG file.
constexpr std::size_t most_bytes = 60'000;

std::string unless_long(const std::string& text) {
    return text.size() <= most_bytes ? text
                                     : fmt::format("{} bytes, too long to be stated", text.size());
}

/// A path as files may state it: an absolute path would reveal the machine.
std::string portable(const std::string& path) {
    return path.starts_with('/') ? std::filesystem::path(path).filename().string() : path;
}

/// Finds how a value depends on the command line and the environment.
class Outside {
public:
    explicit Outside(const Document& document) : document_(document) {
        for (const auto& [in, name] : document.insertions) inserted_[in].insert(name);
    }

    /// Whether a value, or a part of it, differs from what the files state; except params, which
    /// have values of their own.
    bool changed(const Value& value) const {
        if (param_at(value.mark)) return false;
        const auto in_file = [&](const Mark& file) { return file.source == value.mark.source; };
        if (std::ranges::none_of(document_.sources, in_file)) return true;
        for (const auto& name : names_in(value))
            if (!document_.params.find(name)) return true;
        return std::ranges::any_of(value.items, [&](const Value& item) { return changed(item); }) ||
               std::ranges::any_of(value.fields,
                                   [&](const Value::Field& field) { return changed(field.value); });
    }

    /// Adds the names of the params that a value is or holds.
    void add_params(const Value& value, std::set<std::string>& out) const {
        if (const auto* const param = param_at(value.mark)) out.insert(param->name);
        for (const auto& name : names_in(value))
            if (document_.params.find(name)) out.insert(name);
        for (const auto& item : value.items) add_params(item, out);
        for (const auto& field : value.fields) add_params(field.value, out);
    }

    /// Whether the value of a param is not as the files state it.
    bool changed_param(const Value::Field& param) const {
        const auto in_file = [&](const Mark& file) {
            return file.source == param.value.mark.source;
        };
        return std::ranges::none_of(document_.sources, in_file) || !names_in(param.value).empty();
    }

    /// The param that a value is as a whole, or null.
    const Value::Field* param_at(const Mark& mark) const {
        return find_or_null(
            document_.params.fields, mark,
            [](const Value::Field& param) -> const Mark& { return param.value.mark; });
    }

private:
    /// Names that were inserted into a text.
    std::set<std::string> names_in(const Value& value) const {
        const auto found = inserted_.find(value.mark);
        return found == inserted_.end() ? std::set<std::string>() : found->second;
    }

    const Document& document_;
    std::map<Mark, std::set<std::string>> inserted_;
};

/// Sets the provenance of one writer after the other.
class Stater {
public:
    Stater(Pipeline& pipeline, const Document& document, const Registry& registry)
        : pipeline_(pipeline), document_(document), registry_(registry), outside_(document) {
        for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) index_[pipeline.nodes[n].name] = n;
    }

    void state(std::size_t writer) {
        upstream_ = pipeline_.upstream_of({writer});
        settings_.clear();
        params_.clear();
        plugins_ = false;
        const auto values = values_text();
        auto& out = pipeline_.nodes[writer];
        out.provenance = {{"fluidcarve_version", FLUIDCARVE_VERSION},
                          {"fluidcarve_pipeline", yaml_scalar(portable(pipeline_.name), ascii)},
                          {"fluidcarve_values", unless_long(values)},
                          {"fluidcarve_command", unless_long(command())}};
        for (std::size_t n = 0; n < writer; ++n)
            for (std::size_t output = 0; upstream_[n] && output < pipeline_.nodes[n].outputs.size();
                 ++output)
                if (pipeline_.nodes[n].rate != Rate::frame &&
                    registry_.payload(pipeline_.nodes[n].outputs[output].type).checksum)
                    out.checksummed.push_back({n, output});
    }

private:
    /// The non-default values of all nodes upstream, as a pipeline's text.
    std::string values_text() {
        std::string nodes;
        note("frames", document_.frames);
        for (const auto& [name, mark, value] : document_.nodes.fields) {
            const auto& node = pipeline_.nodes[index_.at(name)];
            if (!upstream_[index_.at(name)]) continue;
            plugins_ =
                plugins_ || node.type->runs_code || pipeline_.plugins.contains(node.type->name);
            std::string fields = "type: " + yaml_scalar(node.type->name, ascii);
            for (const auto& field : value.fields)
                if (const auto text = field_text(node, field); !text.empty())
                    fields += ", " + field.name + ": " + text;
            nodes += fmt::format("{}{}: {{{}}}", nodes.empty() ? "" : ", ", name, fields);
        }
        return fmt::format("{{fluidcarve: 1, frames: {}, nodes: {{{}}}}}",
                           yaml_scalar(pipeline_.frames.text(), ascii), nodes);
    }

    /// The value of a field; empty if it does not count.
    std::string field_text(const Node& node, const Value::Field& field) {
        const auto* const param = node.type->param(field.name);
        if (!param && !node.type->input(field.name)) return {};
        if (param && (param->writes_file() || param->written)) return {};
        const auto target = node.name + "." + field.name;
        if (!param) return note(target, field.value), yaml_text(field.value, ascii);
        const auto text = param->text(node.params.get());
        if (param->reads_file())
            return note_path(target, field.value, text), yaml_scalar(portable(text), ascii);
        note(target, field.value);
        if (!param->required && text == param->fallback) return {};
        return field.value.kind == Value::Kind::scalar ? yaml_scalar(text, ascii)
                                                       : yaml_text(field.value, ascii);
    }

    /// Records the settings that the command needs to give a value again.
    void note(const std::string& target, const Value& value) {
        if (outside_.changed(value)) settings_.push_back(target + "=" + to_text(value));
        else outside_.add_params(value, params_);
    }

    void note_path(const std::string& target, const Value& value, const std::string& path) {
        const auto* const param = outside_.param_at(value.mark);
        const bool whole = param && outside_.changed_param(*param);
        std::set<std::string> held;
        outside_.add_params(value, held);
        const bool changed =
            outside_.changed(value) || std::ranges::any_of(held, [&](const std::string& name) {
                return outside_.changed_param(*document_.params.find(name));
            });
        if (portable(path) == path || !changed) return note(target, value);
        settings_.push_back((whole ? param->name : target) + "=" + portable(path));
    }

    std::string command() const {
        std::string out = "fluidcarve";
        for (const auto& word : document_.command) out += " " + shell_word(portable(word));
        if (document_.command.empty()) out += " run " + shell_word(portable(pipeline_.name));
        if (plugins_) out += " --allow-plugins";
        std::set<std::string> said;
        const auto put = [&](const std::string& setting) {
            if (said.insert(setting).second) out += " --set " + shell_word(setting);
        };
        for (const auto& param : document_.params.fields)
            if (params_.contains(param.name) && outside_.changed_param(param))
                put(param.name + "=" + portable(to_text(param.value)));
        for (const auto& setting : settings_) put(setting);
        return out;
    }

    static std::string to_text(const Value& value) {
        return value.kind == Value::Kind::scalar ? value.text : yaml_text(value);
    }

    Pipeline& pipeline_;
    const Document& document_;
    const Registry& registry_;
    const Outside outside_;
    std::map<std::string, std::size_t> index_;
    // For the present writer:
    std::vector<bool> upstream_;
    std::vector<std::string> settings_;  ///< what the command sets, except params
    std::set<std::string> params_;       ///< that its values hold
    bool plugins_ = false;
};

}  // namespace

void state_provenance(Pipeline& pipeline, const Document& document, const Registry& registry) {
    if (!pipeline.provenance) return;
    Stater stater(pipeline, document, registry);
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        if (pipeline.writes(n)) stater.state(n);
}

}  // namespace fluidcarve
