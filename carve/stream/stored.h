#pragma once

#include "carve/base/values.h"

namespace fluidcarve {

/// How what a frame holds is written and read bit for bit. Specialised with
///   static std::uint64_t bytes(const T&);               of memory
///   static void write(const T&, std::ostream&);
///   static Ref<T> read(std::istream&);                  Failure if the stream holds no whole one
template <class T>
struct Stored;

}  // namespace fluidcarve
