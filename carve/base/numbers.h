#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace fluidcarve {

/// The number that a whole text states, without a plus sign; nothing if it states none, or one too
/// large for its type.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number out{};
    const auto* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, out);
    return error == std::errc{} && end == last ? std::optional(out) : std::nullopt;
}

/// As number_of(), but a `+` may precede the number.
template <class Number>
std::optional<Number> number_of_word(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    return number_of<Number>(word);
}

/// The type of a number in a file.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a number in a binary file.
std::size_t bytes_of(NumberType type);
bool is_floating(NumberType type);

/// Calls `visit(T{})` with the C++ type.
template <class Visit>
auto with_number_type(NumberType type, Visit&& visit) {
    switch (type) {
        case NumberType::int8: return visit(std::int8_t{});
        case NumberType::uint8: return visit(std::uint8_t{});
        case NumberType::int16: return visit(std::int16_t{});
        case NumberType::uint16: return visit(std::uint16_t{});
        case NumberType::int32: return visit(std::int32_t{});
        case NumberType::uint32: return visit(std::uint32_t{});
        case NumberType::float32: return visit(float{});
        case NumberType::float64: break;
    }
    return visit(double{});
}

/// Value of full intensity in colours of a type: the maximum of an integer, or 1.
double full_intensity(NumberType type);

/// A number as a double; exact for all types.
/// @param swap  whether the bytes are in the order opposite to this machine's
double number_in(const char* bytes, NumberType type, bool swap);
/// Appends the bytes of a number. An integer type rounds towards 0 and clamps to its range;
/// what is no number becomes 0.
void put_number(std::string& out, double number, NumberType type, bool swap);

/// Encoding of numbers in a file: text, or binary with little- or big-endian bytes.
enum class NumberForm { ascii, little, big };
/// Whether the encoding is binary, with the byte order opposite to this machine's.
bool is_swapped(NumberForm encoding);

}  // namespace fluidcarve
