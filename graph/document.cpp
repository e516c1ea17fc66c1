#include "graph/document.h"

#include "carve/base/words.h"
#include "formats/file/full_path.h"
#include "formats/file/input_file.h"
#include "graph/document_names.h"
#include "graph/text/yaml_reader.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

namespace fluidcarve {

namespace {

/// The names of a map's fields.
std::vector<std::string> names(const Value& map) {
    std::vector<std::string> out;
    for (const auto& field : map.fields) out.push_back(field.name);
    return out;
}

namespace fs = std::filesystem;

constexpr std::size_t most_extends = 16;

/// Merges `later` into `earlier`, down to `levels` nested maps. A null field in `later` removes the
/// field from `earlier`. Field names are unique in each.
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
    std::erase_if(earlier.fields,
                  [&](const Value::Field& each) { return removed.contains(each.name); });
    earlier.mark = later.mark;
}

/// Prepends the items of the list in `earlier` to the same list in `later`.
void put_before(Value& later, const Value& earlier, const char* list) {
    auto* const now = later.find(list);
    const auto* const before = earlier.find(list);
    if (now && before && now->value.kind == Value::Kind::list)
        now->value.items.insert(now->value.items.begin(), before->value.items.begin(),
                                before->value.items.end());
}

/// Reads a pipeline file and the files that it extends.
class Reader {
public:
    Reader(Problems& problems, TextRoom& room) : problems_(problems), room_(room) {}

    /// Reads a file and merges it over the files that it extends. Returns a map even if the file
    /// can't be read.
    Value load(const std::string& path, const Mark& from) {
        auto nothing = Value::map({});
        // A path that leads nowhere stays as it is: `open` tells why.
        const auto real = canonical_path(path);
        const auto file = real.empty() ? path : real.string();
        if (std::ranges::find(loading_, file) != loading_.end())
            return add(problems_, from,
                       fmt::format("{} extends itself, directly or through others", path)),
                   nothing;
        if (loading_.size() >= most_extends)
            return add(problems_, from,
                       fmt::format("more than {} files extend each other", most_extends)),
                   nothing;

        const auto source = open(path, from);
        if (!source) return nothing;
        loading_.push_back(file);
        Value out = load(source, from);
        loading_.pop_back();
        return out;
    }

    /// Reads a text and merges it over the files that it extends. Returns a map even if it is not
    /// a pipeline.
    Value load(const std::shared_ptr<const Source>& source, const Mark& from) {
        auto nothing = Value::map({});
        const auto before = problems_.size();
        Value root = read_yaml(source, problems_, room_);
        if (from.source && !is_pipeline(root))
            return refuse_unshown(*source, from, before, root.kind), nothing;
        nothing.mark = {source, 0, 0};
        sources.push_back(nothing.mark);
        if (problems_.size() > before && root.kind == Value::Kind::null) return nothing;
        if (root.kind == Value::Kind::null)
            return add(problems_, {source, 0, 0},
                       "the file is empty: a pipeline starts with 'fluidcarve: 1' and has "
                       "'nodes:'"),
                   nothing;
        if (root.kind != Value::Kind::map)
            return add(problems_, root.mark,
                       "a pipeline is a map with 'fluidcarve: 1' and 'nodes:', not " +
                           root.describe()),
                   nothing;
        root.mark = {source, 0, 0};
        check_top(root);

        const auto* const extends = root.find("extends");
        if (!extends) return root;
        if (extends->value.kind != Value::Kind::scalar)
            return add(problems_, extends->value.mark,
                       "'extends' must be the path of a pipeline file, not " +
                           extends->value.describe()),
                   root;
        auto base_path = fs::path(extends->value.text);
        if (base_path.is_relative()) base_path = fs::path(source->folder) / base_path;
        Value merged = load(base_path.lexically_normal().string(), extends->value.mark);
        put_before(root, merged, "plugins");
        merge(merged, root, 3);
        return merged;
    }

