#pragma once

#include "carve/base/values.h"

namespace fluidcarve {

/// Writes and reads the content of a frame bit for bit. Specialise it with
///   static std::uint64_t bytes(const T&);               of memory
///   static void write(const T&, std::ostream&);
///   static Ref<T> read(std::istream&);                  Failure if the stream holds no whole one
template <class T>
struct Stored;

}  // namespace fluidcarve
