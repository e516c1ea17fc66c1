#include "carve/base/failure.h"
#include "carve/lattice/lattice.h"
#include "carve/rig/rig.h"
#include "carve/seam/seams.h"
#include "carve/stream/binary.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/points_file.h"
#include "tests/support/filed.h"
#include "tests/support/point_lists.h"
#include "tests/support/scratch.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Vec3d;

namespace {

const std::string data = TEST_DATA;

/// Whether two lists hold the same bits: NaN is itself, -0 is not 0.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

Ref<Lattice> bent_lattice() {
    auto out = turned(make_box(Vec3d(0.1, -0.2, 0.3), {7, 5, 4}, 1.0 / 3, {0, 1, 2}), 0.7);
    out.closed = true;
    out.around = true;
    out.closed_form = true;
    out.planes[1].u[2] = -0.0;
    out.planes[2].w[0] = std::numeric_limits<double>::denorm_min();
    out.description = "around a ring";
    out.hash = lattice_hash(out);
    return std::make_shared<Lattice>(out);
}

Ref<Seams> paired_seams(const std::string& folder) {
    auto out = wavy_seams(*bent_lattice(), Axis::v, Seams::Kind::insert, 2, 3, 0.6);
    out.frames = {-3, 11, 40};
    for (auto* window : {&out.seams, &out.pairs}) {
        window->resize(3);
        for (std::size_t n = 0; n < 3; ++n) {
            std::vector<std::uint16_t> entries(out.columns_per_frame() * out.frames.size());
            for (std::size_t c = 0; c < entries.size(); ++c)
                entries[c] =
                    static_cast<std::uint16_t>(31 * c + n + (window == &out.pairs ? 40000 : 0));
            (*window)[n] = {n == 1 ? SeamEntries::in_file(entries, folder) : SeamEntries(entries),
                            1.0 / (3 + static_cast<double>(n))};
        }
    }
    out.seams[1].lower_bound = 0.1;
    out.seams[2].lower_bound = 0.0;
    return std::make_shared<Seams>(out);
}

Ref<Rig> oval() {
    auto out =
        oval_rig({{0.1, 0.2, 0.3}, {1.0 / 3, 0, -0.0}, {0, 2.0 / 3, 0.1}, 0.7}, {0, 0.6, 0.8});
    return std::make_shared<Rig>(out);
}

Ref<Mesh> mesh(const std::string& path, const Placement& placement) {
    return std::make_shared<Mesh>(placed(read_mesh(path).mesh, placement));
}

const std::string two_faces_obj =
    "# made by hand\no bank\nv 0.1 0.2 0.30000000000000004\nv 1 0 1e-05\nv 1.5 1 0\nv 0 1 0\nv 2.5 "
    "0.5 -0.123456789012345\nv 7 8 9\n"
    "vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\nvt 0.6 0\nvn 0 0 1\nvn 0 0.6 0.8\ng shore\nusemtl sand\ns "
    "off\nf 1/1/1 2/2/1 3/3/1 4/4/1\n"
    "usemtl gr\xe4ss\nf 2/5/2 5/3/2 3//2\nl 1 6\n";

const std::string two_faces_ply =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty "
    "double y\nproperty double z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nproperty float heat\nelement face 2\nproperty list "
    "uchar int vertex_indices\nproperty short kind\nend_header\n"
    "0.1 0 0 255 0 1 0.5\n1 0 0 0 7 1 1.5\n1 1 0.3 9 0 1 -2\n0 1 0 0 0 1 0.25\n3 0 1 2 -4\n3 0 2 3 "
    "5\n";

void require_same(const Mesh& a, const Mesh& b) {
    CHECK(same_bits(a.points, b.points));
    CHECK(a.corners == b.corners);
    CHECK(a.ends == b.ends);
    REQUIRE(a.attributes.size() == b.attributes.size());
    for (std::size_t n = 0; n < a.attributes.size(); ++n) {
        const auto &x = a.attributes[n], &y = b.attributes[n];
        CHECK(x.name == y.name);
        CHECK(x.on == y.on);
        CHECK(x.parts == y.parts);
        CHECK(x.type == y.type);
        CHECK(same_bits(x.values, y.values));
        CHECK(x.at == y.at);
    }
    REQUIRE((a.stored == nullptr) == (b.stored == nullptr));
    if (!a.stored) return;
    const auto &x = *a.stored, &y = *b.stored;
    CHECK(x.format == y.format);
    CHECK(x.binary == y.binary);
    CHECK(x.big_endian == y.big_endian);
    CHECK(x.number == y.number);
    REQUIRE(x.lines.size() == y.lines.size());
    for (std::size_t n = 0; n < x.lines.size(); ++n) {
        CHECK(x.lines[n].face == y.lines[n].face);
        CHECK(x.lines[n].text == y.lines[n].text);
    }
    CHECK(x.head == y.head);
    CHECK(x.placement == y.placement);
    CHECK(same_bits(x.in_file, y.in_file));
}

}  // namespace

