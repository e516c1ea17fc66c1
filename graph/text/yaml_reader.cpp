#include "graph/text/yaml_reader.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>

namespace fluidcarve {
namespace {

constexpr std::size_t most_levels = 64;
constexpr std::size_t most_values = 100'000;

struct Stop {};  // a problem was added: stop reading

/// Builds a Value from the parser's events. yaml-cpp's own tree drops duplicate keys and expands
/// alias bombs.
class Builder : public YAML::EventHandler {
public:
    Builder(const std::shared_ptr<const Source>& source, Problems& problems, TextRoom& room)
        : source_(source), problems_(problems), room_(room) {}

    Value take() { return std::move(root_); }

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}

    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        // The parser places an empty value at the next token, perhaps on another line. Use the
        // place of its key instead.
        const bool after_key =
            !open_.empty() && open_.back().value.kind == Value::Kind::map && open_.back().key;
        Value value;
        value.mark = after_key ? open_.back().key->mark : place(mark);
        finish(std::move(value), anchor);
    }

    void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  const std::string& text) override {
        auto value = Value::scalar(place(mark), text);
        // Control characters may be written as escapes: code that reads a path up to a NUL would
        // open another file than the one checked.
        const auto control = std::ranges::find_if(text, [](unsigned char c) {
            return (c < 0x20 && c != '\n' && c != '\t' && c != '\r') || c == 0x7f;
        });
        if (control != text.end())
            fail(value.mark, fmt::format("the text holds the control character 0x{:02x}, which no "
                                         "name, path or program may: leave it out",
                                         static_cast<unsigned char>(*control)));
        finish(std::move(value), anchor);
    }

    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end())
            fail(place(mark), "this alias is part of the value that it refers to");
        count(place(mark), found->second.size, found->second.value.text_bytes());
        put(Value(found->second.value));
    }

    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(Value::Kind::list, mark, anchor);
    }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(Value::Kind::map, mark, anchor);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapEnd() override { close(); }

private:
    struct Open {
        Value value;
        YAML::anchor_t anchor;
        std::size_t first_value;
        std::optional<Value> key;
        /// Names of a map's fields, for fast lookup: hostile files may have very many.
        std::map<std::string, Mark> seen = {};
    };
    struct Anchored {
        Value value;
        std::size_t size;
    };

    Mark place(const YAML::Mark& mark) const { return {source_, mark.line + 1, mark.column + 1}; }

    [[noreturn]] void fail(const Mark& at, const std::string& message) {
        add(problems_, at, message);
        throw Stop{};
    }

    void count(const Mark& at, std::size_t values, std::size_t text_bytes) {
        values_ += values;
        if (values_ > most_values)
            fail(at,
                 fmt::format(
                     "more than {} values, with all aliases expanded: no pipeline needs so many",
                     most_values));
        if (!room_.take(text_bytes)) fail(at, TextRoom::fault());
    }

    void open(Value::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
        count(place(mark), 1, 0);
        if (open_.size() >= most_levels)
            fail(place(mark), fmt::format("nested more than {} levels deep", most_levels));
        Value value;
        value.kind = kind;
        value.mark = place(mark);
        open_.push_back({std::move(value), anchor, values_ - 1, std::nullopt});
    }

    void close() {
        Open done = std::move(open_.back());
        open_.pop_back();
        if (done.anchor != YAML::NullAnchor)
            anchors_[done.anchor] = {done.value, values_ - done.first_value};
        put(std::move(done.value));
    }

    void finish(Value value, YAML::anchor_t anchor) {
        count(value.mark, 1, value.text.size());
        if (anchor != YAML::NullAnchor) anchors_[anchor] = {value, 1};
        put(std::move(value));
    }

    /// Puts a whole value into the innermost list or map that is open; else it is the root.
    void put(Value value) {
        if (open_.empty()) {
            root_ = std::move(value);
            return;
        }
        auto& parent = open_.back();
        if (parent.value.kind == Value::Kind::list) {
            parent.value.items.push_back(std::move(value));
        } else if (!parent.key) {
            if (value.kind != Value::Kind::scalar)
                fail(value.mark, "a name is wanted here, not " + value.describe());
            parent.key = std::move(value);
        } else {
            if (const auto [first, fresh] = parent.seen.emplace(parent.key->text, parent.key->mark);
                !fresh)
                add(problems_, parent.key->mark,
                    fmt::format("'{}' is stated twice", parent.key->text), first->second,
                    "first stated here");
            else
                parent.value.fields.push_back(
                    {parent.key->text, parent.key->mark, std::move(value)});
            parent.key.reset();
        }
    }

    std::shared_ptr<const Source> source_;
    Problems& problems_;
    TextRoom& room_;
    Value root_;
    std::vector<Open> open_;
    std::map<YAML::anchor_t, Anchored> anchors_;
    std::size_t values_ = 0;
};

}  // namespace

Value read_yaml(const std::shared_ptr<const Source>& source, Problems& problems, TextRoom& room) {
    const Mark whole{source, 0, 0};
    if (source->text.size() > most_yaml_bytes) {
        add(problems, whole,
            fmt::format("the file holds more than {} MiB: not a pipeline", most_yaml_bytes >> 20));
        return {};
    }
    const auto binary = [](unsigned char c) {
        return c < 0x20 && c != '\t' && c != '\n' && c != '\r';
    };
    if (std::ranges::any_of(source->text, binary)) {
        add(problems, whole, "binary data: a pipeline is a text in UTF-8");
        return {};
    }
    Builder builder(source, problems, room);
    try {
        std::istringstream in(source->text);
        YAML::Parser parser(in);
        parser.HandleNextDocument(builder);
        Problems ignored;
        TextRoom other;
        Builder second(source, ignored, other);
        if (parser.HandleNextDocument(second))
            add(problems, whole, "a second YAML document follows; a pipeline file holds one");
    } catch (const Stop&) {
        return {};
    } catch (const YAML::Exception& error) {
        add(problems, {source, error.mark.line + 1, error.mark.column + 1},
            "not YAML: " + error.msg);
        return {};
    }
    return builder.take();
}

}  // namespace fluidcarve
