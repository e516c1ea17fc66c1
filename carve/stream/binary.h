#pragma once

#include "carve/base/failure.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace fluidcarve {

static_assert(std::endian::native == std::endian::little,
              "files hold numbers in the order of their bytes that this machine has");

/// Types written as their bytes in memory: numbers, enumerations, and structs of these without
/// padding.
template <class T>
concept Plain = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

/// Writes values to a stream, little-endian, without names or tags: a reader must read the same
/// types in the same order. The owner of the stream must check it for errors.
class BinaryWriter {
public:
    explicit BinaryWriter(std::ostream& out) : out_(out) {}

    template <Plain T>
    void value(const T& value) {
        bytes(&value, sizeof value);
    }
    /// Writes the number of characters (64 bits), then the characters.
    void text(std::string_view text) { list(std::span(text)); }
    /// Writes the number of values (64 bits), then the values.
    template <Plain T>
    void list(std::span<const T> values) {
        value(std::uint64_t{values.size()});
        bytes(values.data(), values.size_bytes());
    }
    template <Plain T>
    void list(const std::vector<T>& values) {
        list(std::span<const T>(values));
    }
    void list(const std::vector<std::string>& texts) {
        value(std::uint64_t{texts.size()});
        for (const auto& each : texts) text(each);
    }
    /// Writes whether there is a value, then the value.
    template <Plain T>
    void optional(const std::optional<T>& held) {
        value(held.has_value());
        if (held) value(*held);
    }
    /// Writes the bytes alone, without their number.
    void bytes(const void* data, std::size_t size) {
        out_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    }
    std::ostream& stream() { return out_; }

private:
    std::ostream& out_;
};

/// Reads what a BinaryWriter wrote. It never allocates much more memory than the stream holds
/// bytes, even if stated sizes are wrong. All functions throw Failure if the stream ends too early
/// or holds invalid data.
class BinaryReader {
public:
    explicit BinaryReader(std::istream& in) : in_(in) {}

    template <Plain T>
    T value() {
        if constexpr (std::is_same_v<T, bool>) {
            const auto byte = value<std::uint8_t>();
            require(byte <= 1);
            return byte == 1;
        } else {
            T out;
            bytes(&out, sizeof out);
            return out;
        }
    }
    /// A value of an enumeration that counts from 0. @param last  its greatest value
    template <class E>
    requires std::is_enum_v<E> E value_up_to(E last) {
        using Number = std::make_unsigned_t<std::underlying_type_t<E>>;
        const auto out = value<Number>();
        require(out <= static_cast<Number>(last));
        return static_cast<E>(out);
    }
    std::string text() { return sequence<std::string>(); }
    template <Plain T>
    std::vector<T> list() {
        static_assert(!std::is_same_v<T, bool>);
        return sequence<std::vector<T>>();
    }
    std::vector<std::string> texts() {
        std::vector<std::string> out;
        for (auto left = value<std::uint64_t>(); left > 0; --left) out.push_back(text());
        return out;
    }
    template <Plain T>
    std::optional<T> optional() {
        if (!value<bool>()) return std::nullopt;
        return value<T>();
    }
    void bytes(void* data, std::size_t size) {
        in_.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
        require(static_cast<std::size_t>(in_.gcount()) == size);
    }
    /// @throws Failure unless `sound`
    static void require(bool sound) {
        if (!sound) throw Failure("kept data is damaged or cut off");
    }
    std::istream& stream() { return in_; }

private:
    /// Reads in steps, each at most as large as all before, so that a wrong size fails at the end
    /// of the stream before it takes memory.
    template <class List>
    List sequence() {
        constexpr std::uint64_t first = std::max<std::uint64_t>(
            1, (std::uint64_t{1} << 20) / sizeof(typename List::value_type));
        List out;
        for (auto left = value<std::uint64_t>(); left > 0;) {
            const auto step = std::min(left, std::max<std::uint64_t>(first, out.size()));
            const auto at = out.size();
            out.resize(at + step);
            bytes(out.data() + at, step * sizeof(typename List::value_type));
            left -= step;
        }
        return out;
    }

    std::istream& in_;
};

}  // namespace fluidcarve
