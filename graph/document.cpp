#include "graph/document.h"

#include "graph/input_file.h"
#include "graph/text/words.h"
#include "graph/text/yaml_reader.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_extends = 16;

std::vector<std::string> names(const Value& map) {
    std::vector<std::string> out;
    for (const auto& field : map.fields) out.push_back(field.name);
    return out;
}

/// Merges `later` into `earlier`, down to `levels` nested maps. A null field in `later` removes the field from `earlier`. Names are unique in each.
void merge(Value& earlier, const Value& later, int levels) {
    if (levels == 0 || earlier.kind != Value::Kind::map || later.kind != Value::Kind::map) {
        earlier = later;
        return;
    }
    std::map<std::string, std::size_t> places;
    for (const auto& field : earlier.fields) places.emplace(field.name, places.size());
    std::set<std::string> removed;
    for (const auto& field : later.fields) {
        const auto found = places.find(field.name);
        if (found == places.end()) {
            earlier.fields.push_back(field);
        } else if (field.value.kind == Value::Kind::null) {
            removed.insert(field.name);
        } else {
            earlier.fields[found->second].mark = field.mark;
            merge(earlier.fields[found->second].value, field.value, levels - 1);
        }
    }
    std::erase_if(earlier.fields, [&](const Value::Field& each) { return removed.contains(each.name); });
    earlier.mark = later.mark;
}

/// Prepends the items of the list in `earlier` to the same list in `later`.
void put_before(Value& later, const Value& earlier, const char* list) {
    auto* const now = later.find(list);
    const auto* const before = earlier.find(list);
    if (now && before && now->value.kind == Value::Kind::list)
        now->value.items.insert(now->value.items.begin(), before->value.items.begin(), before->value.items.end());
}

/// Reads a pipeline file and the files that it extends.
class Reader {
public:
    Reader(Problems& problems, TextRoom& room) : problems_(problems), room_(room) {}

    /// Reads a file and merges it over the files that it extends. Returns a map even if the file can't be read.
    Value load(const std::string& path, const Mark& from) {
        Value nothing;
        nothing.kind = Value::Kind::map;
        const auto file = fs::weakly_canonical(path).string();
        if (std::find(loading_.begin(), loading_.end(), file) != loading_.end())
            return add(problems_, from, fmt::format("{} extends itself, directly or through others", path)), nothing;
        if (loading_.size() >= most_extends) return add(problems_, from, fmt::format("more than {} files extend each other", most_extends)), nothing;

        const auto source = open(path, from);
        if (!source) return nothing;
        loading_.push_back(file);
        Value out = load(source, from);
        loading_.pop_back();
        return out;
    }

    /// Reads a text and merges it over the files that it extends. Returns a map even if it is no pipeline.
    Value load(const std::shared_ptr<const Source>& source, const Mark& from) {
        Value nothing;
        nothing.kind = Value::Kind::map;
        const auto before = problems_.size();
        Value root = read_yaml(source, problems_, room_);
        if (from.source && !is_pipeline(root)) return refuse_unshown(*source, from, before, root.kind), nothing;
        nothing.mark = {source, 0, 0};
        sources.push_back(nothing.mark);
        if (problems_.size() > before && root.kind == Value::Kind::null) return nothing;
        if (root.kind == Value::Kind::null)
            return add(problems_, {source, 0, 0}, "the file is empty: a pipeline starts with 'fluidcarve: 1' and has 'nodes:'"), nothing;
        if (root.kind != Value::Kind::map)
            return add(problems_, root.mark, "a pipeline is a map with 'fluidcarve: 1' and 'nodes:', not " + root.describe()), nothing;
        root.mark = {source, 0, 0};
        check_top(root);

        const auto* const extends = root.find("extends");
        if (!extends) return root;
        if (extends->value.kind != Value::Kind::scalar)
            return add(problems_, extends->value.mark, "'extends' must be the path of a pipeline file, not " + extends->value.describe()), root;
        auto base_path = fs::path(extends->value.text);
        if (base_path.is_relative()) base_path = fs::path(source->folder) / base_path;
        Value merged = load(base_path.lexically_normal().string(), extends->value.mark);
        put_before(root, merged, "plugins");
        merge(merged, root, 3);
        return merged;
    }

