#include "formats/file/content_hash.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("hashes are written as 32 digits and read back, and anything else is no hash") {
    const auto hash = Hasher().text("a").digest();
    CHECK(hash.text().size() == 32);
    CHECK(Hash::parse(hash.text()) == hash);
    for (const auto* const text :
         {"", "0", "zz", "0123456789abcdef0123456789abcdeg", "0123456789abcdef0123456789abcdef0"})
        CHECK_FALSE(Hash::parse(text));
    CHECK(Hasher().text("ab").text("c").digest() != Hasher().text("a").text("bc").digest());
    CHECK_FALSE(Hasher().text("a").hash(Hash{}).digest());
}
