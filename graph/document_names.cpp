#include "graph/document_names.h"

#include "carve/base/words.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <set>

namespace fluidcarve {

void DocumentNames::declare_environment(const Value& list) {
    if (list.kind == Value::Kind::null) return;
    if (list.kind != Value::Kind::list)
        return add(problems_, list.mark,
                   "'env' must be a list of environment variables, not " + list.describe());
    for (const auto& item : list.items)
        if (item.kind == Value::Kind::scalar) environment_.emplace(item.text, item.mark);
        else add(problems_, item.mark, "'env' must list names, not " + item.describe());
}

std::vector<std::pair<std::string, std::string>> DocumentNames::environment() const {
    std::vector<std::pair<std::string, std::string>> out;
    for (const auto& [name, mark] : environment_)
        if (const auto* const value = std::getenv(name.c_str())) out.emplace_back(name, value);
    return out;
}

Value DocumentNames::declare_params(const Value& params,
                                    const std::map<std::string, Value>& settings) {
    auto out = Value::map(params.mark);
    for (const auto& field : params.fields) {
        declare_param(field, settings);
        out.fields.push_back({field.name, field.mark, values_[field.name]});
    }
    return out;
}

void DocumentNames::replace(Value& value, const std::map<std::string, Value>& params,
                            const Mark& in) {
    const auto mark = value.mark;
    if (value.kind == Value::Kind::scalar) return replace_scalar(value, params, in);
    for (auto& item : value.items) replace(item, params, mark);
    for (auto& field : value.fields) replace(field.value, params, mark);
}

void DocumentNames::declare_param(const Value::Field& field,
                                  const std::map<std::string, Value>& settings) {
    const auto& [name, mark, param] = field;
    values_[name].kind = Value::Kind::unresolved;  // declared, even if the declaration has faults
    if (param.kind != Value::Kind::map)
        return add(problems_, param.mark,
                   fmt::format("param '{}' must be {{type: ..., default: ..., doc: ...}}, not {}",
                               name, param.describe()));
    for (const auto& each : param.fields)
        if (!find_field(param_fields, each.name))
            add(problems_, each.mark,
                fmt::format("a param has no field '{}'{}", each.name,
                            did_you_mean(each.name, names_of(param_fields))));
    const auto* const type = param.find("type");
    if (!type)
        return add(
            problems_, mark,
            fmt::format("param '{}' needs a type: {}", name, either(names_of(param_types()))));

    const auto range = range_of(field);
    const Value* value = nullptr;
    Value from_environment;
    if (const auto* fallback = param.find("default")) value = &fallback->value;
    if (environment_.contains(name) && std::getenv(name.c_str()))
        value = &(from_environment = environment_value(name));
    if (const auto set = settings.find(name); set != settings.end()) value = &set->second;
    if (!value || value->kind == Value::Kind::null) {
        if (!open_)
            add(problems_, mark,
                fmt::format("param '{0}' has no value; give it a default or --set {0}=...", name));
        return;
    }

    Value replaced = *value;
    // A default may use environment variables but not other params, so the order of params does
    // not matter.
    if (value != &from_environment) replace(replaced, {}, {});
    if (fits(*type, replaced, name, range)) values_[name] = std::move(replaced);
}

Range DocumentNames::range_of(const Value::Field& param) {
    Range range;
    for (const auto& [bound, into] : {std::pair{"min", &range.min}, std::pair{"max", &range.max}})
        if (const auto* stated = param.value.find(bound)) {
            ValueReader reader(problems_, fmt::format("param '{}' field '{}'", param.name, bound),
                               any_number());
            *into = reader.number(stated->value, false).value_or(*into);
        }
    return range;
}

bool DocumentNames::fits(const Value::Field& type, const Value& value, const std::string& name,
                         Range range) {
    ValueReader reader(problems_, fmt::format("param '{}'", name), range);
    for (const auto& known : param_types())
        if (type.value.kind == Value::Kind::scalar && type.value.text == known.name)
            return known.takes(value, reader);
    add(problems_, type.value.mark,
        fmt::format("param '{}' has no type {}{}", name, type.value.describe(),
                    did_you_mean(type.value.text, names_of(param_types()))));
    return false;
}

Value DocumentNames::environment_value(const std::string& name) {
    auto source = std::make_shared<Source>();
    source->name = "environment variable " + name;
    source->text = std::getenv(name.c_str());
    return Value::scalar({source, 1, 1}, source->text);
}

void DocumentNames::replace_scalar(Value& value, const std::map<std::string, Value>& params,
                                   const Mark& in) {
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
        if (end == std::string::npos)
            return add(problems_, value.mark, "'${' has no '}'"), give_up();
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
            return add(problems_, value.mark,
                       fmt::format("${{{}}} is {} and can't be put inside a text", name,
                                   found->describe())),
                   give_up();
        if (inserted.insert(name).second) insertions.push_back({value.mark, name});
        out += found->text;
        at = end + 1;
    }
    value.text = std::move(out);
}

const Value* DocumentNames::look_up(const std::string& name, const Mark& at,
                                    const std::map<std::string, Value>& params) {
    if (const auto found = params.find(name); found != params.end()) return &found->second;
    if (environment_.contains(name)) {
        if (!std::getenv(name.c_str()))
            return add(problems_, at, fmt::format("the environment variable {} is not set", name)),
                   nullptr;
        const auto [value, fresh] = from_environment_.try_emplace(name);
        if (fresh) value->second = environment_value(name);
        return &value->second;
    }
    std::vector<std::string> known;
    for (const auto& [param, value] : params) known.push_back(param);
    for (const auto& [variable, mark] : environment_) known.push_back(variable);
    add(problems_, at,
        fmt::format("${{{}}} is neither a param nor declared under 'env'{}", name,
                    did_you_mean(name, known)));
    return nullptr;
}

}  // namespace fluidcarve
