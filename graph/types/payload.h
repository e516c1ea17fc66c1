#pragma once

#include "carve/base/values.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <typeindex>

namespace fluidcarve {

/// A type-erased Ref, as the runtime passes it between nodes.
class Payload {
public:
    Payload() = default;
    template <class T>
    explicit Payload(std::shared_ptr<T> data)
        : data_(std::move(data)), type_(typeid(std::remove_const_t<T>)) {}

    explicit operator bool() const { return data_ != nullptr; }
    std::type_index type() const { return type_; }

    /// The data as T. T must be the type that the payload was made from.
    template <class T>
    Ref<T> as() const {
        return std::static_pointer_cast<const T>(data_);
    }
    const void* get() const { return data_.get(); }

private:
    std::shared_ptr<const void> data_;
    std::type_index type_ = typeid(void);
};

/// A type of data that nodes may exchange. Registered like a node type (Registry::add).
struct PayloadType {
    std::string name;  ///< name in YAML, messages and docs: `float`, `volume`, `lattice`
    std::string doc;
    std::type_index type = typeid(void);
    std::function<std::uint64_t(const Payload&)> bytes;  ///< bytes of memory held, for the report

    int version = 0;  ///< version of the format that `write` writes
    /// Writes a value to a file, bit for bit; empty: values can't be cached.
    std::function<void(const Payload&, std::ostream&)> write;
    /// Reads what `write` wrote; throws Failure on anything else.
    std::function<Payload(std::istream&)> read;

    /// A checksum of a value that is delivered once per run; files made with the value state it
    /// (Provenance). Empty: no checksum.
    std::function<std::string(const Payload&)> checksum;
};

/// How values of a type are written to a file and read back.
template <class T>
struct Filed {
    int version = 1;  ///< raise it whenever `write` changes its format
    std::function<void(const T&, std::ostream&)> write;
    std::function<Ref<T>(std::istream&)> read;
};

/// Makes a payload type.
/// @param bytes  bytes of memory that a value holds
/// @param filed  left out: values can't be cached
template <class T>
PayloadType payload_type(std::string name, std::string doc,
                         std::function<std::uint64_t(const T&)> bytes, Filed<T> filed = {}) {
    PayloadType out{
        std::move(name),
        std::move(doc),
        typeid(T),
        [bytes = std::move(bytes)](const Payload& payload) { return bytes(*payload.as<T>()); },
        filed.version,
        nullptr,
        nullptr,
        nullptr};
    if (!filed.write) return out;
    out.write = [write = std::move(filed.write)](const Payload& payload, std::ostream& to) {
        write(*payload.as<T>(), to);
    };
    out.read = [read = std::move(filed.read)](std::istream& from) { return Payload(read(from)); };
    return out;
}

/// A conversion between payload types: an input of type `to` also takes payloads of type `from`.
struct Conversion {
    std::type_index from = typeid(void);
    std::type_index to = typeid(void);
    std::function<Payload(const Payload&)> convert;
};

/// Access to parts of a payload by name: an input of type `to` also takes `node.part`, if the
/// node's first output is of type `from` and the node has no outputs named by a parameter
/// (Declare::outputs_from).
struct Selection {
    std::type_index from = typeid(void);
    std::type_index to = typeid(void);
    /// @throws Failure whose message continues after the node's name: "has no grid 'x'; it has
    ///   ..."
    std::function<Payload(const Payload&, const std::string& part)> pick;
};

template <class From, class To>
Selection selection(std::function<Ref<To>(const From&, const std::string& part)> pick) {
    return {typeid(From), typeid(To),
            [pick = std::move(pick)](const Payload& payload, const std::string& part) {
                return Payload(pick(*payload.as<From>(), part));
            }};
}

template <class From, class To>
Conversion conversion(std::function<Ref<To>(const Ref<From>&)> convert) {
    return {typeid(From), typeid(To), [convert = std::move(convert)](const Payload& payload) {
                return Payload(convert(payload.as<From>()));
            }};
}

}  // namespace fluidcarve
