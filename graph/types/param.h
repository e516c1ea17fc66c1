#pragma once

#include "carve/base/values.h"
#include "formats/file/path_pattern.h"
#include "graph/text/value.h"

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A file that the pipeline reads. A relative path starts at the folder of the text that states it,
/// else at the current folder.
struct InputPath : PathPattern {
    using PathPattern::PathPattern;
};

/// A file that the pipeline writes. A relative path starts at the current folder.
struct OutputPath : PathPattern {
    using PathPattern::PathPattern;
};

/// A file that another node of the pipeline writes. A relative path starts at the current folder.
struct WrittenPath : PathPattern {
    using PathPattern::PathPattern;
};
/// Such files by name: `files: {smoke: out/smoke.####.vdb}`. The pipeline's check refuses a file
/// that no other node writes.
using WrittenPaths = std::map<std::string, WrittenPath>;

/// The unit of a parameter, shown in the reference.
enum class Unit { none, world, voxels, vertices, seams, frames, pixels };
std::string to_text(Unit unit);

/// Inclusive bounds of each number in a parameter's value.
struct Range {
    double min = -std::numeric_limits<double>::infinity();
    double max = std::numeric_limits<double>::infinity();
};
constexpr Range at_least(double min) { return {min, std::numeric_limits<double>::infinity()}; }
constexpr Range between(double min, double max) { return {min, max}; }
constexpr Range any_number() { return {}; }
/// "from 0 to 10", "at least 1"; empty: any number.
std::string to_text(const Range& range);

/// The form of a parameter's value. Messages, the reference and the JSON schema are derived from
/// it.
struct Shape {
    enum class Kind {
        boolean,
        integer,
        number,
        text,
        input_path,
        output_path,
        count,
        vector,
        interval,
        choice,
        list,
        map,
        automatic,
        any_of
    };
    Kind kind = Kind::text;
    std::vector<std::string> choices = {};  ///< of `choice`: the names
    /// Of `list`, `map`, `automatic`: the shape of a value; of `any_of`: the alternatives.
    std::vector<Shape> parts = {};
    /// Of a map with fixed fields: name and shape of each; `parts` is then empty.
    std::vector<std::pair<std::string, Shape>> fields = {};
};
/// The shape in words.
std::string to_text(const Shape& shape);

/// The finite number that a whole text states; else nothing.
std::optional<double> parse_number(std::string_view text);

/// Collects the faults in one field's value.
class ValueReader {
public:
    ValueReader(Problems& problems, std::string what, Range range)
        : problems_(problems), what_(std::move(what)), range_(range) {}
    /// Adds the problem "<what> must be <form>, not <value>" at the value's place.
    void unwanted(const Value& value, const std::string& form);
    /// Adds the problem "<what> <message>" at the value's place.
    void fault(const Value& value, const std::string& message);
    /// A finite number within the range; else adds a problem and returns nothing.
    /// @param whole  accept whole numbers only
    std::optional<double> number(const Value& value, bool whole);

private:
    Problems& problems_;
    std::string what_;
    Range range_;
};

/// How a C++ type is read from a Value. Specialise it for a node's own parameter type:
///   static Shape shape();
///   static std::optional<T> parse(const Value&, ValueReader&);
///       returns nothing after it added a problem
///   static std::string text(const T&);
///       the value as YAML that parse reads back
template <class T>
struct ParamTraits;