    std::vector<Mark> sources;  ///< the files read so far

private:
    /// Whether an extended file is a pipeline: it says so, or it extends another and has only a pipeline's fields.
    static bool is_pipeline(const Value& root) {
        if (const auto* const version = root.find("fluidcarve")) return version->value.text == "1";
        return root.find("extends") &&
               std::ranges::all_of(root.fields, [](const Value::Field& field) { return find_field(top_fields, field.name) != nullptr; });
    }

    /// Refuses an extended file without showing any of its text: whoever wrote the pipeline may name files that only its reader may read.
    /// @param from    where the file is extended
    /// @param before  number of problems before the file was read
    /// @param kind    what was read
    void refuse_unshown(const Source& file, const Mark& from, std::size_t before, Value::Kind kind) {
        Mark at{std::make_shared<Source>(Source{file.name, {}, file.folder}), 0, 0};
        std::string fault = "it does not state 'fluidcarve: 1'";
        if (kind == Value::Kind::null && problems_.size() > before) {
            const auto& first = problems_[before];
            at.line = first.at.line;
            at.column = first.at.column;
            // Problems of a file as a whole quote nothing.
            fault = room_.full() ? TextRoom::fault() : at.line > 0 ? "it does not parse here" : first.message;
        }
        problems_.resize(before);
        add(problems_, at, "no pipeline: " + fault, from, "it is extended here");
    }

    std::shared_ptr<const Source> open(const std::string& path, const Mark& from) {
        auto source = std::make_shared<Source>();
        source->name = path;
        source->folder = fs::path(path).parent_path().string();
        try {
            // One byte more than read_yaml accepts: it then reports that the file is too large.
            source->text = InputFile(path, {.what = "a pipeline", .anywhere = !from.source}).head(most_yaml_bytes + 1);
        } catch (const Unreadable& unreadable) {
            add(problems_, from, fmt::format("cannot read {}: it {}", path, unreadable.fault));
            return nullptr;
        }
        return source;
    }

    void check_top(const Value& root) {
        for (const auto& field : root.fields)
            if (!find_field(top_fields, field.name))
                add(problems_, field.mark, fmt::format("a pipeline has no field '{}'{}", field.name, did_you_mean(field.name, names_of(top_fields))));
        const auto* const version = root.find("fluidcarve");
        // One that extends another may leave the version to that.
        if (!version && !root.find("extends")) add(problems_, root.mark, "the format version is missing: the file must state 'fluidcarve: 1'");
        if (version && (version->value.kind != Value::Kind::scalar || version->value.text != "1"))
            add(problems_, version->value.mark, fmt::format("format version {} is unknown; this program reads version 1", version->value.describe()));
        for (const auto* name : {"params", "nodes"})
            if (const auto* field = root.find(name); field && field->value.kind != Value::Kind::map)
                add(problems_, field->value.mark, fmt::format("'{}' must be a map, not {}", name, field->value.describe()));
        const auto* const plugins = root.find("plugins");
        if (!plugins || plugins->value.kind == Value::Kind::null) return;
        if (plugins->value.kind != Value::Kind::list)
            return add(problems_, plugins->value.mark, "'plugins' must be a list of files, not " + plugins->value.describe());
        for (const auto& file : plugins->value.items)
            if (file.kind != Value::Kind::scalar) add(problems_, file.mark, "'plugins' must list the paths of files, not " + file.describe());
    }

    Problems& problems_;
    TextRoom& room_;
    std::vector<std::string> loading_;
};

/// Holds the values of params and environment variables, and replaces `${name}` by them.
class Names {
public:
    /// @param open  whether params may have no value
    Names(Problems& problems, TextRoom& room, bool open) : problems_(problems), room_(room), open_(open) {}