    std::vector<Mark> sources;  ///< the files read so far

private:
    /// Whether an extended file is a pipeline: it states a version, or it extends another file and
    /// has only a pipeline's fields.
    static bool is_pipeline(const Value& root) {
        if (const auto* const version = root.find("fluidcarve")) return version->value.text == "1";
        return root.find("extends") &&
               std::ranges::all_of(root.fields, [](const Value::Field& field) {
                   return find_field(top_fields, field.name) != nullptr;
               });
    }

    /// Refuses an extended file without showing any of its text: whoever wrote the pipeline may
    /// name files that only its reader may read.
    /// @param from    where the file is extended
    /// @param before  number of problems before the file was read
    /// @param kind    what was read
    void refuse_unshown(const Source& file, const Mark& from, std::size_t before,
                        Value::Kind kind) {
        Mark at{std::make_shared<Source>(Source{file.name, {}, file.folder}), 0, 0};
        std::string fault = "it does not state 'fluidcarve: 1'";
        if (kind == Value::Kind::null && problems_.size() > before) {
            const auto& first = problems_[before];
            at.line = first.at.line;
            at.column = first.at.column;
            // Problems of a file as a whole quote nothing.
            fault = room_.full()  ? TextRoom::fault()
                    : at.line > 0 ? "it does not parse here"
                                  : first.message;
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
            source->text = InputFile(path, {.what = "a pipeline", .anywhere = !from.source})
                               .head(most_yaml_bytes + 1);
        } catch (const Unreadable& unreadable) {
            add(problems_, from, fmt::format("cannot read {}: it {}", path, unreadable.fault));
            return nullptr;
        }
        return source;
    }

    void check_top(const Value& root) {
        for (const auto& field : root.fields)
            if (!find_field(top_fields, field.name))
                add(problems_, field.mark,
                    fmt::format("a pipeline has no field '{}'{}", field.name,
                                did_you_mean(field.name, names_of(top_fields))));
        const auto* const version = root.find("fluidcarve");
        // A file that extends another may leave the version to that file.
        if (!version && !root.find("extends"))
            add(problems_, root.mark,
                "the format version is missing: the file must state 'fluidcarve: 1'");
        if (version && (version->value.kind != Value::Kind::scalar || version->value.text != "1"))
            add(problems_, version->value.mark,
                fmt::format("format version {} is unknown; this program reads version 1",
                            version->value.describe()));
        for (const auto* name : {"params", "nodes"})
            if (const auto* field = root.find(name); field && field->value.kind != Value::Kind::map)
                add(problems_, field->value.mark,
                    fmt::format("'{}' must be a map, not {}", name, field->value.describe()));
        const auto* const plugins = root.find("plugins");
        if (!plugins || plugins->value.kind == Value::Kind::null) return;
        if (plugins->value.kind != Value::Kind::list)
            return add(problems_, plugins->value.mark,
                       "'plugins' must be a list of files, not " + plugins->value.describe());
        for (const auto& file : plugins->value.items)
            if (file.kind != Value::Kind::scalar)
                add(problems_, file.mark,
                    "'plugins' must list the paths of files, not " + file.describe());
    }

