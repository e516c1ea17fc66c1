#include "graph/types/file_fields.h"

#include "carve/base/find_or_null.h"

namespace fluidcarve {
namespace {

template <class T>
ParamType param_of(std::string name) {
    return {std::move(name), ParamTraits<T>::shape(), [](const Value& value, ValueReader& reader) {
                return ParamTraits<T>::parse(value, reader).has_value();
            }};
}

/// Bounds hold for a number of seams, not for a percentage.
bool takes_count(const Value& value, ValueReader& reader) {
    const auto count = ParamTraits<Count>::parse(value, reader);
    return count && (count->percent || reader.number(value, true));
}

template <class Named>
std::vector<std::string> all_names(const Named& all) {
    std::vector<std::string> out;
    for (const auto& each : all) out.emplace_back(each.name);
    return out;
}

}  // namespace

const FileField* find_field(std::span<const FileField> fields, std::string_view name) {
    return find_or_null(fields, name, &FileField::name);
}

std::vector<std::string> names_of(std::span<const FileField> fields) { return all_names(fields); }

const std::vector<ParamType>& param_types() {
    static const std::vector<ParamType> all{param_of<bool>("bool"),
                                            param_of<int>("int"),
                                            param_of<double>("float"),
                                            param_of<Vec3>("vector"),
                                            param_of<std::string>("string"),
                                            param_of<OutputPath>("path"),
                                            {"count", ParamTraits<Count>::shape(), &takes_count}};
    return all;
}

std::vector<std::string> names_of(const std::vector<ParamType>& types) { return all_names(types); }

}  // namespace fluidcarve
