#pragma once

#include "tests/fuzz/sources.h"

#include <string>

namespace fuzz {

/// Writes the files of tests/fuzz/corpus: each has one fault that once harmed a reader, or would.
/// Equal but for numbers that compilers and codecs may round otherwise.
/// @throws std::runtime_error if a file can't be written
void write_corpus(const std::string& folder, const Sources& sources);

}  // namespace fuzz