TEST_CASE("a value of every payload type can go to a file") {
    std::vector<std::string> lacking;
    for (const auto& type : builtin().payloads())
        if (!type.write || !type.read || type.version < 1) lacking.push_back(type.name);
    CHECK(lacking == std::vector<std::string>{});
}

TEST_CASE("numbers, texts and lists come back as they were written") {
    std::stringstream stream;
    BinaryWriter out(stream);
    out.value(std::uint32_t{0x01020304});
    CHECK(stream.str() == "\x04\x03\x02\x01");
    const std::vector<std::uint16_t> long_list(3'000'000, 7);
    out.value(true);
    out.value(NumberType::uint16);
    out.text(std::string("a\0b", 3));
    out.list(long_list);
    out.list(std::vector<std::string>{"", "one"});
    out.optional(std::optional<double>(-0.0));
    out.optional(std::optional<double>());
    BinaryReader in(stream);
    CHECK(in.value<std::uint32_t>() == 0x01020304);
    CHECK(in.value<bool>());
    CHECK(in.value_up_to(NumberType::float64) == NumberType::uint16);
    CHECK(in.text() == std::string("a\0b", 3));
    CHECK(in.list<std::uint16_t>() == long_list);
    CHECK(in.texts() == std::vector<std::string>{"", "one"});
    const auto zero = in.optional<double>();
    CHECK((zero && *zero == 0 && std::signbit(*zero)));
    CHECK_FALSE(in.optional<double>());
    CHECK_THROWS_AS(in.value<char>(), Failure);
}

