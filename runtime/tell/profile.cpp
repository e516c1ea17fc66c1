#include "runtime/tell/profile.h"

#include "graph/text/json_text.h"

#include <nlohmann/json.hpp>

namespace fluidcarve {

void RunProfile::add(const char* category, std::size_t node, std::optional<int> frame,
                     Clock::time_point start) {
    const auto end = Clock::now();
    const std::lock_guard lock(mutex_);
    const auto thread =
        threads_.try_emplace(std::this_thread::get_id(), static_cast<int>(threads_.size()) + 1)
            .first->second;
    events_.push_back({category, node, frame, start, end, thread});
}

std::string RunProfile::text() const {
    using Json = nlohmann::ordered_json;
    const auto microseconds = [](Clock::duration time) {
        return std::chrono::duration<double, std::micro>(time).count();
    };
    const std::lock_guard lock(mutex_);
    auto events = Json::array();
    for (const auto& [id, thread] : threads_)
        events.push_back({{"name", "thread_name"},
                          {"ph", "M"},
                          {"pid", 1},
                          {"tid", thread},
                          {"args", {{"name", "thread " + std::to_string(thread)}}}});
    for (const auto& event : events_) {
        const auto& node = pipeline_.nodes[event.node];
        Json args{{"type", node.type->name}};
        if (event.frame) args["frame"] = *event.frame;
        events.push_back({{"name", node.name},
                          {"cat", event.category},
                          {"ph", "X"},
                          {"ts", microseconds(event.start - start_)},
                          {"dur", microseconds(event.end - event.start)},
                          {"pid", 1},
                          {"tid", event.thread},
                          {"args", std::move(args)}});
    }
    return json_text(Json{{"displayTimeUnit", "ms"}, {"traceEvents", std::move(events)}}) + "\n";
}

}  // namespace fluidcarve
