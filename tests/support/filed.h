#pragma once

#include "carve/base/failure.h"
#include "graph/types/registry.h"
#include "nodes/catalogue.h"

#include <catch2/catch.hpp>

#include <sstream>
#include <string>
#include <vector>

namespace fluidcarve::test {

inline const Registry& builtin() {
    static const auto out = builtin_registry();
    return out;
}

/// What a value of a payload type is in a file.
template <class T>
std::string filed(const Ref<T>& value) {
    std::ostringstream out;
    builtin().payload(typeid(T)).write(Payload(value), out);
    CHECK(out.good());
    return out.str();
}

template <class T>
Ref<T> read_back(const std::string& bytes) {
    std::istringstream in(bytes);
    return builtin().payload(typeid(T)).read(in).template as<T>();
}

/// A value that went to a stream and came back, with another behind it, which the reader leaves
/// alone.
template <class T>
Ref<T> there_and_back(const Ref<T>& value) {
    const auto bytes = filed(value);
    std::istringstream in(bytes + "what follows");
    auto out = builtin().payload(typeid(T)).read(in).template as<T>();
    std::string rest;
    std::getline(in, rest);
    CHECK(rest == "what follows");
    CHECK(filed(out) == bytes);
    return out;
}

/// A stream that ends too early, after any number of bytes or, if that would be many, some.
/// @param all  below so many bytes, any
template <class T>
void require_cut_refused(const Ref<T>& value, std::size_t all = 2000) {
    const auto whole = filed(value);
    REQUIRE(read_back<T>(whole));
    for (std::size_t size = 0; size < whole.size();
         size += size < all || size + 20 > whole.size() ? 1 : 1 + whole.size() / 100) {
        INFO(size << " of " << whole.size());
        CHECK_THROWS_AS(read_back<T>(whole.substr(0, size)), Failure);
    }
}

/// Any byte, or one of `step`, may be another: then a reader gives some value, or refuses.
template <class T>
void require_damage_survived(const Ref<T>& value, std::size_t step = 1) {
    const auto whole = filed(value);
    for (std::size_t at = 0; at < whole.size(); at += step)
        for (const char byte : {'\0', '\x7f', '\xff'}) {
            auto damaged = whole;
            damaged[at] = byte;
            try {
                read_back<T>(damaged);
            } catch (const Failure&) {}
        }
}

}  // namespace fluidcarve::test