    void declare_environment(const Value& list) {
        if (list.kind == Value::Kind::null) return;
        if (list.kind != Value::Kind::list) return add(problems_, list.mark, "'env' must be a list of environment variables, not " + list.describe());
        for (const auto& item : list.items)
            if (item.kind == Value::Kind::scalar) environment_.emplace(item.text, item.mark);
            else add(problems_, item.mark, "'env' must list names, not " + item.describe());
    }

    /// The declared variables that are set.
    std::vector<std::pair<std::string, std::string>> environment() const {
        std::vector<std::pair<std::string, std::string>> out;
        for (const auto& [name, mark] : environment_)
            if (const auto* const value = std::getenv(name.c_str())) out.emplace_back(name, value);
        return out;
    }

    /// @return map: param name to value
    Value declare_params(const Value& params, const std::map<std::string, Value>& settings) {
        Value out;
        out.kind = Value::Kind::map;
        out.mark = params.mark;
        for (const auto& field : params.fields) {
            declare_param(field, settings);
            out.fields.push_back({field.name, field.mark, values_[field.name]});
        }
        return out;
    }

    /// Replaces every `${name}` in a value and its parts.
    void replace(Value& value) { replace(value, values_, {}); }

    std::vector<Insertion> insertions;  ///< all replacements so far

private:
    void replace(Value& value, const std::map<std::string, Value>& params, const Mark& in) {
        const auto mark = value.mark;
        if (value.kind == Value::Kind::scalar) return replace_scalar(value, params, in);
        for (auto& item : value.items) replace(item, params, mark);
        for (auto& field : value.fields) replace(field.value, params, mark);
    }

    void declare_param(const Value::Field& field, const std::map<std::string, Value>& settings) {
        const auto& [name, mark, param] = field;
        values_[name].kind = Value::Kind::unresolved;  // declared, even if the declaration has faults
        if (param.kind != Value::Kind::map)
            return add(problems_, param.mark, fmt::format("param '{}' must be {{type: ..., default: ..., doc: ...}}, not {}", name, param.describe()));
        for (const auto& each : param.fields)
            if (!find_field(param_fields, each.name))
                add(problems_, each.mark, fmt::format("a param has no field '{}'{}", each.name, did_you_mean(each.name, names_of(param_fields))));
        const auto* const type = param.find("type");
        if (!type) return add(problems_, mark, fmt::format("param '{}' needs a type: {}", name, either(names_of(param_types()))));

        Range range;
        for (const auto& [bound, into] : {std::pair{"min", &range.min}, std::pair{"max", &range.max}})
            if (const auto* stated = param.find(bound)) {
                ValueReader reader(problems_, fmt::format("param '{}' field '{}'", name, bound), any_number());
                *into = reader.number(stated->value, false).value_or(*into);
            }

        const Value* value = nullptr;
        Value from_environment;
        if (const auto* fallback = param.find("default")) value = &fallback->value;
        if (environment_.contains(name) && std::getenv(name.c_str())) value = &(from_environment = environment_value(name));
        if (const auto set = settings.find(name); set != settings.end()) value = &set->second;
        if (!value || value->kind == Value::Kind::null) {
            if (!open_) add(problems_, mark, fmt::format("param '{0}' has no value; give it a default or --set {0}=...", name));
            return;
        }

        Value replaced = *value;
        // A default may use environment variables but not other params, so the order of params does not matter.
        if (value != &from_environment) replace(replaced, {}, {});
        if (fits(*type, replaced, name, range)) values_[name] = std::move(replaced);
    }

    bool fits(const Value::Field& type, const Value& value, const std::string& name, Range range) {
        ValueReader reader(problems_, fmt::format("param '{}'", name), range);
        for (const auto& known : param_types())
            if (type.value.kind == Value::Kind::scalar && type.value.text == known.name) return known.takes(value, reader);
        add(problems_, type.value.mark,
            fmt::format("param '{}' has no type {}{}", name, type.value.describe(), did_you_mean(type.value.text, names_of(param_types()))));
        return false;
    }

