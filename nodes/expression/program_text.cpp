#include "nodes/expression/program_text.h"

#include <algorithm>
#include <optional>
#include <string_view>

namespace fluidcarve {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::size_t offset_of(std::string_view text, int line, int column) {
    std::size_t begin = 0;
    for (int n = 1; n < line && begin < text.size(); ++n)
        begin = std::min(text.find('\n', begin), text.size() - 1) + 1;
    const auto end = std::min(text.find('\n', begin), text.size());
    return std::min(begin + static_cast<std::size_t>(std::max(column - 1, 0)), end);
}

/// Reads the characters of a scalar in a YAML file. It skips white space, since YAML's folding
/// changes only that.
class ScalarReader {
public:
    /// @param at     offset of the scalar, or of its anchor or tag
    /// @param value  the parsed value; tells a quoted scalar from a plain text that begins with a
    ///   quote
    ScalarReader(std::string_view file, std::size_t at, std::string_view value)
        : file_(file), at_(at) {
        while (here() == '&' || here() == '!') {
            while (at_ < file_.size() && !is_space(file_[at_])) ++at_;
            skip_space();
        }
        const bool quoted = (here() == '"' || here() == '\'') && !value.starts_with(here());
        if (quoted) quote_ = file_[at_++];
        if (here() == '|' || here() == '>') at_ = std::min(file_.find('\n', at_), file_.size());
    }

    std::size_t at() const { return at_; }

    /// Moves to the next character.
    /// @return the character; 0 at the end of the file, or for an unknown escape sequence
    char next() {
        skip_space();
        const char c = here();
        if (quote_ == '\'' && c == '\'') ++escape_;
        if (quote_ != '"' || c != '\\') return c;
        const char escaped = at_ + 1 < file_.size() ? file_[at_ + 1] : '\0';
        if (is_space(escaped) || escaped == 'n' || escaped == 't' || escaped == 'r') {
            at_ += 2;
            return next();
        }
        ++escape_;
        return escaped == '"' || escaped == '\\' || escaped == '/' ? escaped : '\0';
    }
    void pass() {
        at_ += 1 + escape_;
        escape_ = 0;
    }

private:
    char here() const { return at_ < file_.size() ? file_[at_] : '\0'; }
    void skip_space() {
        while (is_space(here())) ++at_;
    }

    std::string_view file_;
    std::size_t at_;
    std::size_t escape_ = 0;  ///< bytes of an escape sequence before the current character
    char quote_ = '\0';
};

}  // namespace

Mark ProgramText::place(int line, int column) const {
    if (!mark.source || mark.line == 0 || line == 0) return mark;
    const auto& file = mark.source->text;
    const auto wanted = offset_of(text, line, column);
    ScalarReader reader(file, offset_of(file, mark.line, mark.column), text);
    auto found = offset_of(file, mark.line, mark.column);
    for (std::size_t n = 0; n <= wanted && n < text.size(); ++n) {
        if (is_space(text[n])) continue;
        if (reader.next() != text[n]) break;
        found = reader.at();
        if (n == wanted) break;
        reader.pass();
        found = reader.at();
    }
    const auto before = std::string_view(file).substr(0, found);
    const auto begin = before.rfind('\n') + 1;
    return {mark.source, static_cast<int>(std::ranges::count(before, '\n')) + 1,
            static_cast<int>(found - begin) + 1};
}

std::optional<ProgramText> ParamTraits<ProgramText>::parse(const Value& value,
                                                           ValueReader& reader) {
    if (value.kind == Value::Kind::scalar) return ProgramText{value.text, value.mark};
    return reader.unwanted(value, "a text"), std::nullopt;
}

std::optional<ProgramConstant> ParamTraits<ProgramConstant>::parse(const Value& value,
                                                                   ValueReader& reader) {
    if (value.kind == Value::Kind::list) {
        const auto vector = ParamTraits<Vec3>::parse(value, reader);
        return vector ? std::optional<ProgramConstant>(*vector) : std::nullopt;
    }
    if (value.kind != Value::Kind::scalar)
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    const auto number = ParamTraits<float>::parse(value, reader);
    return number ? std::optional<ProgramConstant>(static_cast<double>(*number)) : std::nullopt;
}

std::string ParamTraits<ProgramConstant>::text(const ProgramConstant& value) {
    const auto* const number = std::get_if<double>(&value);
    return number ? ParamTraits<double>::text(*number)
                  : ParamTraits<Vec3>::text(std::get<Vec3>(value));
}

}  // namespace fluidcarve
