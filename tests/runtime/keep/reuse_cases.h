#pragma once

#include "graph/build_pipeline.h"
#include "runtime/run/forecast.h"
#include "runtime/run/run.h"
#include "runtime/run/status.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/resource.h>

using namespace fluidcarve;
namespace fs = std::filesystem;

inline const std::string pipeline_text = R"(fluidcarve: 1
frames: 1-5
nodes:
  load: {type: toy.load, path: in.##}
  square: {type: toy.square, number: load}
  top: {type: toy.top, number: square, count: 2}
  save: {type: toy.save, number: square, text: top, path: OUT/out.##}
)";

/// A folder with five numbers, a pipeline over them and a work folder.
struct Shot {
    Scratch scratch;
    std::string folder = scratch / "shot";
    std::string yaml = pipeline_text;
    RunRequest request;
    int code = 0;
    nlohmann::json report, forecast;

    Shot() {
        fs::create_directories(folder);
        for (int frame = 1; frame <= 5; ++frame) set(frame, frame);
        request.quiet = true;
        request.options.threads = 4;
        request.options.in_flight = 5;
    }
    void set(int frame, double value) const {
        std::ofstream(fmt::format("{}/in.{:02}", folder, frame)) << value;
    }
    void replace(const std::string& from, const std::string& to) {
        const auto at = yaml.find(from);
        REQUIRE(at != std::string::npos);
        yaml.replace(at, from.size(), to);
    }
    std::string text(int frame) const {
        const auto all = Scratch::read(fmt::format("{}/out/out.{:02}", folder, frame));
        return all.substr(std::min(all.size(), all.find(": ") + 2));
    }

    /// What ran, sorted; a forecast made before says the same of each node as the report does
    /// after.
    std::vector<std::string> run(const std::function<bool()>& cancelled = [] { return false; }) {
        static const Registry registry = toy::registry();
        toy::log.reset();
        auto text = yaml;
        const auto out = folder + "/out";
        for (auto at = text.find("OUT"); at != std::string::npos;
             at = text.find("OUT", at + out.size()))
            text.replace(at, 3, out);
        std::ofstream(folder + "/p.yaml") << text;
        Problems problems;
        const auto pipeline =
            build_pipeline(read_document(folder + "/p.yaml", {}, problems), registry, problems);
        REQUIRE(to_text(problems) == "");
        request.options.work_folder = folder + "/kept";
        request.report_path = folder + "/report.json";
        forecast = forecast_of(pipeline, registry);
        code = run_pipeline(pipeline, registry, request, cancelled);
        report = nlohmann::json::parse(Scratch::read(request.report_path));
        if (code == exit_code::done)
            for (const auto& [name, node] : forecast["nodes"].items()) {
                INFO(name);
                CHECK(report["nodes"][name]["frames"] == node["frames"]);
                CHECK(report["nodes"][name]["cached"] == node["cached"]);
            }
        return toy::log.sorted();
    }

    nlohmann::json forecast_of(const Pipeline& pipeline, const Registry& registry) const {
        Report unused(pipeline);
        Preparation prepared(pipeline, registry, request, unused);
        const auto schedule = prepared.schedule();
        const History history(request.options.cache ? request.options.work_folder : "",
                              pipeline.name);
        return to_json(make_forecast(pipeline, prepared, schedule, prepared.demands(schedule),
                                     history, request.options));
    }
    /// Runs frame after frame. Once the log has a line, the file of a frame is another one.
    void change_at(const std::string& line, int frame) {
        request.options.threads = 1;
        request.options.in_flight = 1;
        bool changed = false;
        run([&] {
            if (const auto lines = toy::log.sorted();
                !changed && std::ranges::count(lines, line) > 0) {
                set(frame, 44);
                changed = true;
            }
            return false;
        });
        REQUIRE(changed);
    }
    /// "NODE FRAME: MESSAGE" of each failure.
    std::vector<std::string> failures() const {
        std::vector<std::string> out;
        for (const auto& each : report["failures"])
            out.push_back(fmt::format("{} {}: {}", each["node"].get<std::string>(),
                                      each["frame"].dump(), each["message"].get<std::string>()));
        return out;
    }
    std::string why(const std::string& node) const {
        return forecast["nodes"][node].value("why", "");
    }
};