TEST_CASE("a size that the stream can't hold is refused before there is room made for it") {
    for (const std::uint64_t size : {std::uint64_t{5}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
        std::stringstream stream;
        BinaryWriter out(stream);
        out.value(size);
        out.value(std::uint32_t{1});
        const auto bytes = stream.str();
        const auto refused = [&](auto read) {
            std::istringstream from(bytes);
            BinaryReader in(from);
            CHECK_THROWS_AS(read(in), Failure);
        };
        refused([](BinaryReader& in) { return in.text(); });
        refused([](BinaryReader& in) { return in.list<double>(); });
        refused([](BinaryReader& in) { return in.texts(); });
    }
    std::istringstream from("\x02");
    BinaryReader in(from);
    CHECK_THROWS_AS(in.value<bool>(), Failure);
    std::istringstream beyond(std::string("\x08\0\0\0", 4));
    BinaryReader second(beyond);
    CHECK_THROWS_AS(second.value_up_to(NumberType::float64), Failure);
}

TEST_CASE("rigs come back from a file") {
    for (const auto& rig : {oval(), Ref<Rig>(std::make_shared<Rig>(Rig{
                                        {{0.1, -0.0, 1e-300}, {4, 5, 6}}, true, {0, 1, 0}, {}}))}) {
        const auto back = there_and_back(rig);
        CHECK(same_bits(back->points, rig->points));
        CHECK(back->closed == rig->closed);
        CHECK(back->up == rig->up);
        REQUIRE(back->oval.has_value() == rig->oval.has_value());
        if (rig->oval) CHECK(std::memcmp(&*back->oval, &*rig->oval, sizeof(Rig::Oval)) == 0);
    }
}

TEST_CASE("lattices come back from a file to the last bit, with their hash") {
    const auto lattice = bent_lattice();
    const auto back = there_and_back(lattice);
    CHECK(back->shape == lattice->shape);
    CHECK(back->spacing == lattice->spacing);
    CHECK(back->closed);
    CHECK(back->around);
    CHECK(back->closed_form);
    CHECK(same_bits(back->planes, lattice->planes));
    CHECK(back->description == lattice->description);
    CHECK(back->hash == lattice->hash);
    CHECK(lattice_hash(*back) == lattice->hash);
    const auto box = there_and_back<Lattice>(
        std::make_shared<Lattice>(make_box(Vec3d(0), {3, 2, 1}, 0.5, {0, 1, 2})));
    CHECK_FALSE(box->closed);
    CHECK_FALSE(box->around);
    CHECK_FALSE(box->closed_form);
}

TEST_CASE("seams come back from a file: pairs, bounds, frames, entries in memory or mapped") {
    const Scratch scratch;
    const auto seams = paired_seams(scratch.path());
    REQUIRE(seams->seams[1].at.on_disk());
    const auto back = there_and_back(seams);
    CHECK(back->axis == Axis::v);
    CHECK(back->kind == Seams::Kind::insert);
    CHECK(back->closed == seams->closed);
    CHECK(back->around == seams->around);
    CHECK(back->shape == seams->shape);
    CHECK(back->frames == seams->frames);
    CHECK(back->lattice == seams->lattice);
    CHECK(back->lattice_hash == seams->lattice_hash);
    for (const auto window : {&Seams::seams, &Seams::pairs}) {
        const auto &a = *seams.*window, &b = *back.*window;
        REQUIRE(b.size() == 3);
        for (std::size_t n = 0; n < 3; ++n) {
            CHECK(a[n].at == b[n].at);
            CHECK(a[n].energy == b[n].energy);
            CHECK(a[n].lower_bound == b[n].lower_bound);
        }
    }
    // Two bytes an entry, and little beside them.
    CHECK(filed(seams).size() < 6 * 2 * seams->seams[0].at.size() + 400);
}

TEST_CASE("meshes come back from a file, and a writer gives the same file from them") {
    const Scratch scratch;
    const Placement moved{{0.1, -2, 3}, 0.3, Vec3d(0)};
    for (const auto& path :
         {scratch.write("two.obj", two_faces_obj), scratch.write("two.ply", two_faces_ply),
          data + "/river/riverbank.obj"})
        for (const auto& placement : {Placement{}, moved}) {
            INFO(path);
            const auto before = mesh(path, placement);
            const auto back = there_and_back(before);
            require_same(*before, *back);
            const auto ending = path.substr(path.size() - 4);
            write_mesh(scratch / ("before" + ending), *before);
            write_mesh(scratch / ("after" + ending), *back);
            CHECK(Scratch::read(scratch / ("before" + ending)) ==
                  Scratch::read(scratch / ("after" + ending)));
        }
    auto made = *mesh(scratch / "two.obj", {});
    made.stored = nullptr;
    require_same(made, *there_and_back<Mesh>(std::make_shared<Mesh>(made)));
}

TEST_CASE("vertices of a PLY file come back from a file") {
    const Scratch scratch;
    auto points = points_at({{0.1, 0.2, 0.3}, {-4, 5, 1e-300}});
    points.placement = {{1, 2, 3}, 0.3, Vec3d(0)};
    auto ply = *points.ply;
    ply.encoding = NumberForm::big;
    ply.comments = {"comment by hand", "obj_info shot 7"};
    ply.empty_elements = {"element face 0", "property list uchar int vertex_indices"};
    ply.columns.push_back(
        column("heat", "float32", NumberType::float32,
               std::vector<float>{-0.0f, std::numeric_limits<float>::quiet_NaN()}));
    points.ply = std::make_shared<PointTable>(ply);
    const auto before = std::make_shared<const Points>(points);
    const auto back = there_and_back(before);
    CHECK_FALSE(back->grid);
    CHECK(back->placement == before->placement);
    CHECK(back->positions() == before->positions());
    write_points(scratch / "before.ply", *before, nullptr, nullptr, nullptr);
    write_points(scratch / "after.ply", *back, nullptr, nullptr, nullptr);
    CHECK(Scratch::read(scratch / "before.ply") == Scratch::read(scratch / "after.ply"));
    CHECK(Scratch::read(scratch / "before.ply").find("obj_info shot 7") != std::string::npos);
}

TEST_CASE(
    "what is cut off or damaged is refused or read, never a crash: rigs, lattices, seams, meshes, "
    "vertices") {
    const Scratch scratch;
    const auto points = std::make_shared<const Points>(points_at({{0.1, 0.2, 0.3}, {-4, 5, 6}}));
    require_cut_refused(oval());
    require_cut_refused(bent_lattice());
    require_cut_refused(paired_seams(scratch.path()));
    require_cut_refused(mesh(scratch.write("two.obj", two_faces_obj), {{1, 2, 3}, 2, Vec3d(0)}));
    require_cut_refused(points);
    require_damage_survived(bent_lattice());
    require_damage_survived(mesh(scratch / "two.obj", {{1, 2, 3}, 2, Vec3d(0)}));
    require_damage_survived(points);
}

TEST_CASE("kept data whose sizes contradict each other is refused") {
    const Scratch scratch;
    const auto require_refused = [](const auto& value) {
        using Value = std::remove_cvref_t<decltype(value)>;
        CHECK_THROWS_AS(read_back<Value>(filed(std::make_shared<const Value>(value))), Failure);
    };
    auto seams = *paired_seams(scratch.path());
    seams.anchor = {Anchor::At::vertex, 2};
    CHECK_NOTHROW(read_back<Seams>(filed(std::make_shared<const Seams>(seams))));
    for (const int size : {-1, 0, seams.shape[2] + 1, std::numeric_limits<int>::max()}) {
        auto other = seams;
        other.shape[2] = size;
        require_refused(other);
        other.shape = {size, size, size};
        require_refused(other);
    }
    auto short_seam = seams;
    short_seam.pairs[1].at = std::vector<std::uint16_t>{1, 2, 3};
    require_refused(short_seam);

    for (const std::size_t n : {0, 1, 2})
        for (const int size : {-1, 0, most_vertices + 1, std::numeric_limits<int>::max()}) {
            auto lattice = *bent_lattice();
            lattice.shape[n] = size;
            require_refused(lattice);
        }
    auto plane_less = *bent_lattice();
    plane_less.planes.pop_back();
    require_refused(plane_less);

    // Times the eight bytes of a number, the size is 0.
    auto points = points_at({});
    auto ply = *points.ply;
    ply.columns.resize(3);
    ply.size = std::size_t{1} << 61;
    points.ply = std::make_shared<PointTable>(ply);
    require_refused(points);
    ply.columns.clear();
    points.ply = std::make_shared<PointTable>(ply);
    require_refused(points);
}
