#include "formats/geometry_file/ply.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using Kind = PlyStatement::Kind;

TEST_CASE("the statements of a PLY header become its elements and properties") {
    PlyHeader header;
    CHECK(header.take("format binary_big_endian 1.0").kind == Kind::format);
    CHECK(header.take("comment  two words").kind == Kind::comment);
    CHECK(header.take("obj_info 7").kind == Kind::comment);
    CHECK(header.take("element vertex 3").kind == Kind::element);
    CHECK(header.take("property float32 x").kind == Kind::property);
    header.take("element face 1");
    header.take("property list uchar int vertex_indices");
    header.take("property\tshort  material");
    CHECK(header.take("").words.empty());
    CHECK(header.take("end_header").kind == Kind::end);

    CHECK(header.encoding == NumberForm::big);
    CHECK(header.comments == std::vector<std::string>{"comment  two words", "obj_info 7"});
    REQUIRE(header.elements.size() == 2);
    const auto &vertex = header.elements[0], &face = header.elements[1];
    CHECK(vertex.name == "vertex");
    CHECK(vertex.count == 3);
    REQUIRE(vertex.properties.size() == 1);
    CHECK(vertex.properties[0].name == "x");
    CHECK(vertex.properties[0].type_name == "float32");
    CHECK(vertex.properties[0].type == NumberType::float32);
    REQUIRE(face.properties.size() == 2);
    CHECK(face.properties[0].name == "vertex_indices");
    CHECK(face.properties[0].count == NumberType::uint8);
    CHECK(face.properties[0].type == NumberType::int32);
    CHECK_FALSE(face.properties[1].count);
    CHECK(vertex.bytes(false) == 4);
    CHECK(face.bytes(false) == 1 + 2);
    CHECK(face.bytes(true) == 2 + 2);
}

TEST_CASE("what is wrong in a statement of a PLY header is its word") {
    const auto wrong = [](const std::string& line) {
        PlyHeader header;
        const auto statement = header.take(line);
        return statement.wrong ? std::string(*statement.wrong) : "nothing";
    };
    CHECK(wrong("format ascii 1.0") == "nothing");
    CHECK(wrong("format text 1.0") == "text");
    CHECK(wrong("format") == "");
    CHECK(wrong("element vertex 1152921504606846976") == "nothing");
    for (const std::string count :
         {"-1", "1.5", "18446744073709551616", "0x10", "-1152921504606846976"})
        CHECK(wrong("element vertex " + count) == count);
    CHECK(wrong("element vertex") == "");
    CHECK(wrong("property quad x") == "quad");
    CHECK(wrong("property list quad int x") == "quad");
    CHECK(wrong("property list uchar quad x") == "quad");
    PlyHeader header;
    CHECK(header.take("elephant").kind == Kind::other);
    CHECK(header.take("property float x").kind == Kind::property);
    CHECK(header.elements.empty());
}

TEST_CASE("numbers of PLY go to bytes in both orders and back, and stay within their type") {
    const auto there_and_back = [](double number, NumberType type, bool swap) {
        std::string bytes;
        put_number(bytes, number, type, swap);
        CHECK(bytes.size() == bytes_of(type));
        return number_in(bytes.data(), type, swap);
    };
    for (const bool swap : {false, true}) {
        CHECK(there_and_back(-7, NumberType::int16, swap) == -7);
        CHECK(there_and_back(4294967295.0, NumberType::uint32, swap) == 4294967295.0);
        CHECK(there_and_back(0.1, NumberType::float64, swap) == 0.1);
        CHECK(there_and_back(0.1, NumberType::float32, swap) == static_cast<double>(0.1f));
        CHECK(there_and_back(300, NumberType::uint8, swap) == 255);
        CHECK(there_and_back(-300, NumberType::int8, swap) == -128);
    }
    std::string bytes;
    put_number(bytes, 258, NumberType::uint16, is_swapped(NumberForm::big));
    put_number(bytes, 258, NumberType::uint16, is_swapped(NumberForm::little));
    CHECK(bytes == "\1\2\2\1");
}

TEST_CASE("a PLY header is written as it is read") {
    CHECK(ply_header_text(NumberForm::little, {"comment a"},
                          {"element vertex 1", "property float x"}) ==
          "ply\nformat binary_little_endian 1.0\ncomment a\nelement vertex 1\nproperty float "
          "x\nend_header\n");
}
