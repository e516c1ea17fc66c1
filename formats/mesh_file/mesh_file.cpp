#include "formats/mesh_file/mesh_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/mesh_file/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string_view>

namespace fluidcarve {
namespace {

/// A mesh format: its extension and functions.
struct Format {
    std::string_view ending;
    Mesh (*read)(FileText&, Losses&);
    void (*probe)(FileText&);
    std::string (*text)(const Mesh&, const std::vector<openvdb::Vec3d>&, Losses&);
};
constexpr std::array formats = {Format{".obj", read_obj, [](FileText&) {}, obj_text},
                                Format{".ply", read_ply, probe_ply, ply_text},
                                Format{".off", read_off, probe_off, off_text},
                                Format{".stl", read_stl, probe_stl, stl_text}};

const Format& format_of(const std::string& path) {
    const auto fault = ending_fault(path);
    if (!fault.empty()) throw Failure(fault, Failure::Kind::input);
    return *std::ranges::find_if(
        formats, [ending = ending_of(path)](const Format& each) { return each.ending == ending; });
}

/// Where comments go in the text of a file: before all in OBJ, behind the format in PLY; nothing if
/// the format has none.
std::optional<std::size_t> comments_at(const std::string& path, const std::string& text) {
    if (ending_of(path) == ".obj") return 0;
    if (ending_of(path) == ".ply") return text.find('\n', text.find('\n') + 1) + 1;
    return std::nullopt;
}

/// @param most  reads only so many bytes from the beginning
FileText text_of_mesh(const std::string& path, std::size_t most = FileText::all) {
    FileText out(InputFile(path, {.what = "a mesh"}), most);
    if (out.left() == 0) out.fault_in_all("the file is empty");
    return out;
}

}  // namespace

std::vector<std::string> all_mesh_endings() {
    std::vector<std::string> out;
    for (const auto& format : formats) out.emplace_back(format.ending);
    return out;
}

std::string ending_fault(const std::string& path) {
    const auto ending = ending_of(path);
    if (std::ranges::any_of(formats, [&](const Format& each) { return each.ending == ending; }))
        return {};
    return fmt::format("{}: a mesh is a {} file, not '{}'", path, either(all_mesh_endings()),
                       ending);
}

MeshFile read_mesh(const std::string& path) {
    const auto& format = format_of(path);
    auto file = text_of_mesh(path);
    MeshFile out;
    out.mesh = format.read(file, out.losses);
    return out;
}

void probe_mesh(const std::string& path) {
    constexpr std::size_t most_heads = 1 << 16;
    const auto& format = format_of(path);
    auto head = text_of_mesh(path, most_heads);
    try {
        format.probe(head);
    } catch (const Failure&) {
        if (!head.ran_out()) throw;
        auto file = text_of_mesh(path);
        format.probe(file);
    }
}

std::vector<std::string> write_mesh(const std::string& path, const Mesh& mesh,
                                    const Placement* placement, const Provenance& provenance) {
    Losses losses;
    const auto text = format_of(path).text(mesh, unplaced(mesh, placement), losses);
    OutputFile output(path);
    std::ofstream out(output.aside(), std::ios::binary);
    const auto at = comments_at(path, text);
    out << std::string_view(text).substr(0, at.value_or(0));
    if (at)
        for (const auto& line :
             provenance_comments(provenance, *at == 0 ? hash_comment : ply_comment))
            out << line << '\n';
    out << std::string_view(text).substr(at.value_or(0));
    output.commit(out);
    return losses;
}

void require_vertices(const FileText& file, const Mesh& mesh) {
    const auto found = std::ranges::find_if(
        mesh.corners, [&](std::uint32_t vertex) { return vertex >= mesh.points.size(); });
    if (found == mesh.corners.end()) return;
    const auto corner = static_cast<std::size_t>(found - mesh.corners.begin());
    const auto face = std::ranges::upper_bound(mesh.ends, corner) - mesh.ends.begin();
    file.fault_in_all(fmt::format("face {} has a vertex {}, but there are {} (both counted from 0)",
                                  face, *found, mesh.points.size()));
}

std::string to_text(const Mesh::Attribute& attribute) {
    if (attribute.name == "uv") return "UVs";
    if (attribute.name == "normal" || attribute.name == "colour") return attribute.name + "s";
    return fmt::format("'{}'", attribute.name);
}

std::string to_text(Mesh::Attribute::On on) {
    using On = Mesh::Attribute::On;
    return on == On::vertices ? "vertices" : on == On::faces ? "faces" : "corners";
}

void lose(Losses& losses, const Mesh::Attribute& attribute, const std::string& why) {
    losses.push_back(fmt::format("{} of {} are not written: {}", to_text(attribute),
                                 to_text(attribute.on), why));
}

const std::vector<Mesh::Line>& lines_for(const Mesh& mesh, const std::string& format,
                                         Losses& losses) {
    static const std::vector<Mesh::Line> none;
    if (!mesh.stored) return none;
    const auto& lines = mesh.stored->lines;
    if (mesh.stored->format == format) return lines;
    // Only lines of OBJ files hold more than comments.
    const auto says = [](const Mesh::Line& line) {
        const auto begin = line.text.find_first_not_of(" \t");
        return begin != std::string::npos && line.text[begin] != '#';
    };
    if (mesh.stored->format == "obj" && std::ranges::any_of(lines, says))
        losses.push_back(
            fmt::format("groups, materials, lines and the like of the .obj file are not written: "
                        ".{} holds none",
                        format));
    return none;
}

}  // namespace fluidcarve
