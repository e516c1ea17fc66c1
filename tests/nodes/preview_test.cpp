#include "nodes/preview/sheet.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

FloatGrid::Ptr named(const std::string& name) {
    auto out = FloatGrid::create(0.0f);
    out->setName(name);
    return out;
}

/// A cube of one value, as voxels.
FloatGrid::Ptr cube(const Coord& first, int size, float value) {
    auto out = named("density");
    out->denseFill(CoordBBox(first, first.offsetBy(size - 1)), value, true);
    return out;
}

SheetPanel panel_of(const FloatGrid& grid, View view = View::y) {
    SheetPanel out;
    out.active = grid.evalActiveVoxelBoundingBox();
    if (!out.active.empty()) out.projection = maximum_projection(grid, view, out.active);
    return out;
}

/// Pixels of a colour below the sheet's header, and the rectangle that they span.
struct Found {
    int count = 0;
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};
Found find(const Canvas& canvas, Colour colour) {
    Found out;
    for (int y = 100; y < canvas.height(); ++y)
        for (int x = 0; x < canvas.width(); ++x)
            if (canvas.at(x, y) == colour) {
                ++out.count;
                out.left = std::min(out.left, x), out.right = std::max(out.right, x);
                out.top = std::min(out.top, y), out.bottom = std::max(out.bottom, y);
            }
    return out;
}

/// The node at work, as the runtime drives it.
class SheetNode {
public:
    SheetNode(const std::vector<std::pair<std::string, std::string>>& fields) : params_(type_.make_params()) {
        for (const auto& [name, text] : fields) {
            Value value;
            value.kind = Value::Kind::scalar;
            value.text = text;
            ValueReader reader(problems_, name, type_.param(name)->range);
            type_.param(name)->parse(params_.get(), value, reader);
        }
        behaviour_ = type_.bind(params_);
    }
    void add(const Volume& before, const Volume& after, Context& context) {
        const auto ports = behaviour_.make_ports();
        type_.input("before")->set(ports.get(), {Payload(std::make_shared<const Volume>(before))}, {});
        type_.input("after")->set(ports.get(), {Payload(std::make_shared<const Volume>(after))}, {});
        behaviour_.add(ports.get(), context);
    }
    void finish(Context& context) { behaviour_.finish(behaviour_.make_ports().get(), context); }
    bool wants(const Context& context) const { return behaviour_.wants(context); }
    const Problems& problems() const { return problems_; }

private:
    NodeType type_ = preview_sheet();
    Problems problems_;
    std::shared_ptr<void> params_;
    Behaviour behaviour_;
};

std::vector<std::size_t> shown_of(const std::string& count, int total) {
    const SheetNode node({{"frames", count}});
    std::vector<int> frames;
    for (int n = 0; n < total; ++n) frames.push_back(1001 + n);
    Context::Host host;
    Context context(host, frames);
    std::vector<std::size_t> out;
    for (std::size_t place = 0; place < frames.size(); ++place)
        if (node.wants(context.at(place))) out.push_back(place);
    return out;
}

using Places = std::vector<std::size_t>;

}  // namespace

TEST_CASE("a maximum projection takes the greatest active value along its axis") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    for (int x = -9; x <= 9; ++x)
        for (int y = -3; y <= 12; ++y)
            for (int z = -20; z <= 20; ++z) values.setValueOn(Coord(x, y, z), static_cast<float>(100 * x + 10 * y + z));
    values.setValueOff(Coord(9, 12, 20), 1e6f);
    const CoordBBox box(Coord(-9, -3, -20), Coord(9, 12, 20));

    const auto along_x = maximum_projection(*grid, View::x, box);
    CHECK(along_x.cell == 1);
    CHECK(along_x.cells.size(0) == 16);
    CHECK(along_x.cells.size(1) == 41);
    CHECK(along_x.at(-3, -20) == 900 - 30 - 20);
    CHECK(along_x.at(12, 20) == 800 + 120 + 20);
    const auto along_y = maximum_projection(*grid, View::y, box);
    CHECK(along_y.at(-9, 20) == -900 + 120 + 20);
    CHECK(along_y.at(4, -7) == 400 + 120 - 7);
    const auto along_z = maximum_projection(*grid, View::z, box);
    CHECK(along_z.at(-9, 12) == -900 + 120 + 20);
    CHECK(along_z.at(0, 0) == 20);

    const auto part = maximum_projection(*grid, View::z, CoordBBox(Coord(-2, 0, -5), Coord(2, 1, 3)));
    CHECK(part.cells.size(0) == 5);
    CHECK(part.at(2, 1) == 200 + 10 + 3);
}