    static Value environment_value(const std::string& name) {
        auto source = std::make_shared<Source>();
        source->name = "environment variable " + name;
        source->text = std::getenv(name.c_str());
        Value out;
        out.kind = Value::Kind::scalar;
        out.text = source->text;
        out.mark = {source, 1, 1};
        return out;
    }

    /// @param in  the list or map that contains the value
    void replace_scalar(Value& value, const std::map<std::string, Value>& params, const Mark& in) {
        if (value.text.find("${") == std::string::npos) return;
        const auto give_up = [&] { value.kind = Value::Kind::unresolved; };
        const auto no_room = [&](std::size_t bytes) {
            const bool told = room_.full();
            if (room_.take(bytes)) return false;
            if (!told) add(problems_, value.mark, TextRoom::fault());
            return true;
        };
        std::string out;
        std::set<std::string> inserted;
        for (std::size_t at = 0; at < value.text.size();) {
            const auto begin = value.text.find("${", at);
            out.append(value.text, at, begin - at);
            if (begin == std::string::npos) break;
            const auto end = value.text.find('}', begin);
            if (end == std::string::npos) return add(problems_, value.mark, "'${' has no '}'"), give_up();
            const auto name = value.text.substr(begin + 2, end - begin - 2);
            const auto* const found = look_up(name, value.mark, params);
            if (!found || found->kind == Value::Kind::unresolved) return give_up();
            if (no_room(found->text_bytes())) return give_up();
            if (begin == 0 && end + 1 == value.text.size()) {
                insertions.push_back({in, name});
                const Value whole = *found;
                value = whole;
                return;
            }
            if (found->kind != Value::Kind::scalar)
                return add(problems_, value.mark, fmt::format("${{{}}} is {} and can't be put inside a text", name, found->describe())), give_up();
            if (inserted.insert(name).second) insertions.push_back({value.mark, name});
            out += found->text;
            at = end + 1;
        }
        value.text = std::move(out);
    }

    const Value* look_up(const std::string& name, const Mark& at, const std::map<std::string, Value>& params) {
        if (const auto found = params.find(name); found != params.end()) return &found->second;
        if (environment_.contains(name)) {
            if (!std::getenv(name.c_str())) return add(problems_, at, fmt::format("the environment variable {} is not set", name)), nullptr;
            const auto [value, fresh] = from_environment_.try_emplace(name);
            if (fresh) value->second = environment_value(name);
            return &value->second;
        }
        std::vector<std::string> known;
        for (const auto& [param, value] : params) known.push_back(param);
        for (const auto& [variable, mark] : environment_) known.push_back(variable);
        add(problems_, at, fmt::format("${{{}}} is neither a param nor declared under 'env'{}", name, did_you_mean(name, known)));
        return nullptr;
    }

    Problems& problems_;
    TextRoom& room_;
    const bool open_;
    std::map<std::string, Mark> environment_;
    std::map<std::string, Value> values_;
    std::map<std::string, Value> from_environment_;
};

/// One `--set` of the command line, split at `=`. Marks point into the text as typed.
struct Setting {
    Value::Field target;
    Value value;
};

void point_to(Value& value, const std::shared_ptr<const Source>& source) {
    value.mark.source = source;
    for (auto& item : value.items) point_to(item, source);
    for (auto& field : value.fields) {
        field.mark.source = source;
        point_to(field.value, source);
    }
}

std::optional<Setting> read_setting(const std::string& text, Problems& problems) {
    auto source = std::make_shared<Source>();
    source->name = "--set";
    source->text = text;
    const auto sign = text.find('=');
    if (sign == std::string::npos || sign == 0) return add(problems, {source, 1, 1}, "must be NODE.FIELD=VALUE or PARAM=VALUE"), std::nullopt;
    Setting out;
    out.target = {text.substr(0, sign), {source, 1, 1}, {}};
    const auto value = text.substr(sign + 1);
    if (value.starts_with('[') || value.starts_with('{')) {
        auto padded = std::make_shared<Source>(*source);
        padded->text = std::string(sign + 1, ' ') + value;
        const auto before = problems.size();
        out.value = read_yaml(padded, problems);
        for (auto n = before; n < problems.size(); ++n) problems[n].at.source = source;
        point_to(out.value, source);
        return problems.size() == before ? std::optional(out) : std::nullopt;
    }
    out.value.kind = Value::Kind::scalar;
    out.value.text = value;
    out.value.mark = {source, 1, static_cast<int>(sign) + 2};
    return out;
}

