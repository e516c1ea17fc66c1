#include "carve/base/one_line.h"

#include <catch2/catch.hpp>

#include <string>

using fluidcarve::cut_short;

TEST_CASE("a text for a message is cut after 60 bytes, but not inside a character") {
    const std::string full(60, 'a');
    CHECK(cut_short(full) == full);
    CHECK(cut_short(full + "a") == full + "...");
    CHECK(cut_short(full + "\u00e9") == full + "...");
    const std::string most(58, 'a');
    CHECK(cut_short(most + "\u00e9s") == most + "\u00e9...");
    CHECK(cut_short(most + "a\u00e9") == most + "a...");
    CHECK(cut_short(most + "\U0001f525") == most + "...");
    CHECK(cut_short(most.substr(1) + "\U0001f525") == most.substr(1) + "...");
    const std::string no_character(60, '\x80');
    CHECK(cut_short(no_character + '\x80') == no_character + "...");
}
