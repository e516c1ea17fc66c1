#include "tests/support/files/usda.h"
#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <filesystem>

using fluidcarve::test::UsdaReader;
using Texts = std::vector<std::string>;

namespace {

namespace fs = std::filesystem;

/// A shot of a plume, a mesh and points, written as it was read, and the stage that holds it
/// together.
std::string shot(const Scratch& scratch, const std::string& out) {
    for (int frame = 51; frame <= 53; ++frame) {
        const auto number = std::to_string(frame);
        scratch.write("m.00" + number + ".obj",
                      "v " + number + " 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n");
        scratch.write("p.00" + number + ".ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
                      "y\nproperty float z\n"
                      "property float radius\nend_header\n1 2 " +
                          number + " 0.5\n");
    }
    const auto at = [&](const std::string& name) { return "path: " + (scratch / name) + "}\n"; };
    return scratch.write(
        "shot.yaml",
        "fluidcarve: 1\nframes: 51-53\nnodes:\n"
        "  sim: {type: vdb.read, translate: [1, 2, 3], scale: 2, path: " TEST_DATA
        "/plume/plume.####.vdb}\n"
        "  mesh: {type: mesh.read, " +
            at("m.####.obj") + "  points: {type: points.read, " + at("p.####.ply") +
            "  smoke: {type: vdb.write, source: sim, " + at(out + "/vdb/smoke.####.vdb") +
            "  bank: {type: mesh.write, source: mesh, " + at(out + "/geo/bank.####.usda") +
            "  drops: {type: points.write, source: points, " + at(out + "/geo/drops.####.usda") +
            "  stage: {type: usd.write, volumes: {smoke: sim}, files: {smoke: " +
            (scratch / (out + "/vdb/smoke.####.vdb")) +
            ", bank: " + (scratch / (out + "/geo/bank.####.usda")) +
            ", drops: " + (scratch / (out + "/geo/drops.####.usda")) + "}, fps: 25, up: y, " +
            at(out + "/shot.usda"));
}

}  // namespace

TEST_CASE(
    "a shot of volumes, meshes and points is one USD stage, and the same from any chunk of its "
    "frames") {
    const Scratch scratch;
    const auto run = [&](const std::string& out, const std::string& more) {
        const auto ran = fluidcarve_program("run -q --progress none " + shot(scratch, out) + more);
        CHECK(ran.err == "");
        CHECK(ran.code == 0);
        return Scratch::read(scratch / (out + "/shot.usda"));
    };
    const auto text = run("whole", " --sync");
    CHECK(run("chunk", " -f 53") == text);
    CHECK(fs::exists(scratch / "chunk/vdb/smoke.0053.vdb"));
    CHECK(!fs::exists(scratch / "chunk/vdb/smoke.0052.vdb"));

    const auto file = UsdaReader::read(text);
    CHECK(file.metadata.at("startTimeCode").text == "51");
    CHECK(file.metadata.at("endTimeCode").text == "53");
    CHECK(file.metadata.at("timeCodesPerSecond").text == "25");
    CHECK(file.metadata.at("upAxis").text == "Y");
    const auto& stage = file.prim(file.metadata.at("defaultPrim").text);
    REQUIRE(stage.prims.size() == 3);

    const auto& smoke = stage.prim("smoke");
    CHECK(smoke.type == "Volume");
    CHECK(smoke.properties.at("double3 xformOp:translate").texts() == Texts{"1", "2", "3"});
    CHECK(smoke.properties.at("double3 xformOp:scale").texts() == Texts{"2", "2", "2"});
    Texts grids;
    for (const auto& field : smoke.prims) {
        grids.push_back(field.properties.at("token fieldName").text);
        CHECK(field.type == "OpenVDBAsset");
        CHECK(smoke.properties.at("rel field:" + field.name).text == "/shot/smoke/" + field.name);
        const auto& samples = field.properties.at("asset filePath.timeSamples").samples;
        REQUIRE(samples.size() == 3);
        for (std::size_t n = 0; n < 3; ++n) {
            CHECK(samples[n].first == 51 + static_cast<int>(n));
            CHECK(samples[n].second.text ==
                  "./vdb/smoke.00" + std::to_string(samples[n].first) + ".vdb");
            CHECK(fs::exists(scratch / ("whole/" + samples[n].second.text)));
        }
    }
    CHECK(grids == Texts{"velocity", "density", "shadow", "temperature", "flame"});
    CHECK(smoke.prim("velocity").properties.at("token fieldDataType").text == "half3");
    CHECK(smoke.prim("velocity").properties.at("token fieldClass").text == "staggered");
    CHECK(smoke.prim("density").properties.at("token fieldDataType").text == "half");

    for (const std::string name : {"bank", "drops"}) {
        const auto& metadata = stage.prim(name).metadata;
        const auto& clips = metadata.at("clips").entries.at("dictionary default").entries;
        Texts files;
        for (const auto* const number : {"51", "52", "53"})
            files.push_back("./geo/" + name + ".00" + number + ".usda");
        CHECK(metadata.at("prepend references").text == files[1]);
        CHECK(clips.at("asset manifestAssetPath").text == files[1]);
        CHECK(clips.at("asset[] assetPaths").texts() == files);
        CHECK(clips.at("double2[] active").items.at(2).texts() == Texts{"53", "2"});
        for (std::size_t n = 0; n < 3; ++n) {
            const auto clip = UsdaReader::read(Scratch::read(scratch / ("whole/" + files[n])));
            CHECK("/" + clip.metadata.at("defaultPrim").text == clips.at("string primPath").text);
            const auto& samples =
                clip.prim("geometry").properties.at("point3f[] points.timeSamples").samples;
            REQUIRE(samples.size() == 1);
            CHECK(samples[0].first == 51 + static_cast<int>(n));
            CHECK(samples[0].second.items.at(0).items.at(name == "bank" ? 0 : 2).text ==
                  std::to_string(51 + n));
        }
    }
}

TEST_CASE("every shipped shot of volumes can be written as a stage") {
    const Scratch scratch;
    const auto check = [&](const std::string& pipeline, const std::string& more = {},
                           const std::string& files = {}) {
        INFO(pipeline);
        const auto file =
            scratch.write("p.yaml", "fluidcarve: 1\nextends: " SOURCE_ROOT "/pipelines/" +
                                        pipeline + ".yaml\n" + more +
                                        "nodes:\n  usd: {type: usd.write, path: out/shot.usda, "
                                        "volumes: {volume: carved}, files: {volume: \"${out}\"" +
                                        files + "}}\n");
        const auto checked = fluidcarve_program("check " + file);
        CHECK(checked.err == "");
        CHECK(checked.code == 0);
    };
    for (const auto* const pipeline :
         {"plume", "plume_wide", "plume_ramp", "plume_path", "vortex", "bonfire_hot"})
        check(pipeline);
    check("bonfire", "params: {moved: {default: out/firepit.usda}}\n", ", pit: \"${moved}\"");
    check("river", "params: {shore: {default: out/riverbank.####.usda}}\n", ", bank: \"${shore}\"");
}
