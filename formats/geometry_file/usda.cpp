#include "formats/geometry_file/usda.h"

#include "formats/file/output_file.h"
#include "formats/geometry_file/provenance_comments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fluidcarve {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Appends a number with only the digits needed to read it back in its type.
void put_number(std::string& out, double value, NumberType type) {
    const auto to = std::back_inserter(out);
    if (std::isnan(value)) out += "nan";
    else if (type == NumberType::float32) fmt::format_to(to, "{}", static_cast<float>(value));
    else fmt::format_to(to, "{}", value);
}

/// Appends `[(1, 2), (3, 4)]`.
void put_array(std::string& out, const std::vector<double>& values, std::size_t parts,
               NumberType type) {
    out += '[';
    for (std::size_t n = 0; n < values.size(); ++n) {
        const bool first = n % parts == 0, last = n % parts == parts - 1;
        if (n > 0) out += ", ";
        if (first && parts > 1) out += '(';
        put_number(out, values[n], type);
        if (last && parts > 1) out += ')';
    }
    out += ']';
}

/// USD's type of an element; empty if there is none.
std::string element_type(NumberType number, std::size_t parts) {
    if (parts > 4) return {};
    const std::string one = number == NumberType::float32   ? "float"
                            : number == NumberType::float64 ? "double"
                                                            : "int";
    if (number == NumberType::uint32) return parts == 1 ? "uint" : std::string();
    return parts == 1 ? one : one + std::to_string(parts);
}

}  // namespace

bool is_usd_name(std::string_view text) {
    return !text.empty() && is_letter(text.front()) &&
           std::ranges::all_of(text, [](char c) { return is_letter(c) || is_digit(c); });
}

std::string UsdNames::add(std::string_view text) {
    std::string legal(text);
    std::replace_if(
        legal.begin(), legal.end(), [](char c) { return !is_letter(c) && !is_digit(c); }, '_');
    if (legal.empty() || is_digit(legal.front())) legal.insert(0, "_");
    auto out = legal;
    for (int n = 2; !taken_.insert(out).second; ++n) out = fmt::format("{}_{}", legal, n);
    return out;
}

std::string usd_text(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') out += {'\\', c};
        else if (code < 0x20 || code == 0x7f)
            fmt::format_to(std::back_inserter(out), "\\x{:02x}", code);
        else out += c;
    }
    return out + '"';
}

std::string usd_asset(std::string_view path) {
    if (path.find('@') == std::string_view::npos) return fmt::format("@{}@", path);
    // Three @ end such a path, unless a backslash precedes them.
    std::string out(path);
    for (auto at = out.find("@@@"); at != std::string::npos; at = out.find("@@@", at + 4))
        out.insert(at, "\\");
    return fmt::format("@@@{}@@@", out);
}

UsdGeometry::UsdGeometry(std::string_view schema, std::optional<int> frame) : frame_(frame) {
    text_ = fmt::format("#usda 1.0\n(\n    defaultPrim = {}\n", usd_text(usd_geometry));
    if (frame) text_ += fmt::format("    endTimeCode = {0}\n    startTimeCode = {0}\n", *frame);
    text_ += fmt::format(")\n\ndef {} {}\n{{\n", schema, usd_text(usd_geometry));
}

void UsdGeometry::add(std::string_view statement) { text_ += fmt::format("    {}\n", statement); }

void UsdGeometry::add(const Array& array, const std::vector<double>& values) {
    names_.insert(array.name);
    const auto declared = fmt::format("    {}[] {}", array.type, array.name);
    const auto metadata =
        array.interpolation.empty()
            ? std::string()
            : fmt::format(" (\n        interpolation = {}\n    )", usd_text(array.interpolation));
    if (!frame_) {
        text_ += declared + " = ";
        put_array(text_, values, array.parts, array.number);
        text_ += metadata + "\n";
        return;
    }
    if (!metadata.empty()) text_ += declared + metadata + "\n";
    text_ += fmt::format("{}.timeSamples = {{\n        {}: ", declared, *frame_);
    put_array(text_, values, array.parts, array.number);
    text_ += ",\n    }\n";
}

bool UsdGeometry::add_primvar(std::string_view name, std::string_view interpolation,
                              std::size_t parts, NumberType number,
                              const std::vector<double>& values) {
    const auto type = element_type(number, parts);
    if (type.empty()) return false;
    std::string full;
    do full = "primvars:" + primvars_.add(name);
    while (has(full));
    add({type, full, std::string(interpolation), parts, number}, values);
    return true;
}

void UsdGeometry::add_positions(const std::vector<openvdb::Vec3d>& points,
                                const Placement* placement) {
    std::vector<double> values;
    openvdb::BBoxd box;
    for (const auto& point : points) {
        const auto at = placement ? (point - placement->translate) / placement->scale : point;
        values.insert(values.end(), {at.x(), at.y(), at.z()});
        box.expand(at);
    }
    add({"point3f", "points", {}, 3}, values);
    if (points.empty()) return;
    const auto &low = box.min(), &high = box.max();
    add({"float3", "extent", {}, 3}, {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()});
}

void write_usda(const std::string& path, std::string_view text, const Provenance& provenance) {
    OutputFile output(path);
    std::ofstream out(output.aside(), std::ios::binary);
    const auto first_line = text.find('\n') + 1;
    out << text.substr(0, first_line);
    for (const auto& line : provenance_comments(provenance, hash_comment)) out << line << '\n';
    out << text.substr(first_line);
    output.commit(out);
}

}  // namespace fluidcarve
