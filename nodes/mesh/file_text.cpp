#include "nodes/mesh/file_text.h"

#include "graph/text/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

namespace fluidcarve {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

template <class Number>
std::optional<Number> parsed(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    Number out{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    return error == std::errc{} && end == word.data() + word.size() ? std::optional(out) : std::nullopt;
}

}  // namespace

FileText::FileText(std::string path, std::size_t most) : path_(std::move(path)) {
    std::error_code error;
    const auto status = std::filesystem::status(path_, error);
    if (std::filesystem::is_directory(status)) throw Failure(path_ + " is a folder", Failure::Kind::input);
    // Opening a pipe would block until another process writes to it.
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Failure(path_ + " is a pipe or a device; a mesh is read from a regular file", Failure::Kind::input);
    std::ifstream in(path_, std::ios::binary);
    size_ = std::filesystem::file_size(path_, error);
    if (!in || error) throw Failure(path_ + " can't be opened", Failure::Kind::input);
    text_.resize(std::min<std::size_t>(size_, most));
    if (!in.read(text_.data(), static_cast<std::streamsize>(text_.size()))) throw Failure(path_ + " can't be read", Failure::Kind::input);
    if (text_.empty()) fault_in_all("the file is empty");
}

bool FileText::next() {
    const auto found = text_.find('\n', next_);
    ran_out_ = found == std::string::npos && text_.size() < size_;
    if (next_ >= text_.size() || ran_out_) return false;
    const auto end = std::min(found, text_.size());
    line_ = std::string_view(text_).substr(next_, end - next_);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    next_ = std::min(end + 1, text_.size());
    in_line_ = 0;
    ++number_;
    return true;
}

std::string_view FileText::word(char comment) {
    const auto begin = std::min(line_.find_first_not_of(blanks, in_line_), line_.size());
    if (begin == line_.size() || (comment != 0 && line_[begin] == comment)) {
        has_comments_ = has_comments_ || begin != line_.size();
        in_line_ = line_.size();
        return {};
    }
    in_line_ = std::min(line_.find_first_of(blanks, begin), line_.size());
    return line_.substr(begin, in_line_ - begin);
}

std::string_view FileText::any_word() {
    for (;;) {
        if (const auto found = word(); !found.empty()) return found;
        if (!next()) fault("the file ends too early");
    }
}

std::string_view FileText::rest_of_line() {
    const auto begin = std::min(line_.find_first_not_of(blanks, in_line_), line_.size());
    in_line_ = line_.size();
    return line_.substr(begin);
}

std::string_view FileText::take(std::size_t bytes) {
    if (bytes > text_.size() - next_) fault_in_all("the file ends too early: it is cut off or damaged");
    const auto out = std::string_view(text_).substr(next_, bytes);
    next_ += bytes;
    return out;
}

double FileText::number(std::string_view word) const {
    const double out = any_number(word);
    if (!std::isfinite(out)) fault(fmt::format("{} is no number", quoted(word)));
    return out;
}

double FileText::any_number(std::string_view word) const {
    const auto out = parsed<double>(word);
    if (!out) fault(fmt::format("{} is no number", quoted(word)));
    return *out;
}

long FileText::whole(std::string_view word) const {
    const auto out = parsed<long>(word);
    if (!out) fault(fmt::format("{} is no whole number", quoted(word)));
    return *out;
}

void FileText::fault(const std::string& message) const { throw Failure(fmt::format("{}:{}: {}", path_, number_, message), Failure::Kind::input); }

void FileText::fault_in_all(const std::string& message) const { throw Failure(fmt::format("{}: {}", path_, message), Failure::Kind::input); }

std::string quoted(std::string_view word) {
    std::string out = "'";
    for (const char letter : word.substr(0, 40)) out += letter >= ' ' && letter <= '~' ? letter : '?';
    return out + "'";
}

}  // namespace fluidcarve