TEST_CASE("what is not active is not seen, NaN neither") {
    const auto grid = named("density");
    auto values = grid->getAccessor();
    values.setValueOn(Coord(0, 0, 0), -2.0f);
    values.setValueOn(Coord(1, 0, 0), std::numeric_limits<float>::quiet_NaN());
    values.setValueOn(Coord(1, 1, 0), 3.0f);
    values.setValueOn(Coord(1, 2, 0), std::numeric_limits<float>::quiet_NaN());
    const auto seen = maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(2)));
    CHECK(seen.at(0, 0) == -2.0f);
    CHECK(seen.at(1, 0) == 3.0f);
    CHECK(std::isnan(seen.at(2, 0)));
    CHECK(std::isnan(seen.at(0, 1)));
}

TEST_CASE("tiles are seen without being made into voxels") {
    const auto grid = named("density");
    grid->sparseFill(CoordBBox(Coord(-128), Coord(127)), 2.0f, true);
    grid->tree().setValueOn(Coord(5, 60, 5), 7.0f);
    const auto leaves = grid->tree().leafCount();
    const auto seen = maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, -130), Coord(10, 70, 0)));
    CHECK(std::isnan(seen.at(-129, 55)));
    CHECK(seen.at(-128, 50) == 2.0f);
    CHECK(seen.at(10, 70) == 2.0f);
    CHECK(seen.at(5, 60) == 2.0f);
    CHECK(maximum_projection(*grid, View::z, CoordBBox(Coord(-130, 50, 0), Coord(10, 70, 5))).at(5, 60) == 7.0f);
    CHECK(grid->tree().leafCount() == leaves);
}

TEST_CASE("of vectors the length is projected") {
    const auto grid = VectorGrid::create();
    grid->tree().setValueOn(Coord(0, 0, 0), {0, -3, 4});
    grid->tree().setValueOn(Coord(0, 1, 0), {1, 1, 1});
    CHECK(maximum_projection(*grid, View::y, CoordBBox(Coord(0), Coord(1))).at(0, 0) == 5.0f);
}

TEST_CASE("a large box is seen through larger cells, aligned in the whole index space") {
    const auto grid = named("density");
    grid->tree().setValueOn(Coord(-65, 0, -1), 1.0f);
    grid->tree().setValueOn(Coord(63, 0, 30), 2.0f);
    grid->tree().setValueOn(Coord(62, 5, 31), 3.0f);
    const CoordBBox box(Coord(-65, 0, -1), Coord(63, 5, 31));
    const auto seen = maximum_projection(*grid, View::y, box, 64);
    REQUIRE(seen.cell == 4);
    CHECK(seen.cells.first == std::array{-17, -1});
    CHECK(seen.cells.last == std::array{15, 7});
    CHECK(seen.at(-17, -1) == 1.0f);
    CHECK(seen.at(15, 7) == 3.0f);
    CHECK(std::isnan(seen.at(0, 0)));

    const auto same = fitted(maximum_projection(*grid, View::y, box), 4, seen.cells);
    for (std::size_t n = 0; n < seen.values.size(); ++n)
        CHECK((same.values[n] == seen.values[n] || (std::isnan(same.values[n]) && std::isnan(seen.values[n]))));
}

TEST_CASE("colours grow lighter with the value, evenly enough to read in grey") {
    double last = -1;
    for (int n = 0; n <= 100; ++n) {
        const auto colour = heat(n / 100.0);
        const double light = 0.2126 * colour.red + 0.7152 * colour.green + 0.0722 * colour.blue;
        CHECK(light >= last);
        last = light;
    }
    CHECK(heat(-1) == heat(0));
    CHECK(heat(2) == heat(1));
    CHECK_FALSE(heat(0) == heat(1));
}

TEST_CASE("before and after share one range of colours and one window") {
    const auto strong = cube(Coord(0), 16, 4.0f);
    const auto weak = cube(Coord(16, 0, 8), 8, 2.0f);
    const auto sheet = draw_sheet({"density", View::y, 1}, {{1, panel_of(*strong), panel_of(*weak)}});
    const auto whole = find(sheet, heat(1));
    const auto half = find(sheet, heat(0.5));
    REQUIRE(whole.count > 0);
    REQUIRE(half.count > 0);
    const int middle = sheet.width() / 2;
    CHECK(whole.right < middle);
    CHECK(half.left > middle);
    // The window is 24 x 16 voxels: the weak cube has half the strong one's size and stands at its upper right.
    CHECK((half.right - half.left) * 2 == Approx(whole.right - whole.left).margin(4));
    CHECK(half.top == Approx(whole.top).margin(1));
    CHECK(half.bottom == Approx((whole.top + whole.bottom) / 2).margin(3));
    CHECK(half.left - middle > (whole.right - whole.left));

    const auto turned = draw_sheet({"density", View::y, 1}, {{1, panel_of(*weak), panel_of(*strong)}});
    CHECK(find(turned, heat(1)).left > middle);
    CHECK(find(turned, heat(0.5)).right < middle);
}