template <>
struct ParamTraits<bool> {
    static Shape shape() { return {Shape::Kind::boolean}; }
    static std::optional<bool> parse(const Value& value, ValueReader& reader);
    static std::string text(bool value) { return value ? "true" : "false"; }
};
template <>
struct ParamTraits<int> {
    static Shape shape() { return {Shape::Kind::integer}; }
    static std::optional<int> parse(const Value& value, ValueReader& reader);
    static std::string text(int value) { return std::to_string(value); }
};
template <>
struct ParamTraits<double> {
    static Shape shape() { return {Shape::Kind::number}; }
    static std::optional<double> parse(const Value& value, ValueReader& reader) {
        return reader.number(value, false);
    }
    static std::string text(double value);
};
template <>
struct ParamTraits<float> {
    static Shape shape() { return {Shape::Kind::number}; }
    static std::optional<float> parse(const Value& value, ValueReader& reader);
    static std::string text(float value);
};
template <>
struct ParamTraits<std::string> {
    static Shape shape() { return {Shape::Kind::text}; }
    static std::optional<std::string> parse(const Value& value, ValueReader& reader);
    static std::string text(const std::string& value) { return value; }
};
template <>
struct ParamTraits<Vec3> {
    static Shape shape() { return {Shape::Kind::vector}; }
    static std::optional<Vec3> parse(const Value& value, ValueReader& reader);
    static std::string text(const Vec3& value);
};
template <>
struct ParamTraits<Interval> {
    static Shape shape() { return {Shape::Kind::interval}; }
    static std::optional<Interval> parse(const Value& value, ValueReader& reader);
    static std::string text(const Interval& value);
};
template <>
struct ParamTraits<Count> {
    static Shape shape() { return {Shape::Kind::count}; }
    static std::optional<Count> parse(const Value& value, ValueReader& reader);
    static std::string text(const Count& value);
};
template <>
struct ParamTraits<InputPath> {
    static Shape shape() { return {Shape::Kind::input_path}; }
    static std::optional<InputPath> parse(const Value& value, ValueReader& reader);
    static std::string text(const InputPath& value) { return value.text(); }
};
template <>
struct ParamTraits<OutputPath> {
    static Shape shape() { return {Shape::Kind::output_path}; }
    static std::optional<OutputPath> parse(const Value& value, ValueReader& reader);
    static std::string text(const OutputPath& value) { return value.text(); }
};
template <>
struct ParamTraits<WrittenPath> {
    static Shape shape() { return {Shape::Kind::output_path}; }
    static std::optional<WrittenPath> parse(const Value& value, ValueReader& reader);
    static std::string text(const WrittenPath& value) { return value.text(); }
};

template <class T>
struct ParamTraits<std::optional<T>> {
    static Shape shape() {
        return {.kind = Shape::Kind::automatic, .parts = {ParamTraits<T>::shape()}};
    }
    static std::optional<std::optional<T>> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar && value.text == "auto")
            return std::optional<std::optional<T>>(std::in_place, std::nullopt);
        if (auto got = ParamTraits<T>::parse(value, reader))
            return std::optional<std::optional<T>>(std::in_place, std::move(*got));
        return std::nullopt;
    }
    static std::string text(const std::optional<T>& value) {
        return value ? ParamTraits<T>::text(*value) : "auto";
    }
};

template <class T>
struct ParamTraits<std::vector<T>> {
    static Shape shape() { return {.kind = Shape::Kind::list, .parts = {ParamTraits<T>::shape()}}; }
    static std::optional<std::vector<T>> parse(const Value& value, ValueReader& reader) {
        if (value.kind != Value::Kind::list)
            return reader.unwanted(value, to_text(shape())), std::nullopt;
        std::vector<T> out;
        for (const auto& item : value.items)
            if (auto got = ParamTraits<T>::parse(item, reader)) out.push_back(std::move(*got));
        return out.size() == value.items.size() ? std::optional(std::move(out)) : std::nullopt;
    }
    static std::string text(const std::vector<T>& value) {
        std::string out;
        for (const auto& item : value)
            out += (out.empty() ? "" : ", ") + ParamTraits<T>::text(item);
        return "[" + out + "]";
    }
};

template <class T>
struct ParamTraits<std::map<std::string, T>> {
    static Shape shape() { return {.kind = Shape::Kind::map, .parts = {ParamTraits<T>::shape()}}; }
    static std::optional<std::map<std::string, T>> parse(const Value& value, ValueReader& reader) {
        if (value.kind != Value::Kind::map)
            return reader.unwanted(value, to_text(shape())), std::nullopt;
        std::map<std::string, T> out;
        for (const auto& field : value.fields)
            if (auto got = ParamTraits<T>::parse(field.value, reader))
                out.emplace(field.name, std::move(*got));
        return out.size() == value.fields.size() ? std::optional(std::move(out)) : std::nullopt;
    }
    static std::string text(const std::map<std::string, T>& value) {
        std::string out;
        for (const auto& [name, item] : value)
            out += (out.empty() ? "" : ", ") + name + ": " + ParamTraits<T>::text(item);
        return "{" + out + "}";
    }
};

template <class E>
requires std::is_enum_v<E>
struct ParamTraits<E> {
    static Shape shape() {
        Shape out{Shape::Kind::choice};
        for (const auto& [name, value] : ChoiceNames<E>::names) out.choices.emplace_back(name);
        return out;
    }
    static std::optional<E> parse(const Value& value, ValueReader& reader) {
        for (const auto& [name, choice] : ChoiceNames<E>::names)
            if (value.kind == Value::Kind::scalar && value.text == name) return choice;
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    }
    static std::string text(E value) { return choice_text(value); }
};

}  // namespace fluidcarve
