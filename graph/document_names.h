#pragma once

#include "graph/insertion.h"
#include "graph/text/problem.h"
#include "graph/text/text_room.h"
#include "graph/text/value.h"
#include "graph/types/param.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Holds the values of params and environment variables, and replaces `${name}` by them.
class DocumentNames {
public:
    /// @param open  whether params may have no value
    DocumentNames(Problems& problems, TextRoom& room, bool open)
        : problems_(problems), room_(room), open_(open) {}

    void declare_environment(const Value& list);

    /// The declared variables that are set.
    std::vector<std::pair<std::string, std::string>> environment() const;

    /// @return map: param name to value
    Value declare_params(const Value& params, const std::map<std::string, Value>& settings);

    /// Replaces every `${name}` in a value and its parts.
    void replace(Value& value) { replace(value, values_, {}); }

    std::vector<Insertion> insertions;  ///< all replacements so far

private:
    void replace(Value& value, const std::map<std::string, Value>& params, const Mark& in);

    void declare_param(const Value::Field& field, const std::map<std::string, Value>& settings);
    /// The fields `min` and `max` of a param.
    Range range_of(const Value::Field& param);
    bool fits(const Value::Field& type, const Value& value, const std::string& name, Range range);

    static Value environment_value(const std::string& name);

    /// @param in  the list or map that contains the value
    void replace_scalar(Value& value, const std::map<std::string, Value>& params, const Mark& in);

    const Value* look_up(const std::string& name, const Mark& at,
                         const std::map<std::string, Value>& params);

    Problems& problems_;
    TextRoom& room_;
    const bool open_;
    std::map<std::string, Mark> environment_;
    std::map<std::string, Value> values_;
    std::map<std::string, Value> from_environment_;
};

}  // namespace fluidcarve
