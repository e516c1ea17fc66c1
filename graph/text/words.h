#pragma once

#include <cstdint>
#include <string>

namespace fluidcarve {

/// A number for people, rounded to three significant digits; whole from 100 on.
std::string three_digits(double value);
/// "12.3 ms", "4.56 s", "7.89 min", "1.23 h".
std::string duration_text(double seconds);
/// "512 B", "12.3 kB", "4.56 MB", "7.89 GB", in steps of 1000.
std::string size_text(std::uint64_t bytes);

}  // namespace fluidcarve
