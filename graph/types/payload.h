#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <typeindex>

namespace fluidcarve {

/// Data on an edge: shared and never changed after it was made. A node that edits makes a copy.
template <class T>
using Ref = std::shared_ptr<const T>;

/// Type-erased Ref, as the runtime carries it.
class Payload {
public:
    Payload() = default;
    template <class T>
    explicit Payload(std::shared_ptr<T> data) : data_(std::move(data)), type_(typeid(std::remove_const_t<T>)) {}

    explicit operator bool() const { return data_ != nullptr; }
    std::type_index type() const { return type_; }

    /// The data as T, which must be the type that it was made from.
    template <class T>
    Ref<T> as() const {
        return std::static_pointer_cast<const T>(data_);
    }
    const void* get() const { return data_.get(); }

private:
    std::shared_ptr<const void> data_;
    std::type_index type_ = typeid(void);
};

/// What the framework knows of a type that may travel; registered like a node type (Registry::add).
struct PayloadType {
    std::string name;  ///< as YAML, messages and docs call it: `float`, `volume`, `lattice`
    std::string doc;
    std::type_index type = typeid(void);
    std::function<std::uint64_t(const Payload&)> bytes;  ///< memory held, for the report

    int version = 0;  ///< of what `write` writes
    /// How a value goes to a file and comes back, to the last bit; empty: it can't be kept.
    std::function<void(const Payload&, std::ostream&)> write;
    std::function<Payload(std::istream&)> read;  ///< throws Failure where `write` has not written that
};

/// How values of a type go to a file and come back.
template <class T>
struct Filed {
    int version = 1;  ///< raise it whenever `write` changes
    std::function<void(const T&, std::ostream&)> write;
    std::function<Ref<T>(std::istream&)> read;
};

/// @param bytes  memory held by a value of the type
/// @param filed  left out: values can't be kept in files
template <class T>
PayloadType payload_type(std::string name, std::string doc, std::function<std::uint64_t(const T&)> bytes, Filed<T> filed = {}) {
    PayloadType out{std::move(name), std::move(doc), typeid(T), [bytes = std::move(bytes)](const Payload& payload) { return bytes(*payload.as<T>()); },
                    filed.version,   nullptr,        nullptr};
    if (!filed.write) return out;
    out.write = [write = std::move(filed.write)](const Payload& payload, std::ostream& to) { write(*payload.as<T>(), to); };
    out.read = [read = std::move(filed.read)](std::istream& from) { return Payload(read(from)); };
    return out;
}

/// An input of type `to` also takes payloads of type `from`.
struct Conversion {
    std::type_index from = typeid(void);
    std::type_index to = typeid(void);
    std::function<Payload(const Payload&)> convert;
};

template <class From, class To>
Conversion conversion(std::function<Ref<To>(const Ref<From>&)> convert) {
    return {typeid(From), typeid(To), [convert = std::move(convert)](const Payload& payload) { return Payload(convert(payload.as<From>())); }};
}

}  // namespace fluidcarve
