#include "formats/geometry_file/file_text.h"

#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

FileText opened(const std::string& path, std::size_t most = FileText::all) {
    return FileText(InputFile(path, {.what = "a text"}), most);
}

}  // namespace

TEST_CASE("a text is read by lines and words, with or without an end of its last line") {
    const Scratch scratch;
    auto file = opened(scratch.write("a.txt", "one two\r\n\n\tthree #four"));
    CHECK(file.line_number() == 0);
    CHECK_FALSE(file.line_ends());
    REQUIRE(file.next());
    CHECK(file.line() == "one two");
    CHECK(file.line_ends());
    CHECK(file.word() == "one");
    CHECK(file.rest_of_line() == "two");
    REQUIRE(file.next());
    REQUIRE(file.next());
    CHECK(file.line_number() == 3);
    CHECK_FALSE(file.line_ends());
    CHECK(file.word('#') == "three");
    CHECK(file.word('#').empty());
    CHECK(file.has_comments());
    CHECK_FALSE(file.next());
    CHECK_FALSE(file.ran_out());
    CHECK_THROWS_WITH(file.fault("so it is"), scratch / "a.txt" + ":3: so it is");
}

TEST_CASE("the head of a text runs out where the file goes on") {
    const Scratch scratch;
    auto head = opened(scratch.write("a.txt", "one\ntwo\n"), 6);
    CHECK(head.next());
    CHECK(head.left() == 4);
    CHECK_FALSE(head.next());
    CHECK(head.ran_out());
}

TEST_CASE("cells of a table come without quotes, comments and lines that have none") {
    const Scratch scratch;
    auto file =
        opened(scratch.write("a.csv", "# frames\n\n \"w\", amount # of it\n,;\n0.5;-2\r\n"));
    CHECK(file.next_cells() == std::vector<std::string_view>{"w", "amount"});
    CHECK(file.line_number() == 3);
    CHECK(file.next_cells() == std::vector<std::string_view>{"0.5", "-2"});
    CHECK(file.line_number() == 5);
    CHECK(file.next_cells().empty());
}

TEST_CASE("words are split at any of their separators, and are numbers only as a whole") {
    CHECK(words_of(" a\tb \r") == std::vector<std::string_view>{"a", "b"});
    CHECK(words_of("1, 2;;3", ",; ") == std::vector<std::string_view>{"1", "2", "3"});
    CHECK(words_of("").empty());
    CHECK(number_of_word<double>("+1e-1") == 0.1);
    CHECK(number_of_word<long>("-12") == -12);
    for (const auto* const none : {"", "1x", "+-1", "1.5", "99999999999999999999"})
        CHECK_FALSE(number_of_word<long>(none));
    CHECK(number_of<long>("-12") == -12);
    for (const auto* const none : {"", "+12", "12 ", "0x1"}) CHECK_FALSE(number_of<long>(none));
}
