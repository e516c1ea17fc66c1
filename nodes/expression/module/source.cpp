#include "nodes/expression/module/source.h"

#include <openvdb_ax/ast/Parse.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace fluidcarve {
namespace {

namespace ax = openvdb::ax;

/// Reduces messages to their text and place.
void plain(ax::Logger& logger) {
    logger.setNumberedOutput(false);
    logger.setErrorPrefix("");
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// Names of tokens in the parser's messages, and the text for people.
constexpr std::array<std::pair<const char*, const char*>, 24> tokens{{
    {"SEMICOLON", "';'"}, {"LPARENS", "'('"},       {"RPARENS", "')'"}, {"LCURLY", "'{'"},
    {"RCURLY", "'}'"},    {"LSQUARE", "'['"},       {"RSQUARE", "']'"}, {"COMMA", "','"},
    {"QUESTION", "'?'"},  {"COLON", "':'"},         {"DOLLAR", "'$'"},  {"V_DOLLAR", "'v$'"},
    {"AT", "'@'"},        {"V_AT", "'v@'"},         {"DOT_X", "'.x'"},  {"DOT_Y", "'.y'"},
    {"DOT_Z", "'.z'"},    {"EQUALS", "'='"},        {"PLUS", "'+'"},    {"MINUS", "'-'"},
    {"MULTIPLY", "'*'"},  {"IDENTIFIER", "a name"}, {"DIVIDE", "'/'"},  {"ELSE", "'else'"},
}};

void name_tokens(std::string& text) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find_first_of(" ,", at), text.size());
        auto word = text.substr(at, end - at);
        for (const auto& [name, shown] : tokens)
            if (word == name) word = shown;
        out += word + text.substr(end, 1);
        at = end + 1;
    }
    text = std::move(out);
}

}  // namespace

ExpressionFault fault_of(const std::string& message) {
    ExpressionFault out{"code", 0, 0, message};
    const auto space = message.rfind(' ');
    const auto colon = message.rfind(':');
    if (space == std::string::npos || colon == std::string::npos || colon < space) return out;
    out.line = std::atoi(message.c_str() + space + 1);
    out.column = std::atoi(message.c_str() + colon + 1);
    out.message.resize(space);
    // The parser takes the first 14 letters of each message for "syntax error, ", those of "memory
    // exhausted" too.
    if (out.message == "ed") out.message = "nested too deep";
    if (out.message.starts_with("unexpected ")) name_tokens(out.message);
    replace_all(out.message, " \ncandidates are: \n", "; known: ");
    replace_all(out.message, "\n", ", ");
    return out;
}

ExpressionSource::ExpressionSource(const std::string& code, std::vector<ExpressionFault>& faults)
    : logger_([this](const std::string& message) { messages_.push_back(message); }) {
    plain(logger_);
    tree_ = ax::ast::parse(code.c_str(), logger_);
    // Report the first message only: the others mostly follow from it.
    if (!messages_.empty()) faults.push_back(fault_of(messages_.front()));
    if (!messages_.empty()) tree_ = nullptr;
}

std::pair<int, int> ExpressionSource::place(const ax::ast::Node& node) const {
    messages_.clear();
    logger_.error("at", &node);
    const auto at = fault_of(messages_.back());
    return {at.line, at.column};
}

}  // namespace fluidcarve