TEST_CASE("a frame without active voxels has an empty panel") {
    const auto sheet = draw_sheet({"flame", View::y, 1}, {{1, {}, panel_of(*cube(Coord(0), 4, 1.0f))}});
    CHECK(find(sheet, heat(1)).left > sheet.width() / 2);
    CHECK(draw_sheet({"flame", View::y, 1}, {{1, {}, {}}}).height() < 500);
}

TEST_CASE("sheets stay within a screen's width, whatever the grid's size") {
    for (const int size : {1, 7, 100, 3000}) {
        const auto grid = named("density");
        grid->tree().setValueOn(Coord(0), 1.0f);
        grid->tree().setValueOn(Coord(size - 1, 0, size / 3), 1.0f);
        const auto panel = panel_of(*grid);
        const auto sheet = draw_sheet({"density", View::y, 3}, {{1, panel, panel}, {2, panel, panel}, {3, panel, panel}});
        INFO(size << ": " << sheet.width() << " x " << sheet.height());
        CHECK(sheet.width() >= 560);
        CHECK(sheet.width() <= 1720);
        CHECK(sheet.height() <= 2000);
    }
}

TEST_CASE("the frames shown are spread from the first to the last") {
    CHECK(shown_of("3", 16) == Places{0, 8, 15});
    CHECK(shown_of("3", 3) == Places{0, 1, 2});
    CHECK(shown_of("5", 2) == Places{0, 1});
    CHECK(shown_of("2", 84) == Places{0, 83});
    CHECK(shown_of("1", 9) == Places{4});
}

TEST_CASE("the sheet node writes one PNG after the last frame") {
    const Scratch scratch;
    SheetNode node({{"path", scratch / "new/sheet.png"}, {"frames", "2"}});
    REQUIRE(node.problems().empty());
    const std::vector<int> frames{5, 6, 7};
    Context::Host host;
    Context context(host, frames);
    for (std::size_t place = 0; place < frames.size(); ++place)
        node.add({{cube(Coord(0), 8, 1.0f)}, {}, {}}, {{cube(Coord(2), 8, 1.0f)}, {}, {}}, context.at(place));
    CHECK_FALSE(std::filesystem::exists(scratch / "new/sheet.png"));
    node.finish(context);

    const auto png = Scratch::read(scratch / "new/sheet.png");
    REQUIRE(png.size() > 1000);
    CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    const auto number = [&](std::size_t at) {
        int out = 0;
        for (std::size_t n = 0; n < 4; ++n) out = out << 8 | static_cast<unsigned char>(png[at + n]);
        return out;
    };
    const auto panel = panel_of(*cube(Coord(0), 8, 1.0f));
    const auto shifted = panel_of(*cube(Coord(2), 8, 1.0f));
    const auto expected = draw_sheet({"density", View::y, 3}, {{5, panel, shifted}, {7, panel, shifted}});
    CHECK(number(16) == expected.width());
    CHECK(number(20) == expected.height());
    CHECK(std::distance(std::filesystem::directory_iterator(scratch / "new"), {}) == 1);
}

TEST_CASE("a grid that is not there or can't be shown is a failure that names what is") {
    Context context;
    const auto failure = [&](const std::string& grid, const Volume& before, const Volume& after) {
        SheetNode node({{"grid", grid}});
        try {
            node.add(before, after, context);
        } catch (const Failure& caught) {
            return std::string(caught.what());
        }
        return std::string();
    };
    const Volume volume{{cube(Coord(0), 2, 1.0f)}, {}, {}};
    const auto mask = openvdb::MaskGrid::create();
    mask->setName("density");
    CHECK(failure("densty", volume, volume) == "'before' has no grid 'densty'; did you mean 'density'?");
    CHECK(failure("density", volume, {{named("heat")}, {}, {}}) == "'after' has no grid 'density'; known: heat");
    CHECK(failure("density", {{mask}, {}, {}}, volume) == "grid 'density' of 'before' holds bool values; a sheet shows grids of floats or vectors");
    CHECK(failure("density", volume, volume).empty());
}
