#include "graph/types/registry.h"

#include "carve/base/find_or_null.h"
#include "carve/base/words.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace fluidcarve {

std::string family_of(std::string_view type) { return std::string(type.substr(0, type.find('.'))); }

const InputSpec* NodeType::input(std::string_view name) const {
    return find_or_null(inputs, name, &InputSpec::name);
}

const ParamSpec* NodeType::param(std::string_view name) const {
    return find_or_null(params, name, &ParamSpec::name);
}

std::vector<std::string> NodeType::field_names() const {
    std::vector<std::string> out;
    for (const auto& input : inputs) out.push_back(input.name);
    for (const auto& param : params) out.push_back(param.name);
    return out;
}

void Registry::add(NodeType type) {
    const auto refuse = [&](const std::string& why) {
        throw std::logic_error(fmt::format("node type '{}': {}", type.name, why));
    };
    if (type.name.find('.') == std::string::npos) refuse("a name is family.verb");
    if (type.doc.empty()) refuse("no doc");
    std::vector<std::string> seen;
    const auto take = [&](const std::string& name, const std::string& doc) {
        if (name.empty() || find_field(common_fields, name))
            refuse(fmt::format("'{}' can't name a field", name));
        if (doc.empty()) refuse(fmt::format("'{}' has no doc", name));
        if (std::ranges::find(seen, name) != seen.end())
            refuse(fmt::format("two fields are called '{}'", name));
        seen.push_back(name);
    };
    for (const auto& input : type.inputs) {
        take(input.name, input.doc);
        payload(input.type);
    }
    for (const auto& param : type.params) take(param.name, param.doc);
    seen.clear();
    for (const auto& output : type.outputs) {
        take(output.name, output.doc);
        payload(output.type);
    }
    if (const auto& input = type.names_from; !input.empty()) {
        if (!type.input(input))
            refuse(
                fmt::format("its first output can't have the names of the grids of '{}': there "
                            "is no such input",
                            input));
        if (type.outputs.empty())
            refuse(fmt::format("it has no output that could have the names of the grids of '{}'",
                               input));
    }
    for (const auto& kind : type.kinds)
        if (!type.input(kind.input))
            refuse(
                fmt::format("it has no input '{}' that could ask for {}", kind.input, kind.type));
    if (!nodes_.emplace(type.name, type).second) refuse("the name is taken");
}

void Registry::add(PayloadType type) {
    for (const auto& known : payloads_)
        if (known.name == type.name || known.type == type.type)
            throw std::logic_error(fmt::format("payload type '{}' is registered twice", type.name));
    payloads_.push_back(std::move(type));
}

void Registry::add(Conversion conversion) { conversions_.push_back(std::move(conversion)); }

void Registry::add(Selection selection) { selections_.push_back(std::move(selection)); }

const NodeType* Registry::node(std::string_view name) const {
    const auto found = nodes_.find(name);
    return found == nodes_.end() ? nullptr : &found->second;
}

std::vector<std::string> Registry::node_names() const {
    std::vector<std::string> out;
    for (const auto& [name, type] : nodes_) out.push_back(name);
    return out;
}

std::vector<std::string> Registry::families() const {
    std::vector<std::string> out;
    for (const auto& [name, type] : nodes_)
        if (const auto family = family_of(name); out.empty() || out.back() != family)
            out.push_back(family);
    return out;
}

const PayloadType& Registry::payload(std::type_index type) const {
    for (const auto& known : payloads_)
        if (known.type == type) return known;
    throw std::logic_error(fmt::format("payload type {} is not registered", type.name()));
}

const Conversion* Registry::conversion(std::type_index from, std::type_index to) const {
    for (const auto& known : conversions_)
        if (known.from == from && known.to == to) return &known;
    return nullptr;
}

const Selection* Registry::selection(std::type_index from, std::type_index to) const {
    for (const auto& known : selections_)
        if (known.from == from && known.to == to) return &known;
    return nullptr;
}

bool Registry::accepts(std::type_index to, std::type_index from) const {
    return to == from || conversion(from, to);
}

Payload Registry::convert(const Payload& payload, std::type_index to) const {
    if (!payload || payload.type() == to) return payload;
    return conversion(payload.type(), to)->convert(payload);
}

std::vector<std::string> Registry::names_into(std::type_index to) const {
    std::vector<std::string> out{payload(to).name};
    for (const auto& known : conversions_)
        if (known.to == to) out.push_back(payload(known.from).name);
    return out;
}

std::string Registry::accepted_names(std::type_index to) const { return either(names_into(to)); }

std::string Registry::accepted_names(const NodeType& type, const InputSpec& input) const {
    auto all = names_into(input.type);
    for (const auto& kind : type.kinds)
        if (kind.input == input.name && !accepts(input.type, kind.payload))
            all.push_back(payload(kind.payload).name);
    return either(all);
}

}  // namespace fluidcarve