/// Applies `node.field=...` to `nodes` and `frames=...` to `frames` (unless a param is called `frames`).
/// @return the settings of params, by name
std::map<std::string, Value> apply(const std::vector<std::string>& texts, Value& nodes, Value& frames, const Value& params, Problems& problems) {
    std::map<std::string, Value> of_params;
    for (const auto& text : texts) {
        const auto setting = read_setting(text, problems);
        if (!setting) continue;
        const auto& [name, mark, unused] = setting->target;
        const auto dot = name.find('.');
        if (dot == std::string::npos) {
            if (params.find(name)) of_params[name] = setting->value;
            else if (name == "frames") frames = setting->value;
            else add(problems, mark, fmt::format("there is no param '{}'{}", name, did_you_mean(name, names(params))));
            continue;
        }
        auto* const node = nodes.find(name.substr(0, dot));
        if (!node) {
            add(problems, mark, fmt::format("there is no node '{}'{}", name.substr(0, dot), did_you_mean(name.substr(0, dot), names(nodes))));
        } else if (node->value.kind == Value::Kind::map) {
            const Mark field_mark{mark.source, 1, static_cast<int>(dot) + 2};
            const auto field = name.substr(dot + 1);
            if (auto* const stated = node->value.find(field)) *stated = {field, field_mark, setting->value};
            else node->value.fields.push_back({field, field_mark, setting->value});
        }
    }
    return of_params;
}

/// The document of a file, or of a text, that was read.
/// @param open  whether params may have no value
Document document_of(const std::string& name, const std::vector<std::string>& settings, Reader& reader, const Value& root, TextRoom& room, Problems& problems,
                     bool open) {
    const auto part = [&](const char* name, Value::Kind kind) {
        const auto* const field = root.find(name);
        if (field && (kind == Value::Kind::null || field->value.kind == kind)) return field->value;
        Value out;
        out.kind = kind;
        out.mark = root.mark;
        return out;
    };
    Document out;
    out.name = name;
    out.mark = root.mark;
    out.sources = std::move(reader.sources);
    out.frames = part("frames", Value::Kind::null);
    out.nodes = part("nodes", Value::Kind::map);
    out.plugins = part("plugins", Value::Kind::null);
    out.provenance = part("provenance", Value::Kind::null);
    if (root.fields.empty()) return out;
    if (out.nodes.fields.empty() && problems.empty()) add(problems, root.mark, "the pipeline has no nodes");
    if (const auto* const frames = root.find("frames"); frames && frames->value.kind == Value::Kind::null)
        add(problems, frames->mark, "'frames' has no value; name frames such as 1001-1084, or leave the field out for a single one");

    const auto params = part("params", Value::Kind::map);
    Names known(problems, room, open);
    known.declare_environment(part("env", Value::Kind::null));
    out.params = known.declare_params(params, apply(settings, out.nodes, out.frames, params, problems));
    known.replace(out.frames);
    known.replace(out.nodes);
    known.replace(out.plugins);
    known.replace(out.provenance);
    out.insertions = std::move(known.insertions);
    out.environment = known.environment();
    return out;
}

}  // namespace

Document read_document(const std::string& path, const std::vector<std::string>& settings, Problems& problems, bool open) {
    TextRoom room;
    Reader reader(problems, room);
    const Value root = reader.load(path, {});
    return document_of(path, settings, reader, root, room, problems, open);
}

Document read_document(const std::shared_ptr<const Source>& text, const std::vector<std::string>& settings, Problems& problems) {
    TextRoom room;
    Reader reader(problems, room);
    const Value root = reader.load(text, {});
    return document_of(text->name, settings, reader, root, room, problems, false);
}

}  // namespace fluidcarve