    Problems& problems_;
    TextRoom& room_;
    std::vector<std::string> loading_;
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
    if (sign == std::string::npos || sign == 0)
        return add(problems, {source, 1, 1}, "must be NODE.FIELD=VALUE or PARAM=VALUE"),
               std::nullopt;
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
    out.value = Value::scalar({source, 1, static_cast<int>(sign) + 2}, value);
    return out;
}

/// Applies `node.field=...` to `nodes` and `frames=...` to `frames` (unless a param is called
/// `frames`).
/// @return the settings of params, by name
std::map<std::string, Value> apply(const std::vector<std::string>& texts, Value& nodes,
                                   Value& frames, const Value& params, Problems& problems) {
    std::map<std::string, Value> of_params;
    for (const auto& text : texts) {
        const auto setting = read_setting(text, problems);
        if (!setting) continue;
        const auto& [name, mark, unused] = setting->target;
        const auto dot = name.find('.');
        if (dot == std::string::npos) {
            if (params.find(name)) of_params[name] = setting->value;
            else if (name == "frames") frames = setting->value;
            else
                add(problems, mark,
                    fmt::format("there is no param '{}'{}", name,
                                did_you_mean(name, names(params))));
            continue;
        }
        auto* const node = nodes.find(name.substr(0, dot));
        if (!node) {
            add(problems, mark,
                fmt::format("there is no node '{}'{}", name.substr(0, dot),
                            did_you_mean(name.substr(0, dot), names(nodes))));
        } else if (node->value.kind == Value::Kind::map) {
            const Mark field_mark{mark.source, 1, static_cast<int>(dot) + 2};
            const auto field = name.substr(dot + 1);
            if (auto* const stated = node->value.find(field))
                *stated = {field, field_mark, setting->value};
            else node->value.fields.push_back({field, field_mark, setting->value});
        }
    }
    return of_params;
}

/// A part of a pipeline; an empty one of this kind, if it is not stated.
/// @param kind  null: of any kind
Value part_of(const Value& root, const char* name, Value::Kind kind) {
    const auto* const field = root.find(name);
    if (field && (kind == Value::Kind::null || field->value.kind == kind)) return field->value;
    Value out;
    out.kind = kind;
    out.mark = root.mark;
    return out;
}

/// Makes documents of what a Reader has read.
class DocumentMaker {
public:
    /// @param open  whether params may have no value
    DocumentMaker(const std::vector<std::string>& settings, Problems& problems, bool open)
        : settings_(settings), problems_(problems), open_(open) {}

    /// @param from  a path, or a text
    Document made(const std::string& name, const auto& from) {
        Reader reader(problems_, room_);
        const Value root = reader.load(from, {});
        Document out;
        out.name = name;
        out.mark = root.mark;
        out.sources = std::move(reader.sources);
        out.frames = part_of(root, "frames", Value::Kind::null);
        out.nodes = part_of(root, "nodes", Value::Kind::map);
        out.plugins = part_of(root, "plugins", Value::Kind::null);
        out.provenance = part_of(root, "provenance", Value::Kind::null);
        if (root.fields.empty()) return out;
        if (out.nodes.fields.empty() && problems_.empty())
            add(problems_, root.mark, "the pipeline has no nodes");
        if (const auto* const frames = root.find("frames");
            frames && frames->value.kind == Value::Kind::null)
            add(problems_, frames->mark,
                "'frames' has no value; name frames such as 1001-1084, or leave the field out for "
                "a single one");
        insert_names(root, out);
        return out;
    }

private:
    /// Applies the settings, and replaces `${name}`.
    void insert_names(const Value& root, Document& out) {
        const auto params = part_of(root, "params", Value::Kind::map);
        DocumentNames known(problems_, room_, open_);
        known.declare_environment(part_of(root, "env", Value::Kind::null));
        out.params = known.declare_params(
            params, apply(settings_, out.nodes, out.frames, params, problems_));
        known.replace(out.frames);
        known.replace(out.nodes);
        known.replace(out.plugins);
        known.replace(out.provenance);
        out.insertions = std::move(known.insertions);
        out.environment = known.environment();
    }

    const std::vector<std::string>& settings_;
    Problems& problems_;
    bool open_;
    TextRoom room_;
};

}  // namespace

Document read_document(const std::string& path, const std::vector<std::string>& settings,
                       Problems& problems, bool open) {
    return DocumentMaker(settings, problems, open).made(path, path);
}

Document read_document(const std::shared_ptr<const Source>& text,
                       const std::vector<std::string>& settings, Problems& problems) {
    return DocumentMaker(settings, problems, false).made(text->name, text);
}

}  // namespace fluidcarve
